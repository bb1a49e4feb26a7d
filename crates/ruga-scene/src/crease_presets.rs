//! Kinds of creases with their usual properties.

/// A kind of crease. Widths and depths are of the order that anatomy gives for adults, stiffness and angle
/// are chosen so that folds look right. Nothing of it was measured on skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreasePreset {
    /// Its name in scenes.
    pub name: &'static str,
    /// What it is, for people.
    pub description: &'static str,
    /// Width of the soft strip, m.
    pub width: f64,
    /// Share of the bending stiffness that is left on it.
    pub stiffness: f64,
    /// Angle of the fold at full strength, degrees.
    pub angle: f64,
    /// Depth of the anchor (m), where the skin is tethered to deep tissue.
    pub depth: Option<f64>,
}

/// All kinds of creases.
pub const CREASE_PRESETS: [CreasePreset; 5] = [
    CreasePreset {
        name: "palm-line",
        description: "Line of the palm, tethered to the tissue below",
        width: 0.7e-3,
        stiffness: 0.05,
        angle: 40.0,
        depth: Some(0.6e-3),
    },
    CreasePreset {
        name: "finger-flexion",
        description: "Line on the inside of a finger's joint, tethered to its sheath",
        width: 0.7e-3,
        stiffness: 0.05,
        angle: 50.0,
        depth: Some(0.5e-3),
    },
    CreasePreset {
        name: "crows-foot",
        description: "Line beside the outer corner of the eye",
        width: 0.4e-3,
        stiffness: 0.05,
        angle: 40.0,
        depth: None,
    },
    CreasePreset {
        name: "frown-line",
        description: "Upright line between the brows, or a furrow across the forehead",
        width: 0.6e-3,
        stiffness: 0.05,
        angle: 40.0,
        depth: None,
    },
    CreasePreset {
        name: "nasolabial",
        description: "Fold from the nose to the corner of the mouth",
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
