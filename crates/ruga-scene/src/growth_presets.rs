//! Kinds of growth with their usual amounts.

/// A kind of growth. Amounts are chosen so that maps look right; nothing of them was measured on skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthPreset {
    /// Its name in scenes.
    pub name: &'static str,
    /// What it is, for people.
    pub description: &'static str,
    /// Whether what lies below the layers changes its size, and not a layer.
    pub is_below: bool,
    /// Change of length along its direction, a share of it.
    pub along: f64,
    /// Change of length across its direction.
    pub across: f64,
}

/// All kinds of growth.
pub const GROWTH_PRESETS: [GrowthPreset; 2] = [
    GrowthPreset {
        name: "ageing",
        description: "Skin that has become too large for what it lies on",
        is_below: false,
        along: 0.05,
        across: 0.05,
    },
    GrowthPreset {
        name: "drying",
        description: "Tissue below the skin that has lost water, and is too small for it",
        is_below: true,
        along: -0.06,
        across: -0.06,
    },
];

/// The kind of that name.
pub(crate) fn growth_preset(name: &str) -> Option<&'static GrowthPreset> {
    GROWTH_PRESETS.iter().find(|preset| preset.name == name)
}
