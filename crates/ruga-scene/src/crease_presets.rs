//! Kinds of creases with their usual properties.

/// A kind of crease. Widths and depths are of the order that anatomy gives for adults; stiffness and angle are
/// chosen so that the fold looks like one on photographs. Nothing of it was measured on skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CreasePreset {
    pub(crate) name: &'static str,
    /// Width, m.
    pub(crate) width: f64,
    /// Share of the bending stiffness.
    pub(crate) stiffness: f64,
    /// Angle, degrees.
    pub(crate) angle: f64,
    /// Depth of the anchor, m, where the skin is tethered to deep tissue.
    pub(crate) depth: Option<f64>,
}

pub(crate) const CREASE_PRESETS: [CreasePreset; 5] = [
    CreasePreset {
        name: "palm-line",
        width: 0.7e-3,
        stiffness: 0.05,
        angle: 40.0,
        depth: Some(0.6e-3),
    },
    CreasePreset {
        name: "finger-flexion",
        width: 0.7e-3,
        stiffness: 0.05,
        angle: 50.0,
        depth: Some(0.5e-3),
    },
    CreasePreset {
        name: "crows-foot",
        width: 0.4e-3,
        stiffness: 0.2,
        angle: 20.0,
        depth: None,
    },
    CreasePreset {
        name: "frown-line",
        width: 0.6e-3,
        stiffness: 0.1,
        angle: 30.0,
        depth: None,
    },
    CreasePreset {
        name: "nasolabial",
        width: 1.0e-3,
        stiffness: 0.1,
        angle: 40.0,
        depth: Some(0.8e-3),
    },
];

/// The kind of that name.
pub(crate) fn crease_preset(name: &str) -> Option<&'static CreasePreset> {
    CREASE_PRESETS.iter().find(|preset| preset.name == name)
}
