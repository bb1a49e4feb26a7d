//! The artist's mesh on its way back, tangents added and maps referenced.

use std::fs;
use std::path::Path;

use nalgebra::{Vector3, Vector4};
use ruga_bake::{TangentFrame, vertex_tangents};
use ruga_io::{GlbAdditions, MeshFile, MovedMesh, WrinkleMap, WrittenGlb, write_glb};
use ruga_scene::{SceneError, file};

use crate::error::CliError;
use crate::pose_record::Records;

/// Name of the list of maps in the GLB's JSON.
const MAPS_IN_GLB: &str = "\"wrinkleMaps\"";

/// Cosine of the angle by which a corner's tangent may differ from its vertex's: 10 degrees, about
/// where a wrinkle's shading visibly turns.
const SAME_TANGENT: f64 = 0.985;

/// Name of the mesh where it can name a file; else that of its file.
pub(crate) fn file_name(mesh: &MeshFile) -> String {
    let stem = mesh.path.file_stem().map(|stem| stem.to_string_lossy());
    let names = [Some(mesh.mesh.name.as_str()), stem.as_deref()];
    let usable = names
        .into_iter()
        .flatten()
        .find(|name| file::is_usable_file_name(name));
    usable.unwrap_or("mesh").to_owned()
}

/// Refuses a folder in which the GLB would replace a file of the artist's: the one that the mesh was
/// read from, or, unless `force` is given, one that no earlier run has written.
///
/// # Errors
/// [`CliError::Output`].
pub(crate) fn refuse_own_folder(
    folder: &Path,
    mesh: &MeshFile,
    force: bool,
) -> Result<(), CliError> {
    let name = format!("{}.glb", file_name(mesh));
    let path = folder.join(&name);
    let is_read = match (path.canonicalize(), mesh.path.canonicalize()) {
        (Ok(written), Ok(read)) => written == read,
        _ => false,
    };
    let refuse = |reason: String| {
        Err(CliError::Output {
            path: folder.to_owned(),
            reason,
        })
    };
    if is_read {
        return refuse(format!(
            "{name} in it is the mesh of the scene and would be replaced; choose another folder, \
             or `--maps-only`"
        ));
    }
    if path.exists() && !force && !is_written_by_ruga(folder, &name) {
        return refuse(format!(
            "{name} in it is no result of an earlier run and would be replaced; choose another \
             folder, write no GLB with `--maps-only`, or replace the file with `--force`"
        ));
    }
    Ok(())
}

/// Whether an earlier run has written the GLB of this name: the manifest says so; or, where a run
/// that was killed or one with `--maps-only` has left none that does, the GLB itself, beside the
/// records of baked poses, lists wrinkle maps.
fn is_written_by_ruga(folder: &Path, name: &str) -> bool {
    let manifest = fs::read(folder.join("wrinkles.json")).unwrap_or_default();
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).unwrap_or_default();
    if manifest["glb"]["file"] == name {
        return true;
    }
    let lists_maps = || {
        let glb = fs::read(folder.join(name)).unwrap_or_default();
        let mark = MAPS_IN_GLB.as_bytes();
        glb.windows(mark.len()).any(|bytes| bytes == mark)
    };
    !Records::of_bake(folder).all().is_empty() && lists_maps()
}

/// Writes the mesh with the tangents of its rest shape, its maps, and where poses have taken it.
///
/// # Errors
/// [`SceneError::Baking`] and [`CliError::Io`].
pub(crate) fn write_artist_mesh(
    path: &Path,
    mesh: &MeshFile,
    rest: &[[TangentFrame; 3]],
    (maps, moved): (&[WrinkleMap], &[MovedMesh]),
) -> Result<WrittenGlb, CliError> {
    let triangles = &mesh.mesh.triangles;
    let vertices = mesh.mesh.positions.len();
    let tangents: Vec<Vector4<f64>> = vertex_tangents(rest, triangles, vertices)
        .map_err(|source| SceneError::Baking {
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
        moved,
    };
    let mut written = write_glb(path, mesh, &additions)?;
    written.warnings.extend(conflicts(mesh, rest, &tangents));
    for warning in &mut written.warnings {
        *warning = format!("{}: {warning}", mesh.path.display());
    }
    Ok(written)
}

/// Warning about vertices whose tangent does not fit what the triangles around them want.
fn conflicts(
    mesh: &MeshFile,
    rest: &[[TangentFrame; 3]],
    tangents: &[Vector4<f64>],
) -> Option<String> {
    let mut found = Vec::new();
    let uvs = mesh.mesh.uvs.as_ref()?;
    for (corners, frames) in mesh.mesh.triangles.iter().zip(rest) {
        let [a, b, c] = corners.map(|v| uvs[v as usize]);
        // Without an area in the texture a triangle has no tangents of its own.
        if (b - a).perp(&(c - a)) == 0.0 {
            continue;
        }
        for (&vertex, frame) in corners.iter().zip(frames) {
            let tangent = &tangents[vertex as usize];
            let cosine = tangent.xyz().dot(&frame.tangent);
            if cosine < SAME_TANGENT || tangent.w * frame.sign < 0.0 {
                found.push(vertex);
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    let first = found.first()?;
    Some(format!(
        "at {}, the first is number {first}, the texture is mirrored or torn between triangles, \
         but a vertex has one tangent: wrinkles next to it are shaded wrongly in the GLB. Split \
         the mesh along such seams when it is exported",
        match found.len() {
            1 => "1 vertex".to_owned(),
            count => format!("{count} vertices"),
        }
    ))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Matrix4, Vector2};
    use ruga_bake::tangent_frames;
    use ruga_blend::ArtistMesh;

    use super::*;

    /// Two triangles of a square; the texture of the second goes on, or back as in a mirror.
    fn square(is_mirrored: bool) -> MeshFile {
        let corner = if is_mirrored { 0.2 } else { 1.0 };
        let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let uvs = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [corner, corner]];
        MeshFile {
            path: "square.obj".into(),
            mesh: ArtistMesh {
                positions: at.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
                normals: Some(vec![Vector3::z(); 4]),
                uvs: Some(uvs.map(Vector2::from).to_vec()),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                ..ArtistMesh::default()
            },
            parts: Vec::new(),
            default_weights: Vec::new(),
            stretch: Matrix3::identity(),
            world_from_node: Matrix4::identity(),
            metres_per_unit: 1.0,
            document: None,
            warnings: Vec::new(),
        }
    }

    #[test]
    fn vertices_that_need_two_tangents_are_counted() {
        for (is_mirrored, expected) in [(false, None), (true, Some("2 vertices, the first is"))] {
            let file = square(is_mirrored);
            let mesh = &file.mesh;
            let (normals, uvs) = (mesh.normals.as_ref(), mesh.uvs.as_ref());
            let (normals, uvs) = (normals.expect("normals"), uvs.expect("coordinates"));
            let frames = tangent_frames(&mesh.positions, normals, uvs, &mesh.triangles);
            let frames = frames.expect("a square has tangents");
            let tangents = vertex_tangents(&frames, &mesh.triangles, 4).expect("four of them");
            let tangents: Vec<_> = tangents.iter().map(|t| Vector4::from(*t).cast()).collect();
            let found = conflicts(&file, &frames, &tangents);
            assert_eq!(found.is_some(), expected.is_some(), "{found:?}");
            assert!(
                found
                    .unwrap_or_default()
                    .contains(expected.unwrap_or_default())
            );
        }
    }
}
