//! The page of a plan: its pictures on the mesh, before anything is baked.

use std::collections::BTreeMap;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::{Matrix3, Vector2};
use ruga_blend::ArtistMesh;
use serde::Serialize;

use crate::about::{About, AboutPlan, AboutPlannedPose, AboutPose};
use crate::focus::{Focus, cell_of};
use crate::mesh_data::MeshData;
use crate::packed_map::{CELLS, rgb_png};
use crate::template::{Content, data_element, filled};
use crate::tile_split::TileSplit;
use crate::{Atlas, PreviewError};

/// Everything that a page of a plan shows.
#[derive(Clone, Debug)]
pub struct PlanPreview<'a> {
    /// The artist's mesh with its blend shapes.
    pub mesh: &'a ArtistMesh,
    /// Rotation or reflection that takes the mesh into the world, where Y is up.
    pub turn: Matrix3<f64>,
    /// Where pictures show the tiles of the mesh.
    pub atlas: Atlas,
    /// Poses in the order of their sliders.
    pub poses: Vec<PlannedPose>,
    /// Names of the overlays that every pose may have, such as those of its layers.
    pub layers: Vec<String>,
    /// What the colours of overlays mean.
    pub legend: Legend,
    /// What the plan says of all poses together.
    pub facts: String,
}

/// A pose, and what a plan says of it.
#[derive(Clone, Debug)]
pub struct PlannedPose {
    /// Its name.
    pub name: String,
    /// Weights of the blend shapes at the full pose.
    pub weights: BTreeMap<String, f64>,
    /// What the plan says of it in words, a line each.
    pub notes: Vec<String>,
    /// One for each of [`PlanPreview::layers`]; `None` where nothing wrinkles.
    pub overlays: Vec<Option<Overlay>>,
}

/// A picture on the mesh's texture layout, all tiles of it as an [`Atlas`] has them.
#[derive(Clone, Debug)]
pub struct Overlay {
    png: Vec<u8>,
    /// `CELLS * CELLS` cells of the picture, row by row: whether the skin wrinkles there.
    wrinkled: Vec<bool>,
}

/// Meaning of the colours of overlays; a colour is red, green and blue.
#[derive(Clone, Debug, Serialize)]
pub struct Legend {
    /// Colours of a scale, evenly spaced.
    pub ramp: Vec<[u8; 3]>,
    /// Words at the beginning and at the end of the scale.
    pub ends: [String; 2],
    /// Single colours; the first one is that of a mesh without overlay.
    pub colours: Vec<([u8; 3], String)>,
    /// What else there is to see.
    pub note: String,
}

impl Overlay {
    /// Packs a picture of `size * size` texels of three bytes, row by row from the top.
    ///
    /// The page looks first at where one of `wrinkled` lies: places in the picture, 0 to 1, V down.
    ///
    /// # Errors
    /// [`PreviewError::TexelCount`], [`PreviewError::Encoding`].
    pub fn new(
        size: u32,
        colours: &[u8],
        wrinkled: impl IntoIterator<Item = Vector2<f64>>,
    ) -> Result<Self, PreviewError> {
        let found = colours.len() / 3;
        if size == 0 || colours.len() != 3 * size as usize * size as usize {
            return Err(PreviewError::TexelCount { size, found });
        }
        let mut cells = vec![false; CELLS * CELLS];
        for place in wrinkled {
            cells[cell_of(place)] = true;
        }
        let png = rgb_png([size; 2], colours);
        Ok(Self {
            png: png.map_err(|error| PreviewError::Encoding(error.to_string()))?,
            wrinkled: cells,
        })
    }
}

impl PlanPreview<'_> {
    /// The page, one HTML text that asks for nothing else.
    ///
    /// # Errors
    /// [`PreviewError::Mesh`].
    pub fn to_html(&self) -> Result<String, PreviewError> {
        let weights: Vec<_> = self.poses.iter().map(|pose| &pose.weights).collect();
        let mesh = self.atlas.laid_out(self.mesh);
        let data = MeshData::new(&mesh, &self.turn, &weights)?;
        let overlays = || self.poses.iter().flat_map(|pose| &pose.overlays).flatten();
        let split = TileSplit::repeating(&mesh);
        let marks = overlays().map(|overlay| (0, overlay.wrinkled.as_slice()));
        let mut numbers = 0..;
        let poses = self.poses.iter().zip(data.poses).map(|(pose, sections)| {
            let number = |overlay: &Option<Overlay>| overlay.as_ref().and_then(|_| numbers.next());
            AboutPose {
                name: &pose.name,
                weights: &pose.weights,
                maps: Vec::new(),
                plan: Some(AboutPlannedPose {
                    notes: &pose.notes,
                    overlays: pose.overlays.iter().map(number).collect(),
                }),
                sections,
            }
        });
        let about = About {
            version: 1,
            // No map is there, and the least room for one.
            size: 1,
            tiles: split.count(),
            slot: [16; 2],
            maps: Vec::new(),
            poses: poses.collect(),
            mesh: data.mesh,
            focus: Focus::new(&split, &self.turn, marks),
            plan: Some(AboutPlan {
                layers: &self.layers,
                legend: &self.legend,
            }),
        };
        let elements = overlays().enumerate().map(|(number, overlay)| {
            let data = BASE64_STANDARD.encode(&overlay.png);
            data_element(&format!("overlay{number}"), &data)
        });
        Ok(filled(&Content {
            title: &self.mesh.name,
            facts: &format!(
                "{}. Planned by ruga {}.",
                self.facts,
                env!("CARGO_PKG_VERSION")
            ),
            about: &about.to_json(),
            mesh: &BASE64_STANDARD.encode(&data.bytes),
            maps: &elements.collect::<Vec<_>>().join("\n"),
        }))
    }
}
