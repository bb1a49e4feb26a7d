//! What maps are: their kinds, formats and conventions, as scenes and `wrinkles.json` name them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the texels of a map mean.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum MapKind {
    /// Tangent-space normals.
    Normal,
    /// Displacement along the normal, m.
    Height,
}

impl MapKind {
    /// The word for it in scenes and file names.
    pub fn word(self) -> &'static str {
        match self {
            MapKind::Normal => "normal",
            MapKind::Height => "height",
        }
    }
}

/// File format of maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MapFormat {
    /// 8 bits per channel, dithered.
    Png8,
    /// 16 bits per channel.
    #[default]
    Png16,
    /// 32-bit floats; heights in metres, normals from -1 to 1.
    Exr,
}

impl MapFormat {
    /// `png` or `exr`.
    pub fn extension(self) -> &'static str {
        match self {
            MapFormat::Png8 | MapFormat::Png16 => "png",
            MapFormat::Exr => "exr",
        }
    }
}
