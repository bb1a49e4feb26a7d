//! Areas and normals of a mesh with given positions.

use nalgebra::Vector3;

use crate::{PerFace, TriMesh};

/// Normal of every face, of length twice its area (m²).
pub fn face_normals(mesh: &TriMesh, positions: &[Vector3<f64>]) -> PerFace<Vector3<f64>> {
    mesh.faces()
        .as_slice()
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|v| positions[v.0 as usize]);
            (b - a).cross(&(c - a))
        })
        .collect()
}

/// Unit normals of the vertices, faces weighted by area; zero where all faces are degenerate.
pub fn vertex_normals(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.vertex_count()];
    for (face, normal) in face_normals(mesh, positions).iter() {
        for vertex in mesh.faces()[face] {
            normals[vertex.0 as usize] += normal;
        }
    }
    for normal in &mut normals {
        *normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
    }
    normals
}

/// A third of the area of the faces around each vertex, m².
pub fn vertex_areas(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.vertex_count()];
    for (face, normal) in face_normals(mesh, positions).iter() {
        for vertex in mesh.faces()[face] {
            areas[vertex.0 as usize] += normal.norm() / 6.0;
        }
    }
    areas
}
