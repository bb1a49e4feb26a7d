//! Areas and normals of a mesh with given positions.

use nalgebra::Vector3;

use crate::{FaceId, Id, PerFace, PerVertex, TriMesh};

/// Normal of every face, of length twice its area (m²).
///
/// # Panics
/// When there is not one position per vertex.
pub fn face_normals(mesh: &TriMesh, positions: &[Vector3<f64>]) -> PerFace<Vector3<f64>> {
    assert_eq!(
        positions.len(),
        mesh.vertex_count(),
        "one position per vertex"
    );
    mesh.faces()
        .as_slice()
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|v| positions[v.0 as usize]);
            (b - a).cross(&(c - a))
        })
        .collect()
}

/// Area of every face (m²).
///
/// # Panics
/// When there is not one position per vertex.
pub fn face_areas(mesh: &TriMesh, positions: &[Vector3<f64>]) -> PerFace<f64> {
    let normals = face_normals(mesh, positions).into_vec().into_iter();
    normals.map(|normal| 0.5 * normal.norm()).collect()
}

/// Mean length of the edges at every vertex (m); not a number at a vertex without edges.
///
/// # Panics
/// When there is not one position per vertex.
pub fn mean_edge_lengths(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<f64> {
    assert_eq!(
        positions.len(),
        mesh.vertex_count(),
        "one position per vertex"
    );
    let mut sums = vec![(0.0, 0.0); positions.len()];
    for edge in mesh.edges().as_slice() {
        let [a, b] = edge.vertices.map(Id::index);
        let length = (positions[b] - positions[a]).norm();
        for v in [a, b] {
            sums[v].0 += length;
            sums[v].1 += 1.0;
        }
    }
    sums.iter().map(|(sum, count)| sum / count).collect()
}

/// Mean over the faces at every vertex of what `of_face` knows of them; 0 at a vertex without faces.
pub fn vertex_means(mesh: &TriMesh, of_face: impl Fn(FaceId) -> f64) -> PerVertex<f64> {
    let mut sums = vec![(0.0, 0.0); mesh.vertex_count()];
    for (face, corners) in mesh.faces().iter() {
        let value = of_face(face);
        for v in corners {
            let (sum, count) = &mut sums[v.index()];
            *sum += value;
            *count += 1.0;
        }
    }
    let means = sums.into_iter();
    means
        .map(|(sum, count)| sum / f64::max(count, 1.0))
        .collect()
}

/// Orthonormal tangents of a triangle with an area, the first along its first edge; not numbers for a
/// triangle without.
pub fn triangle_frame(corners: &[Vector3<f64>; 3]) -> [Vector3<f64>; 2] {
    let along = (corners[1] - corners[0]).normalize();
    let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
    [along, normal.normalize().cross(&along)]
}

/// Unit normals of the vertices, faces weighted by area; zero where all faces are degenerate, or
/// one has a corner that is not finite.
///
/// # Panics
/// When there is not one position per vertex.
pub fn vertex_normals(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.vertex_count()];
    for (face, normal) in face_normals(mesh, positions).iter() {
        for vertex in mesh.faces()[face] {
            // A face normal is as long as twice the area, so the sum is weighted as it stands.
            normals[vertex.0 as usize] += normal;
        }
    }
    for normal in &mut normals {
        let length = normal.norm();
        *normal = if length > 0.0 && length.is_finite() {
            *normal / length
        } else {
            Vector3::zeros()
        };
    }
    normals
}

/// A third of the area of the faces around each vertex (m²); not a number where one of them has a
/// corner that is not.
///
/// # Panics
/// When there is not one position per vertex.
pub fn vertex_areas(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.vertex_count()];
    for (face, normal) in face_normals(mesh, positions).iter() {
        for vertex in mesh.faces()[face] {
            // A third of half of the normal's length.
            areas[vertex.0 as usize] += normal.norm() / 6.0;
        }
    }
    areas
}

/// A border turning by more than this (degrees) is a corner: those of a square patch are, the polygon
/// of a hole or a cut is not.
const SHARP_TURN: f64 = 60.0;

/// The border vertices that subdivision should leave sharp: the border turns there by more than 60
/// degrees.
///
/// # Panics
/// When there is not one position per vertex.
pub fn sharp_border_corners(mesh: &TriMesh, positions: &[Vector3<f64>]) -> PerVertex<bool> {
    let normals = face_normals(mesh, positions);
    let limit = SHARP_TURN.to_radians().cos();
    let mut corners = PerVertex::filled(mesh.vertex_count(), false);
    for vertex in corners.ids() {
        let Some(ring) = mesh.ring(vertex).filter(|ring| !ring.closed) else {
            continue;
        };
        let normal: Vector3<f64> = mesh.vertex_faces(vertex).iter().map(|&f| normals[f]).sum();
        // Only the turn within the surface counts: a border may run over a bend of the surface.
        // Without a normal this is NaN, for which no turn is sharp.
        let flat = |v: Vector3<f64>| v - normal * (normal.dot(&v) / normal.norm_squared());
        let here = positions[vertex.index()];
        let (start, end) = (ring.spokes[0], ring.spokes[ring.spokes.len() - 1]);
        let incoming = flat(here - positions[end.index()]);
        let outgoing = flat(positions[start.index()] - here);
        corners[vertex] = incoming.dot(&outgoing) < limit * incoming.norm() * outgoing.norm();
    }
    corners
}
