//! The tangent frames of the artist's mesh in a pose.

use nalgebra::Vector3;
use ruga_bake::{BakeError, TangentFrame, tangent_frames};
use ruga_blend::{ArtistMesh, Driver, SmoothGroups, Weights};

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

/// MikkTSpace frames of the artist's triangles with the welded vertices at `control` (m), where a
/// body has taken them.
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

/// Tangent frames of a pose; normals that are not given are computed, smooth but where the file's
/// rest normals are not.
fn frames(
    artist: &ArtistMesh,
    driver: &Driver,
    control: &[Vector3<f64>],
    normals: Option<Vec<Vector3<f64>>>,
) -> Result<Vec<[TangentFrame; 3]>, BakeError> {
    let positions = driver.unweld(control);
    let normals = normals.unwrap_or_else(|| computed_normals(artist, driver, &positions));
    let uvs = artist.uvs.as_deref().unwrap_or_default();
    tangent_frames(&positions, &normals, uvs, &artist.triangles)
}

/// The file's normals, moved as the file says; `None` where it does not say it of every shape.
fn blended_normals(artist: &ArtistMesh, weights: &Weights) -> Option<Vec<Vector3<f64>>> {
    let mut normals = artist.normals.clone()?;
    for (shape, weight) in weights.iter().filter(|(_, weight)| *weight != 0.0) {
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

/// Area-weighted mean of the triangles around each vertex: smooth across UV seams, not across the
/// edges at which the file's rest normals differ.
pub(crate) fn computed_normals(
    artist: &ArtistMesh,
    driver: &Driver,
    positions: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let groups = SmoothGroups::new(artist, driver);
    let group_of = &groups.of_vertex;
    let mut sums = vec![Vector3::zeros(); groups.count];
    for corners in artist.triangles.iter().map(|t| t.map(|v| v as usize)) {
        let [a, b, c] = corners.map(|v| positions[v]);
        let area_normal = (b - a).cross(&(c - a));
        for vertex in corners {
            sums[group_of[vertex] as usize] += area_normal;
        }
    }
    let normal = |group: &u32| {
        sums[*group as usize]
            .try_normalize(0.0)
            .unwrap_or_else(Vector3::z)
    };
    group_of.iter().map(normal).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    /// A roof: two rectangles of two triangles, the ridge between them hard or smooth, with a UV
    /// seam across.
    fn roof(is_hard: bool) -> ArtistMesh {
        let slope = |side: f64| Vector3::new(side, 0.0, 1.0).normalize();
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        let mut triangles = Vec::new();
        for side in [-1.0, 1.0] {
            for half in [0.0, 1.0] {
                let first = positions.len() as u32;
                for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                    positions.push(Vector3::new(side * x, half + y, -x));
                    normals.push(match is_hard || x > 0.0 {
                        true => slope(side),
                        false => Vector3::z(),
                    });
                }
                let [b, d] = match side > 0.0 {
                    true => [1, 3],
                    false => [3, 1],
                };
                triangles.extend([[first, first + b, first + 2], [first, first + 2, first + d]]);
            }
        }
        ArtistMesh {
            uvs: Some(vec![Vector2::zeros(); positions.len()]),
            positions,
            normals: Some(normals),
            triangles,
            ..ArtistMesh::default()
        }
    }

    #[test]
    fn computed_normals_keep_hard_edges_and_cross_seams() {
        for is_hard in [true, false] {
            let artist = roof(is_hard);
            let driver = Driver::new(&artist).expect("a roof");
            let computed = computed_normals(&artist, &driver, &artist.positions);
            for (found, wanted) in computed.iter().zip(artist.normals.as_ref().expect("some")) {
                assert!(
                    (found - wanted).norm() < 1e-9,
                    "{is_hard}: {found} {wanted}"
                );
            }
        }
    }
}
