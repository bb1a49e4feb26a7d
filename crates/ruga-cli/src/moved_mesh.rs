//! Where a body has taken the artist's mesh.

use std::path::Path;

use nalgebra::Vector3;
use ruga_io::{ObjFrame, key_percent, write_obj_frame};
use ruga_mesh::Id;
use ruga_stepper::{KeyResult, PoseSpec};

use crate::error::CliError;
use crate::placement::Placement;
use crate::project::Project;

/// Writes the artist's mesh as the body moved it and returns the file's name in `folder`; `None` for a
/// mesh that only blend shapes move. Vertices are in the order of a glTF file's; those of an OBJ file are
/// divided at the seams of its texture coordinates.
///
/// # Errors
/// [`CliError::Io`].
pub(crate) fn write_moved_mesh(
    project: &Project,
    folder: &Path,
    pose: &PoseSpec,
    key: &KeyResult,
) -> Result<Option<String>, CliError> {
    let Some(control) = &key.artist_positions else {
        return Ok(None);
    };
    let placement = Placement::of(&project.mesh);
    let welded = project.driver.welded().iter();
    let positions: Vec<Vector3<f64>> = welded
        .map(|welded| placement.in_world(&control[welded.index()]))
        .collect();
    let artist = &project.mesh.mesh;
    let uvs = artist.uvs.as_deref().unwrap_or_default();
    let frame = ObjFrame {
        name: &artist.name,
        positions: &positions,
        triangles: &artist.triangles,
        uvs,
        uv_triangles: match uvs.is_empty() {
            true => &[],
            false => &artist.triangles,
        },
    };
    let file = format!("bodies/{}_{}.obj", pose.name, key_percent(key.load));
    write_obj_frame(&folder.join(&file), &frame)?;
    Ok(Some(file))
}
