//! Areas and normals of a mesh with given positions.

use nalgebra::Vector3;

use crate::{PerFace, TriMesh};

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

/// Unit normals of the vertices, faces weighted by area; zero where all faces are degenerate, or
/// one has a corner that is not finite.
///
/// # Panics
/// When there is not one position per vertex.
pub fn vertex_normals(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.vertex_count()];
    for (face, normal) in face_normals(mesh, positions).iter() {
        for vertex in mesh.faces()[face] {
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
            areas[vertex.0 as usize] += normal.norm() / 6.0;
        }
    }
    areas
}
