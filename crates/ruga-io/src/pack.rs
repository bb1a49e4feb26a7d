//! `packed/pack.json`: which packed map, mask and channel a pose has, and how strong it is.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::report::to_json_text;
use crate::{IoError, MapFormat, MapKind, NormalY, write_atomically};

/// Everything an engine needs to use packed maps, version 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackManifest {
    /// Version of this layout: 1.
    pub version: u32,
    /// Name of the artist's mesh.
    pub mesh: String,
    /// Width and height of every image, texels.
    pub size: u32,
    /// Numbers of the UDIM tiles, ascending: each has a file of every image and mask, whose name has `<UDIM>`
    /// for the number; absent where the mesh has no tiles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tiles: Vec<u32>,
    /// The packed maps.
    pub maps: Vec<PackedMap>,
    /// The poses, by their names in the scene.
    pub poses: BTreeMap<String, PackedPose>,
}

/// One packed map: an image of each kind, and the masks of its poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PackedMap {
    /// One image per kind.
    pub images: Vec<PackedImage>,
    /// Mask images with 8 bits in red, green, blue and alpha, relative to this file.
    pub masks: Vec<String>,
}

/// One image of several poses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackedImage {
    /// Meaning of the texels.
    pub kind: MapKind,
    /// The file, relative to this one.
    pub file: String,
    /// Its format.
    pub format: MapFormat,
    /// Normals: the sign of the green channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub green: Option<NormalY>,
    /// Unit of `scale`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// All but normals: `number = (value - mid) * scale`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mid: Option<f64>,
    /// All but normals: see `mid`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Stored value of a texel without wrinkles, one per channel.
    pub neutral: Vec<f64>,
}

/// Where a pose is, and how strong its map is on the way to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackedPose {
    /// Its name in the engine's convention.
    pub name: String,
    /// Number of its map in `maps`, from 0.
    pub map: usize,
    /// Number of its mask in the map's `masks`, from 0.
    pub mask: usize,
    /// Channel of the mask: `r`, `g`, `b` or `a`.
    pub channel: String,
    /// Fractions of the pose, ascending from 0, each with the strength of the map there; straight lines in
    /// between, and level beyond the last.
    pub curve: Vec<[f64; 2]>,
    /// Weights of the blend shapes that make the pose.
    pub weights: BTreeMap<String, f64>,
    /// Strengths of the growths that take part in it; left out without any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub growths: BTreeMap<String, f64>,
}

impl PackManifest {
    /// Version of the layout that this crate writes.
    pub const VERSION: u32 = 1;

    /// Writes the manifest, whole or not at all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        write_atomically(path, to_json_text(self).as_bytes())
    }
}
