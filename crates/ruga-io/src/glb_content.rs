//! Contents of a GLB, and what `ruga` adds to the artist's mesh.

use std::collections::BTreeMap;

use nalgebra::{Vector3, Vector4};
use serde_json::{Value, json};

use crate::glb_moved::MovedMesh;
use crate::{MapCoordinates, WrinkleMap};

/// Data that `ruga` adds to the artist's mesh.
#[derive(Clone, Copy, Debug, Default)]
pub struct GlbAdditions<'a> {
    /// Tangent of each vertex and, as `w`, the sign of the bitangent for V pointing down: for the
    /// raw MikkTSpace sign, its negative. Written when the mesh has normals.
    pub tangents: Option<&'a [Vector4<f64>]>,
    /// Normals for a mesh whose file has none, one per vertex; ignored where it has its own.
    pub normals: Option<&'a [Vector3<f64>]>,
    /// The baked maps, files relative to the GLB.
    pub maps: &'a [WrinkleMap],
    /// The mesh where a sheet or a body has taken it, keys of a pose in order: a blend shape each, named by
    /// pose and key, and an animation per pose.
    pub moved: &'a [MovedMesh],
}

/// A GLB before it is a file.
pub(crate) struct GlbContent {
    pub(crate) json: String,
    /// Empty: no binary chunk.
    pub(crate) binary: Vec<u8>,
    /// JSON pointer to the list of maps.
    pub(crate) maps: Option<String>,
    pub(crate) coordinates: Vec<MapCoordinates>,
    pub(crate) warnings: Vec<String>,
}

/// `[{ "pose": …, "key": …, "normal": file, "height": file }, …]` in the order of the maps; of a mesh with
/// UDIM tiles with their numbers, too, `"tiles": […]`.
pub(crate) fn wrinkle_maps(maps: &[WrinkleMap]) -> Value {
    let mut entries: Vec<(&WrinkleMap, BTreeMap<&str, &str>)> = Vec::new();
    for map in maps {
        let same = |entry: &&mut (&WrinkleMap, _)| {
            let (first, _) = entry;
            first.pose == map.pose && first.key == map.key
        };
        match entries.iter_mut().find(same) {
            Some(entry) => {
                entry.1.insert(map.kind.word(), &map.file);
            }
            None => entries.push((map, BTreeMap::from([(map.kind.word(), map.file.as_str())]))),
        }
    }
    entries
        .into_iter()
        .map(|(first, files)| {
            let mut entry = json!(files);
            entry["pose"] = json!(first.pose);
            entry["key"] = json!(first.key);
            if !first.tiles.is_empty() {
                entry["tiles"] = json!(first.tiles);
            }
            entry
        })
        .collect()
}
