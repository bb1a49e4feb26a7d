//! The artist's file: its mesh, and what is needed to write that mesh back.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Matrix4};
use ruga_blend::ArtistMesh;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::IoError;
use crate::gltf_document::GltfDocument;
use crate::gltf_mesh::read_gltf;
use crate::obj_mesh::read_obj;

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
    /// What the file's coordinates were multiplied by to become metres: the symmetric part `S` of
    /// the node's world transform `R S`. The rotation `R` and the translation are *not* applied,
    /// so the axes of [`MeshFile::mesh`] are those of the file.
    pub stretch: Matrix3<f64>,
    /// World transform of the node that carries the mesh, in metres; identity for OBJ. Of a mesh with
    /// an armature that of its first joint, after the joint's bind matrix.
    pub world_from_node: Matrix4<f64>,
    /// Metres per unit of the file's world; 1 as it is read, see [`MeshFile::scaled`].
    pub metres_per_unit: f64,
    /// The document that the mesh was read from; `None` for OBJ, and for meshes made by code.
    pub document: Option<GltfDocument>,
    /// What was assumed or left out, in words for the user.
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

/// What of a material does not need its images.
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

/// What an OBJ file does not say about itself.
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

/// Reads a mesh with its blend shapes from `.glb`, `.gltf` or `.obj`.
///
/// Positions and deltas come back in metres, UVs with V pointing down in the set and transform
/// that the material's normal texture uses (else the base colour's, else `TEXCOORD_0`). Vertices
/// keep their order. `obj` is for OBJ files alone; glTF carries its shapes and its unit itself.
///
/// # Errors
/// [`IoError`] naming the file and, for glTF, the accessor, buffer or primitive at fault. No file,
/// however damaged, makes it panic.
pub fn read_mesh(
    path: &Path,
    mesh_name: Option<&str>,
    obj: &ObjOptions,
) -> Result<MeshFile, IoError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    let file = match extension.as_str() {
        "glb" | "gltf" => read_gltf(path, mesh_name),
        "obj" => read_obj(path, mesh_name, obj),
        _ => Err(IoError::UnknownFormat {
            path: path.to_owned(),
            found: format!("`.{extension}` is not a mesh file"),
            accepted: ".glb, .gltf, .obj",
        }),
    }?;
    check_magnitudes(&file)?;
    Ok(file)
}

/// Coordinates beyond this are no lengths in metres and no texture coordinates. OBJ can spell
/// numbers that the 32 bits of the GLB which is written in the end cannot hold. In 32 bits, so that
/// what is written with the largest is read again.
const LARGEST_COORDINATE: f32 = 1e30;

fn check_magnitudes(file: &MeshFile) -> Result<(), IoError> {
    let mesh = &file.mesh;
    let shapes = mesh.shapes.iter();
    let shapes = shapes.map(|shape| {
        (
            format!("blend shape `{}`", shape.name),
            &shape.position_deltas,
        )
    });
    let vectors = std::iter::once(("the mesh".to_owned(), &mesh.positions)).chain(shapes);
    let too_large = |c: &f64| c.abs() as f32 > LARGEST_COORDINATE;
    let fault = |element: String, value: f64| {
        let reason = format!("found {value:e}; accepted: numbers up to {LARGEST_COORDINATE:e}");
        Err(IoError::malformed(&file.path, element, reason))
    };
    for (whose, vectors) in vectors {
        for (vertex, vector) in vectors.iter().enumerate() {
            if let Some(value) = vector.iter().copied().find(too_large) {
                return fault(format!("vertex {vertex} of {whose}"), value);
            }
        }
    }
    for (vertex, uv) in mesh.uvs.iter().flatten().enumerate() {
        if let Some(value) = uv.iter().copied().find(too_large) {
            return fault(format!("texture coordinate of vertex {vertex}"), value);
        }
    }
    Ok(())
}
