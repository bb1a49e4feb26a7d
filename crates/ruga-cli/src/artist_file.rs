//! The artist's mesh on its way back, tangents added and maps referenced.

use std::path::Path;

use nalgebra::{Vector3, Vector4};
use ruga_bake::{TangentFrame, vertex_tangents};
use ruga_io::{GlbAdditions, MeshFile, WrinkleMap, scene, write_glb};

use crate::error::CliError;

/// Name of the mesh where it can name a file; else that of its file.
pub(crate) fn file_name(mesh: &MeshFile) -> String {
    let stem = mesh.path.file_stem().map(|stem| stem.to_string_lossy());
    let names = [Some(mesh.mesh.name.as_str()), stem.as_deref()];
    let usable = names
        .into_iter()
        .flatten()
        .find(|name| scene::is_usable_file_name(name));
    usable.unwrap_or("mesh").to_owned()
}

/// Writes the mesh with the tangents of its rest shape.
///
/// # Errors
/// [`CliError::Baking`] and [`CliError::Io`].
pub(crate) fn write_artist_mesh(
    path: &Path,
    mesh: &MeshFile,
    rest: &[[TangentFrame; 3]],
    maps: &[WrinkleMap],
) -> Result<(), CliError> {
    let triangles = &mesh.mesh.triangles;
    let vertices = mesh.mesh.positions.len();
    let tangents: Vec<Vector4<f64>> = vertex_tangents(rest, triangles, vertices)
        .map_err(|source| CliError::Baking {
            mesh: mesh.path.clone(),
            pose: "rest".to_owned(),
            source,
        })?
        .into_iter()
        .map(|tangent| Vector4::from(tangent).cast())
        .collect();
    let mut normals = vec![Vector3::z(); vertices];
    for (corners, frames) in triangles.iter().zip(rest) {
        for (&vertex, frame) in corners.iter().zip(frames) {
            normals[vertex as usize] = frame.normal;
        }
    }
    let additions = GlbAdditions {
        tangents: Some(&tangents),
        normals: Some(&normals),
        maps,
    };
    Ok(write_glb(path, mesh, &additions)?)
}
