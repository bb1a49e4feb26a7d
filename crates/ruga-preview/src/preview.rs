//! The page as one text.

use std::collections::BTreeMap;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::Matrix3;
use ruga_blend::ArtistMesh;

use crate::about::{About, AboutKey, AboutPose, MapPlace};
use crate::focus::Focus;
use crate::mesh_data::{MeshData, PoseSections};
use crate::template::{Content, data_element, filled};
use crate::tile_split::TileSplit;
use crate::{PackedMap, PreviewError};

/// Everything that a page shows.
#[derive(Clone, Debug)]
pub struct Preview<'a> {
    /// The artist's mesh with its blend shapes.
    pub mesh: &'a ArtistMesh,
    /// Rotation or reflection that takes the mesh into the world, where Y is up.
    pub turn: Matrix3<f64>,
    /// Poses in the order of their sliders, in which their maps are laid over each other, too.
    pub poses: Vec<PreviewPose>,
}

/// A pose: weights of blend shapes, and what the skin does on the way there.
#[derive(Clone, Debug)]
pub struct PreviewPose {
    /// Its name.
    pub name: String,
    /// Weights of the blend shapes at the full pose.
    pub weights: BTreeMap<String, f64>,
    /// Normal maps by key, a fraction of the pose in (0, 1]; keys ascend, and no map is neutral at 0. On a mesh
    /// with UDIM tiles every map is one [in a square](PackedMap::in_square): maps of one key may lie in several, and
    /// a square has all keys or none.
    pub maps: Vec<(f64, PackedMap)>,
}

impl Preview<'_> {
    /// The page, one HTML text that asks for nothing else.
    ///
    /// # Errors
    /// Any [`PreviewError`] but `TexelCount` and `Encoding`.
    pub fn to_html(&self) -> Result<String, PreviewError> {
        let size = self.common_size()?;
        let weights: Vec<_> = self.poses.iter().map(|pose| &pose.weights).collect();
        let squares = self.poses.iter().flat_map(|pose| &pose.maps);
        let split = TileSplit::new(self.mesh, squares.map(|(_, map)| map.square));
        let data = MeshData::new(&split.mesh, &self.turn, &weights)?;
        let maps = || self.poses.iter().flat_map(|pose| &pose.maps);
        let largest = |side: fn(&PackedMap) -> u32| maps().map(|(_, map)| side(map)).max();
        let about = About {
            version: 1,
            size,
            tiles: split.count(),
            // Whole multiples: halves of them are whole texels for some levels of smaller copies.
            slot: [largest(|map| map.width), largest(|map| map.height)]
                .map(|side| side.unwrap_or(1).next_multiple_of(16)),
            maps: maps()
                .map(|(_, map)| MapPlace {
                    tile: split.number(map.square),
                    left: map.left,
                    top: map.top,
                    width: map.width,
                    height: map.height,
                })
                .collect(),
            poses: self.about_poses(data.poses),
            mesh: data.mesh,
            focus: Focus::new(
                &split,
                &self.turn,
                maps().map(|(_, map)| (split.number(map.square), map.wrinkled.as_slice())),
            ),
            plan: None,
        };
        Ok(filled(&Content {
            title: &self.mesh.name,
            facts: &self.facts(size),
            about: &about.to_json(),
            mesh: &BASE64_STANDARD.encode(&data.bytes),
            maps: &self.map_elements(),
        }))
    }

    /// Texels per side of every map.
    fn common_size(&self) -> Result<u32, PreviewError> {
        let mut maps = self.poses.iter().flat_map(|pose| {
            let maps = pose.maps.iter();
            maps.map(|(key, map)| (&pose.name, *key, map.size))
        });
        let (_, _, expected) = maps.next().ok_or(PreviewError::NoMaps)?;
        match maps.find(|(_, _, size)| *size != expected) {
            None => Ok(expected),
            Some((pose, key, found)) => Err(PreviewError::MapSize {
                pose: pose.clone(),
                key,
                found,
                expected,
            }),
        }
    }

    /// Poses with the numbers of their maps, which count through all of them.
    fn about_poses(&self, sections: Vec<PoseSections>) -> Vec<AboutPose<'_>> {
        let mut map = 0..;
        let poses = self.poses.iter().zip(sections);
        poses
            .map(|(pose, sections)| AboutPose {
                name: &pose.name,
                weights: &pose.weights,
                maps: pose
                    .maps
                    .iter()
                    .zip(&mut map)
                    .map(|((key, _), map)| AboutKey { key: *key, map })
                    .collect(),
                plan: None,
                sections,
            })
            .collect()
    }

    fn map_elements(&self) -> String {
        let maps = self.poses.iter().flat_map(|pose| &pose.maps);
        let elements = maps.enumerate().map(|(number, (_, map))| {
            let data = BASE64_STANDARD.encode(&map.png);
            data_element(&format!("map{number}"), &data)
        });
        elements.collect::<Vec<_>>().join("\n")
    }

    fn facts(&self, size: u32) -> String {
        let maps: usize = self.poses.iter().map(|pose| pose.maps.len()).sum();
        format!(
            "{} triangles, {maps} normal maps of {size} × {size}. Made by ruga {}.",
            self.mesh.triangles.len(),
            env!("CARGO_PKG_VERSION")
        )
    }
}
