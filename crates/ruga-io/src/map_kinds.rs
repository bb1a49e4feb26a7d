//! What maps are: their kinds, formats and conventions, as scenes and `wrinkles.json` name them.

use ruga_bake::Detail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the texels of a map mean.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum MapKind {
    /// Tangent-space normals.
    Normal,
    /// Displacement along the normal, m.
    Height,
    /// Share of the light of an even sky that wrinkles leave a place: white where nothing hides it.
    AmbientOcclusion,
    /// Mean curvature of the wrinkles times `curvature_length`: middle grey where flat, lighter on ridges,
    /// darker in furrows.
    Curvature,
    /// Compression that the pose asks of the skin over the critical one: black at none, white from the
    /// critical one on. A mask for the strength of other maps.
    Compression,
    /// Normals in the axes of the mesh file, of the posed mesh with its wrinkles.
    ObjectNormal,
    /// Displacement along tangent, bitangent and normal, m.
    VectorDisplacement,
    /// What is left of a burning sheet: white where it is, black where it has fallen off.
    Mask,
    /// Share of the fuel of a burning sheet that has burnt: black where fresh, white where burnt out, also where
    /// the sheet is gone.
    Char,
    /// Where a burning sheet has burnt out: white there, black elsewhere, also where the sheet is gone.
    Ash,
    /// Temperature of a burning sheet, K, also where the sheet is gone.
    Temperature,
    /// Thickness of a burning sheet over that of the fresh one: white where fresh, black where the sheet is gone.
    Thickness,
}

impl MapKind {
    /// The quantity that the maps of this kind hold beside normals and heights.
    pub fn detail(self) -> Option<Detail> {
        match self {
            MapKind::Normal | MapKind::Height => None,
            MapKind::AmbientOcclusion => Some(Detail::Occlusion),
            MapKind::Curvature => Some(Detail::Curvature),
            MapKind::Compression => Some(Detail::Compression),
            MapKind::ObjectNormal => Some(Detail::ObjectNormal),
            MapKind::VectorDisplacement => Some(Detail::Displacement),
            MapKind::Mask => Some(Detail::Mask),
            MapKind::Char => Some(Detail::Char),
            MapKind::Ash => Some(Detail::Ash),
            MapKind::Temperature => Some(Detail::Temperature),
            MapKind::Thickness => Some(Detail::Thickness),
        }
    }

    /// Whether poses of this kind can share a packed map: its maps are of wrinkles alone, and neutral
    /// elsewhere.
    pub fn is_packed(self) -> bool {
        !matches!(self, MapKind::Compression | MapKind::ObjectNormal) && !self.needs_fire()
    }

    /// Whether the maps of this kind show a fire: only sheets that burn have them.
    pub fn needs_fire(self) -> bool {
        matches!(
            self,
            MapKind::Mask
                | MapKind::Char
                | MapKind::Ash
                | MapKind::Temperature
                | MapKind::Thickness
        )
    }

    /// The word for it in scenes and file names.
    pub fn word(self) -> &'static str {
        match self {
            MapKind::Normal => "normal",
            MapKind::Height => "height",
            MapKind::AmbientOcclusion => "ambient_occlusion",
            MapKind::Curvature => "curvature",
            MapKind::Compression => "compression",
            MapKind::ObjectNormal => "object_normal",
            MapKind::VectorDisplacement => "vector_displacement",
            MapKind::Mask => "mask",
            MapKind::Char => "char",
            MapKind::Ash => "ash",
            MapKind::Temperature => "temperature",
            MapKind::Thickness => "thickness",
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
