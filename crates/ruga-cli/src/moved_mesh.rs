//! Where a body has taken the artist's mesh.

use std::path::Path;

use ruga_io::FrameMesh;
use ruga_scene::{Placement, Scene};
use ruga_stepper::{KeyResult, PoseSpec};

use crate::error::CliError;

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
