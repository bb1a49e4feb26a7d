//! Closest places on the facets of a mesh, searched along it.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use ruga_mesh::{FaceId, MaterialPoint, PerEdge, TriMesh};

/// Distance, relative to half the edge that is split, up to which an end counts as lying on a
/// feature: far above rounding, far below any real distance between two curves.
const ON_CURVE: f64 = 1e-6;

/// The place closest to `target` that a walk from `start` reaches, each step to the closest of
/// the faces that meet at the present place, and strictly closer than it.
///
/// It ends in the local minimum that lies nearest along the surface, which is what tells touching
/// lips apart; a flood of all faces within the distance would find places across a fold as well.
pub(crate) fn descend(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    start: FaceId,
    target: Vector3<f64>,
) -> MaterialPoint {
    let (mut distance, mut place) = closest_on_face(mesh, positions, start, target);
    loop {
        let best = other_faces_at(mesh, place)
            .map(|face| closest_on_face(mesh, positions, face, target))
            .min_by(|l, r| l.0.total_cmp(&r.0));
        match best {
            Some((closer, there)) if closer < distance => (distance, place) = (closer, there),
            _ => return place,
        }
    }
}

/// The faces that share a place with the one it is addressed in: none inside a face, the one
/// across an edge, the fan at a corner.
fn other_faces_at(mesh: &TriMesh, place: MaterialPoint) -> impl Iterator<Item = FaceId> + '_ {
    let zero = |corner: usize| place.barycentric[corner % 3] <= 0.0;
    let vertex = (0..3).find(|&c| zero(c + 1) && zero(c + 2));
    let edge = (0..3).find(|&c| zero(c + 2));
    let fan = vertex.map_or(&[][..], |c| mesh.vertex_faces(mesh.faces()[place.face][c]));
    let across = edge
        .filter(|_| vertex.is_none())
        .and_then(|corner| mesh.neighbour(place.face, corner));
    let others = fan.iter().copied().filter(move |&face| face != place.face);
    others.chain(across)
}

/// The closest place on feature or border edges; `None` unless both ends lie on such edges.
///
/// Faces are flooded from both ends of the curve as far as they meet the ball around `target`
/// through the farther end.
pub(crate) fn on_feature(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    features: &PerEdge<bool>,
    between: [MaterialPoint; 2],
    target: Vector3<f64>,
) -> Option<MaterialPoint> {
    let ends = between.map(|end| end.interpolate(mesh, positions));
    let reach = ends
        .iter()
        .map(|end| (end - target).norm_squared())
        .fold(0.0, f64::max);
    let mut best: Option<(f64, MaterialPoint)> = None;
    let mut off_curve = [f64::INFINITY; 2];
    let mut seen = BTreeSet::from(between.map(|end| end.face));
    let mut open = Vec::from(between.map(|end| end.face));
    while let Some(face) = open.pop() {
        if closest_on_face(mesh, positions, face, target).0 > reach {
            continue;
        }
        for (corner, edge) in mesh.face_edges(face).into_iter().enumerate() {
            if features[edge] || mesh.edges()[edge].is_border() {
                let found = closest_on_edge(mesh, positions, face, corner, target);
                if best.is_none_or(|(distance, _)| found.0 < distance) {
                    best = Some(found);
                }
                for (off, end) in off_curve.iter_mut().zip(ends) {
                    *off = off.min(closest_on_edge(mesh, positions, face, corner, end).0);
                }
            }
        }
        let around = mesh.faces()[face]
            .into_iter()
            .flat_map(|v| mesh.vertex_faces(v));
        open.extend(around.filter(|&&next| seen.insert(next)));
    }
    // The edge of an active region may run beside a seam; it must not be drawn onto it.
    let are_on_curve = off_curve
        .iter()
        .all(|&off| off <= ON_CURVE * ON_CURVE * reach);
    best.filter(|_| are_on_curve).map(|(_, place)| place)
}

pub(crate) fn closest_on_edge(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    face: FaceId,
    corner: usize,
    target: Vector3<f64>,
) -> (f64, MaterialPoint) {
    let corners = mesh.faces()[face].map(|v| positions[v.0 as usize]);
    let (a, b) = (corners[corner], corners[(corner + 1) % 3]);
    let t = along(a, b, target);
    let mut barycentric = [0.0; 3];
    barycentric[corner] = 1.0 - t;
    barycentric[(corner + 1) % 3] = t;
    let distance = (a + (b - a) * t - target).norm_squared();
    (distance, MaterialPoint { face, barycentric })
}

/// Parameter in 0..=1 of the point of a segment that is closest to `target`.
fn along(a: Vector3<f64>, b: Vector3<f64>, target: Vector3<f64>) -> f64 {
    let length = (b - a).norm_squared();
    if length > 0.0 {
        ((target - a).dot(&(b - a)) / length).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Squared distance (m²) to the closest place of a face, and that place.
pub(crate) fn closest_on_face(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    face: FaceId,
    target: Vector3<f64>,
) -> (f64, MaterialPoint) {
    let [a, b, c] = mesh.faces()[face].map(|v| positions[v.0 as usize]);
    let normal = (b - a).cross(&(c - a));
    let double_area = normal.norm_squared();
    let part =
        |p: Vector3<f64>, q: Vector3<f64>| (q - p).cross(&(target - p)).dot(&normal) / double_area;
    let [u, v, w] = [part(b, c), part(c, a), part(a, b)];
    let sum = u + v + w;
    // In a face with hardly any area rounding may leave nothing of the three, which is no place.
    if double_area > 0.0 && u >= 0.0 && v >= 0.0 && w >= 0.0 && sum > 0.5 {
        // Normalised, so that the coordinates sum to one to the last bit that division allows.
        let barycentric = [u / sum, v / sum, w / sum];
        let distance = (target - a).dot(&normal).powi(2) / double_area;
        return (distance, MaterialPoint { face, barycentric });
    }
    (0..3)
        .map(|corner| closest_on_edge(mesh, positions, face, corner, target))
        .min_by(|l, r| l.0.total_cmp(&r.0))
        .expect("a face has three edges")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_of_hardly_any_area_gives_finite_coordinates() {
        let mesh = TriMesh::new(3, vec![[0, 1, 2]]).expect("one face");
        // The area squared is the smallest number there is, its thirds are zero.
        let side = 1.49e-81;
        let corners = [[0.0, 0.0], [side, 0.0], [0.0, side]];
        let positions = corners.map(|[x, y]| Vector3::new(x, y, 0.0));
        let target = Vector3::new(side / 3.0, side / 3.0, 0.0);
        let place = descend(&mesh, &positions, FaceId(0), target);
        let sum: f64 = place.barycentric.iter().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{:?}", place.barycentric);
    }
}
