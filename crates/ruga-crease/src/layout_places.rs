//! Places of a texture layout.

use nalgebra::Vector2;
use ruga_mesh::{FaceId, Id, MaterialPoint, PerFace, TriMesh};

/// Distance in the texture layout up to which two places are one: what files round to.
pub(crate) const SAME_UV: f64 = 1e-6;

/// Barycentric weights below this are none: what single precision leaves of a point on a seam.
const LEAST_WEIGHT: f64 = 1e-4;

/// Distance in the texture layout up to which a point beside an island lies on its border: coordinates are
/// written with three decimals, and a point on a seam is hit by no more than chance.
pub(crate) const BESIDE_UV: f64 = 1e-3;

pub(crate) fn uv_at(uvs: &PerFace<[Vector2<f64>; 3]>, place: &MaterialPoint) -> Vector2<f64> {
    let corners = uvs[place.face].iter().zip(place.barycentric);
    corners.map(|(uv, weight)| uv * weight).sum()
}

/// A place as good as on an edge or in a corner of its triangle is moved there.
pub(crate) fn onto_edges(place: MaterialPoint) -> MaterialPoint {
    let kept = |weight: f64| if weight < LEAST_WEIGHT { 0.0 } else { weight };
    let kept = place.barycentric.map(kept);
    let sum: f64 = kept.iter().sum();
    MaterialPoint {
        barycentric: kept.map(|weight| weight / sum),
        ..place
    }
}

/// The place on the border of an island that a point lies beside, if it is near one.
pub(crate) fn beside(uvs: &PerFace<[Vector2<f64>; 3]>, uv: Vector2<f64>) -> Option<MaterialPoint> {
    let mut nearest = None;
    let mut least = BESIDE_UV;
    for (number, corners) in uvs.as_slice().iter().enumerate() {
        for corner in 0..3 {
            let next = (corner + 1) % 3;
            let side = corners[next] - corners[corner];
            let share = side.dot(&(uv - corners[corner])) / side.norm_squared();
            let share = share.clamp(0.0, 1.0);
            let distance = (corners[corner] + side * share - uv).norm();
            if distance < least {
                least = distance;
                let mut barycentric = [0.0; 3];
                (barycentric[corner], barycentric[next]) = (1.0 - share, share);
                let face = FaceId::from_index(number);
                nearest = Some(MaterialPoint { face, barycentric });
            }
        }
    }
    nearest
}

/// Whether two faces lie side by side in the layout as they do on the surface, along the first one's edge that begins
/// at a corner.
pub(crate) fn hangs_together(
    mesh: &TriMesh,
    uvs: &PerFace<[Vector2<f64>; 3]>,
    [face, next]: [FaceId; 2],
    corner: usize,
) -> bool {
    let same = |corner: usize| {
        let vertex = mesh.faces()[face][corner % 3];
        let other = mesh.faces()[next].iter().position(|&v| v == vertex);
        let here = uvs[face][corner % 3];
        other.is_some_and(|other| (uvs[next][other] - here).amax() < SAME_UV)
    };
    same(corner) && same(corner + 1)
}

pub(crate) fn longest_uv_side([a, b, c]: &[Vector2<f64>; 3]) -> f64 {
    (b - a).norm().max((c - b).norm()).max((a - c).norm())
}
