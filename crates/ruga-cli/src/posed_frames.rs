//! The tangent frames of the artist's mesh in a pose.

use nalgebra::Vector3;
use ruga_bake::{BakeError, TangentFrame, tangent_frames};
use ruga_blend::{ArtistMesh, Driver, Weights};
use ruga_mesh::Id;

/// MikkTSpace frames of the artist's triangles at `weights`; no weights: at rest.
///
/// # Errors
/// [`BakeError::TangentSpace`] and its like, for meshes that have no tangents.
pub(crate) fn posed_frames(
    artist: &ArtistMesh,
    driver: &Driver,
    weights: &Weights,
) -> Result<Vec<[TangentFrame; 3]>, BakeError> {
    let normals = blended_normals(artist, weights);
    frames(artist, driver, &driver.pose(weights), normals)
}

/// The same with the welded vertices at `control`, m: where a body has taken them.
///
/// # Errors
/// Those of [`posed_frames`].
pub(crate) fn moved_frames(
    artist: &ArtistMesh,
    driver: &Driver,
    control: &[Vector3<f64>],
) -> Result<Vec<[TangentFrame; 3]>, BakeError> {
    frames(artist, driver, control, None)
}

/// Smooth normals are taken where the file gives none.
fn frames(
    artist: &ArtistMesh,
    driver: &Driver,
    control: &[Vector3<f64>],
    normals: Option<Vec<Vector3<f64>>>,
) -> Result<Vec<[TangentFrame; 3]>, BakeError> {
    let welded = driver.welded().iter();
    let positions: Vec<Vector3<f64>> = welded.map(|welded| control[welded.index()]).collect();
    let normals = normals.unwrap_or_else(|| smooth_normals(&artist.triangles, driver, &positions));
    let uvs = artist.uvs.as_deref().unwrap_or_default();
    tangent_frames(&positions, &normals, uvs, &artist.triangles)
}

/// The file's normals, moved as the file says; `None` where it does not say it of every shape.
fn blended_normals(artist: &ArtistMesh, weights: &Weights) -> Option<Vec<Vector3<f64>>> {
    let mut normals = artist.normals.clone()?;
    for &(shape, weight) in weights.0.iter().filter(|(_, weight)| *weight != 0.0) {
        let deltas = artist.shapes[shape].normal_deltas.as_ref()?;
        for (normal, delta) in normals.iter_mut().zip(deltas) {
            *normal += delta * weight;
        }
    }
    // A normal that cancels itself out says nothing: then all are computed.
    normals
        .iter()
        .map(|normal| normal.try_normalize(1e-6))
        .collect()
}

/// Area-weighted mean of the triangles around each welded vertex: smooth across UV seams.
fn smooth_normals(
    triangles: &[[u32; 3]],
    driver: &Driver,
    positions: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); driver.rest().len()];
    for corners in triangles.iter().map(|t| t.map(|v| v as usize)) {
        let [a, b, c] = corners.map(|v| positions[v]);
        let area_normal = (b - a).cross(&(c - a));
        for vertex in corners {
            sums[driver.welded()[vertex].index()] += area_normal;
        }
    }
    driver
        .welded()
        .iter()
        .map(|welded| {
            sums[welded.index()]
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::z)
        })
        .collect()
}
