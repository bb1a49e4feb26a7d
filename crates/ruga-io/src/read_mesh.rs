//! Reads the artist's mesh, whatever its format.

use std::path::Path;

use crate::gltf_mesh::read_gltf;
use crate::obj_mesh::read_obj;
use crate::{IoError, MeshFile, ObjOptions};

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
    let file = match MeshFormat::of(path)? {
        MeshFormat::Gltf => read_gltf(path, mesh_name),
        MeshFormat::Obj => read_obj(path, mesh_name, obj),
    }?;
    check_magnitudes(&file)?;
    Ok(file)
}

/// Format of a mesh file.
#[derive(Clone, Copy)]
pub(crate) enum MeshFormat {
    Gltf,
    Obj,
}

impl MeshFormat {
    /// The format that the file's name says.
    pub(crate) fn of(path: &Path) -> Result<Self, IoError> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_lowercase())
            .unwrap_or_default();
        match extension.as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "obj" => Ok(Self::Obj),
            _ => Err(IoError::UnknownFormat {
                path: path.to_owned(),
                found: format!("`.{extension}` is not a mesh file"),
                accepted: ".glb, .gltf, .obj",
            }),
        }
    }
}

/// Coordinates beyond this are no lengths in metres and no texture coordinates. OBJ can spell
/// numbers that the 32 bits of the GLB which is written in the end cannot hold. In 32 bits, so that
/// what is written with the largest is read again.
pub(crate) const LARGEST_COORDINATE: f32 = 1e30;

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
