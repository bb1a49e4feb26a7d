//! Whether the UVs of a mesh can carry the maps of a pose.

use nalgebra::Vector2;
use ruga_bake::check_uvs;
use ruga_io::MeshFile;

use crate::error::{CliError, counted};

/// UVs of every triangle of the file.
fn corners(mesh: &MeshFile) -> Option<Vec<[Vector2<f64>; 3]>> {
    let uvs = mesh.mesh.uvs.as_ref()?;
    let triangles = mesh.mesh.triangles.iter();
    Some(triangles.map(|t| t.map(|v| uvs[v as usize])).collect())
}

/// Refuses UVs that are not numbers, and says what else is unusual about them.
///
/// Returns warnings with counts: overlaps anywhere, UVs outside the unit square, triangles without
/// a place in it.
///
/// # Errors
/// [`CliError::MissingUvs`].
pub(crate) fn check(mesh: &MeshFile) -> Result<Vec<String>, CliError> {
    let Some(uvs) = corners(mesh) else {
        // The driver refuses a mesh without UVs before this is asked.
        return Ok(Vec::new());
    };
    let report = check_uvs(&uvs);
    if let Some(&first) = report.missing.first() {
        return Err(CliError::MissingUvs {
            mesh: mesh.path.clone(),
            count: report.missing.len(),
            first,
        });
    }
    let mut warnings = Vec::new();
    let mut warn = |text: String| warnings.push(format!("{}: {text}", mesh.path.display()));
    if let Some((face, other)) = report.overlaps.first() {
        warn(format!(
            "the texture coordinates of {} overlap others, the first are {other} and {face}; \
             wrinkles on one show on the other",
            counted(report.overlaps.len(), "triangle")
        ));
    }
    if let Some(first) = report.outside.first() {
        warn(format!(
            "the texture coordinates of {} leave the square from 0 to 1, the first is triangle \
             {first}; what lies outside is not baked",
            counted(report.outside.len(), "triangle")
        ));
    }
    if let Some(first) = report.zero_area.first() {
        warn(format!(
            "the texture coordinates of {} have no area, the first is triangle {first}; maps are \
             neutral there",
            counted(report.zero_area.len(), "triangle")
        ));
    }
    Ok(warnings)
}

/// Refuses overlaps among the `active` triangles of a pose (numbers of the file, each once).
///
/// # Errors
/// [`CliError::OverlappingUvs`] naming two of them.
pub(crate) fn check_active(mesh: &MeshFile, pose: &str, active: &[u32]) -> Result<(), CliError> {
    let Some(uvs) = corners(mesh) else {
        return Ok(());
    };
    let chosen: Vec<_> = active.iter().map(|&t| uvs[t as usize]).collect();
    let overlaps = check_uvs(&chosen).overlaps;
    match overlaps.first() {
        None => Ok(()),
        Some(&(face, other)) => Err(CliError::OverlappingUvs {
            mesh: mesh.path.clone(),
            pose: pose.to_owned(),
            first: active[other as usize],
            second: active[face as usize],
            triangles: overlaps.len(),
        }),
    }
}
