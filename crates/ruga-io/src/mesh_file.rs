//! The artist's file: its mesh, and what is needed to write that mesh back.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use nalgebra::{Matrix3, Matrix4};
use ruga_blend::ArtistMesh;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::gltf_document::GltfDocument;

/// A mesh as its file holds it.
#[derive(Clone, Debug)]
pub struct MeshFile {
    /// The file.
    pub path: PathBuf,
    /// The mesh, in metres at the size it has in the world; see [`MeshFile::stretch`].
    pub mesh: ArtistMesh,
    /// Parts of the mesh in file order; each has one material.
    pub parts: Vec<MeshPart>,
    /// Weights of the blend shapes in the file's rest state, one per shape; usually zeros.
    pub default_weights: Vec<f64>,
    /// Factor that turned the file's coordinates into metres: the symmetric part `S` of the node's
    /// world transform `R S`. The rotation `R` and the translation are *not* applied,
    /// so the axes of [`MeshFile::mesh`] are those of the file.
    pub stretch: Matrix3<f64>,
    /// World transform of the node that carries the mesh, in metres; identity for OBJ. Of a mesh with
    /// an armature that of its first joint, after the joint's bind matrix.
    pub world_from_node: Matrix4<f64>,
    /// Metres per unit of the file's world; 1 as it is read, see [`MeshFile::scaled`].
    pub metres_per_unit: f64,
    /// The document that the mesh was read from; `None` for OBJ, and for meshes made by code.
    pub document: Option<GltfDocument>,
    /// Warnings in words for the user: what was assumed or left out.
    pub warnings: Vec<String>,
}

impl MeshFile {
    /// The mesh with lengths that are `metres_per_unit` times as long, in the place that follows; for
    /// files whose unit is not the metre. [`write_glb`](crate::write_glb) writes it back in the unit
    /// of the file.
    pub fn scaled(mut self, metres_per_unit: f64) -> Self {
        let deltas = self.mesh.shapes.iter_mut().map(|s| &mut s.position_deltas);
        for vectors in std::iter::once(&mut self.mesh.positions).chain(deltas) {
            vectors.iter_mut().for_each(|v| *v *= metres_per_unit);
        }
        self.stretch *= metres_per_unit;
        let mut world = self.world_from_node.fixed_rows_mut::<3>(0);
        world *= metres_per_unit;
        self.metres_per_unit *= metres_per_unit;
        self
    }
}

/// A run of triangles that share one material (glTF: a primitive).
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPart {
    /// The vertices it uses. Parts either share a range or have ranges apart.
    pub vertices: Range<usize>,
    /// Its triangles.
    pub triangles: Range<usize>,
    /// Its material, where the file names one.
    pub material: Option<Material>,
}

/// Properties of a material that need no images.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name.
    pub name: Option<String>,
    /// Linear red, green, blue and alpha, 0 to 1.
    pub base_color: [f64; 4],
    /// 0 to 1.
    pub metallic: f64,
    /// 0 to 1.
    pub roughness: f64,
    /// Whether both sides are drawn.
    pub double_sided: bool,
}

/// Facts that an OBJ file does not state about itself.
#[derive(Clone, Debug, Default)]
pub struct ObjOptions {
    /// Blend shapes: name and OBJ file of each.
    pub targets: BTreeMap<String, PathBuf>,
    /// Unit of the coordinates.
    pub length_unit: LengthUnit,
}

/// Unit of lengths in a file that does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LengthUnit {
    /// Metres.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
}

impl LengthUnit {
    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            LengthUnit::Metre => 1.0,
            LengthUnit::Centimetre => 0.01,
            LengthUnit::Millimetre => 0.001,
        }
    }

    /// The word for it in scenes.
    pub fn word(self) -> &'static str {
        match self {
            LengthUnit::Metre => "m",
            LengthUnit::Centimetre => "cm",
            LengthUnit::Millimetre => "mm",
        }
    }
}
