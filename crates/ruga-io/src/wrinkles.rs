//! `wrinkles.json`: which map belongs to which pose and key, and how to read and blend it.

use std::collections::BTreeMap;
use std::path::Path;

use ruga_bake::{Detail, Encoding};
use serde::{Deserialize, Serialize};

use crate::report::to_json_text;
use crate::udim::{udim_name, udim_pattern};
use crate::{Frame, IoError, MapFormat, MapKind, NormalY, write_atomically};

/// Everything an engine needs to use the baked maps, version 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wrinkles {
    /// Version of this layout: 1.
    pub version: u32,
    /// Name of the artist's mesh.
    pub mesh: String,
    /// The tangent frame of the normal maps.
    pub frame: Frame,
    /// Width and height of every map, texels.
    pub size: u32,
    /// Rule by which the maps of several poses combine.
    pub blend: Blend,
    /// Place where the GLB beside this file lists the maps; absent when none was written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub glb: Option<GlbReference>,
    /// Weights of the blend shapes that make each pose.
    pub poses: BTreeMap<String, BTreeMap<String, f64>>,
    /// Strengths of the growths that take part in each pose; poses without any are left out, and so is an empty list.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub growths: BTreeMap<String, BTreeMap<String, f64>>,
    /// One entry per pose, key and kind. Every pose in the folder that was made from this version of the scene is
    /// listed, whichever run made it; an interrupted one with the keys that were finished.
    pub maps: Vec<WrinkleMap>,
}

/// The artist's mesh as GLB, and where in it the maps are referenced.
///
/// The maps stand in `extras` and nowhere else. A material's own normal texture is what the mesh
/// looks like at rest, and wrinkles are added to it at run time; a `KHR_materials_variants` variant
/// per map would replace it, and importers would load a copy of every material for each of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GlbReference {
    /// The GLB, relative to `wrinkles.json`.
    pub file: String,
    /// Place of the list of maps by pose and key in its JSON, as a JSON pointer such as
    /// `/meshes/0/extras/wrinkleMaps`; absent when it lists none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maps: Option<String>,
    /// The texture coordinates that the maps are laid out in, one entry per primitive of the mesh
    /// that has any.
    pub coordinates: Vec<MapCoordinates>,
}

/// The texture coordinates of a primitive that address the maps: those of its material's normal
/// texture, else of its base colour.
///
/// Offset, rotation and scale are those of `KHR_texture_transform`, and absent where they change
/// nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapCoordinates {
    /// Number of the primitive in its mesh.
    pub primitive: usize,
    /// The `n` of `TEXCOORD_n`.
    pub set: u32,
    /// Shift of the coordinates, after scale and rotation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<[f64; 2]>,
    /// Turn of the coordinates, counter-clockwise in the image (rad).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<f64>,
    /// Factors of the coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 2]>,
}

impl MapCoordinates {
    /// The first set of a primitive, as it is.
    pub(crate) fn plain(primitive: usize) -> Self {
        Self {
            primitive,
            set: 0,
            offset: None,
            rotation: None,
            scale: None,
        }
    }
}

/// Rules by which maps combine at run time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blend {
    /// Rule for normal maps: `reoriented-normal-mapping`.
    pub normal: String,
    /// Rule for heights: `add`.
    pub height: String,
    /// Rule for ambient occlusion: `multiply`.
    #[serde(default = "multiply")]
    pub ambient_occlusion: String,
    /// Rule for curvature and vector displacement: `add`.
    #[serde(default = "add")]
    pub curvature: String,
    /// Rule for compression: `maximum`.
    #[serde(default = "maximum")]
    pub compression: String,
    /// Between the keys of a pose, and from neutral at key 0 to its first key: `linear`.
    pub keys: String,
}

impl Default for Blend {
    fn default() -> Self {
        Self {
            normal: "reoriented-normal-mapping".to_owned(),
            height: "add".to_owned(),
            ambient_occlusion: multiply(),
            curvature: add(),
            compression: maximum(),
            keys: "linear".to_owned(),
        }
    }
}

fn multiply() -> String {
    "multiply".to_owned()
}

fn add() -> String {
    "add".to_owned()
}

fn maximum() -> String {
    "maximum".to_owned()
}

/// One baked map: a file, or one file per UDIM tile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrinkleMap {
    /// The pose.
    pub pose: String,
    /// The fraction of the pose, in (0, 1].
    pub key: f64,
    /// Meaning of the texels.
    pub kind: MapKind,
    /// The file, relative to `wrinkles.json`, with `/` between folders; of a mesh with UDIM tiles the files,
    /// `<UDIM>` standing for the number of the tile.
    pub file: String,
    /// Numbers of the UDIM tiles, ascending, each of which has a file; absent where the mesh has no tiles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tiles: Vec<u32>,
    /// Its format. Heights, displacements and temperatures are 16-bit even where the scene asks for 8-bit maps,
    /// as 256 steps of height show as terraces: their entries say `png16` then.
    pub format: MapFormat,
    /// Normal maps: the sign of the green channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub green: Option<NormalY>,
    /// Unit of `scale`: `m` of heights and displacements, `1/m` of curvature, `K` of temperatures; absent of
    /// shares and directions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// All but tangent-space normals: the stored value that means zero; 0.5 in PNG where numbers of both
    /// signs are stored, 0 in EXR.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mid: Option<f64>,
    /// All but tangent-space normals: `unit`s per full range of the stored value,
    /// `number = (value - mid) * scale`; 1 in EXR. Of temperatures black is 0 K, and this is what white stands
    /// for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Stored value of a texel without wrinkles or fire, one per channel; empty for object-space normals,
    /// which are the mesh's own there.
    pub neutral: Vec<f64>,
}

impl WrinkleMap {
    /// A normal map; neutral is (0.5, 0.5, 1) in PNG and (0, 0, 1) in EXR.
    pub fn normal(pose: &str, key: f64, format: MapFormat, green: NormalY) -> Self {
        let middle = if format == MapFormat::Exr { 0.0 } else { 0.5 };
        Self {
            green: Some(green),
            ..Self::plain(
                pose,
                key,
                MapKind::Normal,
                format,
                vec![middle, middle, 1.0],
            )
        }
    }

    /// A height map, `scale` metres per full range of the stored value; ignored for EXR, which
    /// holds metres.
    pub fn height(pose: &str, key: f64, format: MapFormat, scale: f64) -> Self {
        let (mid, scale) = match format {
            MapFormat::Exr => (0.0, 1.0),
            MapFormat::Png8 | MapFormat::Png16 => (0.5, scale),
        };
        Self {
            unit: Some("m".to_owned()),
            mid: Some(mid),
            scale: Some(scale),
            ..Self::plain(pose, key, MapKind::Height, format, vec![mid])
        }
    }

    /// A map of a further quantity, stored by this rule; EXR holds the numbers themselves.
    pub fn detail(
        pose: &str,
        key: f64,
        (kind, detail): (MapKind, Detail),
        format: MapFormat,
        encoding: Encoding,
    ) -> Self {
        let Encoding { mid, scale } = match format {
            MapFormat::Exr => Encoding::SHARE,
            MapFormat::Png8 | MapFormat::Png16 => encoding,
        };
        let unit = match detail {
            Detail::Occlusion
            | Detail::Compression
            | Detail::ObjectNormal
            | Detail::Mask
            | Detail::Char
            | Detail::Ash
            | Detail::Thickness => None,
            Detail::Temperature => Some("K".to_owned()),
            Detail::Curvature => Some("1/m".to_owned()),
            Detail::Displacement => Some("m".to_owned()),
        };
        let stored = |number: &f32| mid + f64::from(*number) / scale;
        let neutral = match detail {
            Detail::ObjectNormal => Vec::new(),
            detail => detail.neutral().iter().map(stored).collect(),
        };
        Self {
            unit,
            mid: Some(mid),
            scale: Some(scale),
            ..Self::plain(pose, key, kind, format, neutral)
        }
    }

    /// The map of a mesh with these UDIM tiles, a file for each; without any it stays one file.
    pub fn over_tiles(mut self, tiles: &[u32]) -> Self {
        if !tiles.is_empty() {
            self.file = udim_pattern(&self.file);
        }
        self.tiles = tiles.to_vec();
        self
    }

    /// The files, relative to `wrinkles.json`: one for each of `tiles`, or the only one.
    pub fn files(&self) -> Vec<String> {
        match self.tiles.as_slice() {
            [] => vec![self.file.clone()],
            tiles => {
                let of_tile = |tile: &u32| udim_name(&self.file, *tile);
                tiles.iter().map(of_tile).collect()
            }
        }
    }

    fn plain(pose: &str, key: f64, kind: MapKind, format: MapFormat, neutral: Vec<f64>) -> Self {
        Self {
            pose: pose.to_owned(),
            key,
            kind,
            file: map_file(pose, key, kind, format),
            tiles: Vec::new(),
            format,
            green: None,
            unit: None,
            mid: None,
            scale: None,
            neutral,
        }
    }
}

impl Wrinkles {
    /// Version of the layout that this crate writes.
    pub const VERSION: u32 = 1;

    /// A manifest without poses and maps.
    pub fn new(mesh: impl Into<String>, frame: Frame, size: u32) -> Self {
        Self {
            version: Self::VERSION,
            mesh: mesh.into(),
            frame,
            size,
            blend: Blend::default(),
            glb: None,
            poses: BTreeMap::new(),
            growths: BTreeMap::new(),
            maps: Vec::new(),
        }
    }

    /// The manifest as JSON text.
    pub fn to_json(&self) -> String {
        to_json_text(self)
    }

    /// Writes the manifest, whole or not at all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        write_atomically(path, self.to_json().as_bytes())
    }
}

/// A key as it stands in file names: percent, with one decimal behind a `p` where it needs one (`50`,
/// `12p5`). Some tools take what follows a dot for the extension.
pub fn key_percent(key: f64) -> String {
    let tenths = (key * 1000.0).round() / 10.0;
    format!("{tenths}").replace('.', "p")
}

/// Path of a map, relative to the output folder: `maps/<pose>_<key%>_<kind>.<ext>`, with the
/// [`key_percent`] of its key.
pub fn map_file(pose: &str, key: f64, kind: MapKind, format: MapFormat) -> String {
    format!(
        "maps/{pose}_{}_{}.{}",
        key_percent(key),
        kind.word(),
        format.extension()
    )
}
