//! Where a body or a sheet has taken the artist's mesh.

use std::path::Path;

use nalgebra::Vector3;
use ruga_io::{FrameMesh, MovedMesh, key_percent, read_obj_positions};
use ruga_scene::{Placement, Scene};
use ruga_stepper::{KeyResult, PoseSpec};

use crate::error::CliError;
use crate::output_folder::OutputFolder;
use crate::pose_record::PoseRecord;

/// Writes the artist's mesh as the body moved it; false for a mesh that only blend shapes move. Vertices
/// are in the order of a glTF file's; those of an OBJ file are divided at the seams of its texture
/// coordinates.
///
/// # Errors
/// [`CliError::Io`].
pub(crate) fn write_moved_mesh(
    scene: &Scene,
    path: &Path,
    pose: &PoseSpec,
    key: &KeyResult,
) -> Result<bool, CliError> {
    let Some(control) = &key.artist_positions else {
        return Ok(false);
    };
    let artist = &scene.mesh.mesh;
    let frame = FrameMesh {
        name: &pose.name,
        positions: &scene.driver.unweld(control),
        triangles: &artist.triangles,
        uvs: artist.uvs.as_deref().unwrap_or_default(),
        uv_triangles: &artist.triangles,
    };
    Placement::of(&scene.mesh).write_obj(path, &frame)?;
    Ok(true)
}

/// File of the artist's mesh at a key of a pose that has moved it, relative to the output folder.
pub(crate) fn moved_file(pose: &str, key: f64) -> String {
    format!("bodies/{pose}_{}.obj", key_percent(key))
}

/// The artist's mesh at every key of poses that have moved it, of this run and of earlier ones; and warnings of files
/// that cannot be read or do not fit it any more.
pub(crate) fn moved_meshes(
    scene: &Scene,
    (output, all): (&Path, &OutputFolder),
    poses: &[PoseRecord],
) -> (Vec<MovedMesh>, Vec<String>) {
    let placement = Placement::of(&scene.mesh);
    let vertices = scene.mesh.mesh.positions.len();
    let (mut moved, mut warnings) = (Vec::new(), Vec::new());
    for record in poses {
        let pose = &record.report.name;
        let seconds = all.pose(pose).seconds;
        let moved_at = |key: f64, positions: Vec<Vector3<f64>>| MovedMesh {
            pose: pose.clone(),
            key,
            seconds: key * seconds,
            normals: scene.moved_normals(&positions),
            positions,
        };
        for &key in &record.keys {
            let file = moved_file(pose, key);
            if !record.files.contains(&file) {
                continue;
            }
            // What an earlier run has finished stays, whatever became of one file.
            let wrong = match read_obj_positions(&output.join(&file)) {
                Ok(places) if places.len() == vertices => {
                    let places = places.iter().map(|x| placement.place_in_file((*x).into()));
                    moved.push(moved_at(key, places.collect()));
                    continue;
                }
                Ok(places) => format!(
                    "{file} has {} vertices and the mesh has {vertices}",
                    places.len()
                ),
                Err(error) => error.to_string(),
            };
            warnings.push(format!(
                "{wrong}; the GLB leaves this key out: delete the file and bake with `--resume`, which makes pose `{pose}` again"
            ));
        }
    }
    (moved, warnings)
}
