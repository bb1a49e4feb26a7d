//! The one address for a place on the skin.

use nalgebra::Vector3;

use crate::{FaceId, Id, TriMesh, VertexId};

/// A place on a surface: a face and barycentric coordinates in it.
///
/// The coordinates sum to one and belong to the face's corners in order; they are not negative for
/// a place inside the face. The mesh that the face belongs to is fixed by context; between crates
/// it is the base mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPoint {
    /// The face.
    pub face: FaceId,
    /// Weights of the face's corners.
    pub barycentric: [f64; 3],
}

impl MaterialPoint {
    /// The given corner of a face: 0, 1 or 2.
    ///
    /// # Panics
    /// When `corner` is above 2.
    pub fn at_corner(face: FaceId, corner: usize) -> Self {
        assert!(corner < 3, "a triangle has no corner {corner}");
        let mut barycentric = [0.0; 3];
        barycentric[corner] = 1.0;
        Self { face, barycentric }
    }

    /// One address for each vertex: a corner of its first face; `None` for a vertex without faces, or
    /// one that the mesh does not have.
    pub fn of_vertex(mesh: &TriMesh, vertex: VertexId) -> Option<Self> {
        if vertex.index() >= mesh.vertex_count() {
            return None;
        }
        let face = *mesh.vertex_faces(vertex).first()?;
        let corner = mesh.faces()[face].iter().position(|&v| v == vertex)?;
        Some(Self::at_corner(face, corner))
    }

    /// Linear interpolation of a per-vertex field at this place.
    ///
    /// # Panics
    /// When the mesh does not have the face, or `field` has no entry for one of its vertices.
    pub fn interpolate(&self, mesh: &TriMesh, field: &[Vector3<f64>]) -> Vector3<f64> {
        let [a, b, c] = mesh.faces()[self.face];
        let [u, v, w] = self.barycentric;
        field[a.0 as usize] * u + field[b.0 as usize] * v + field[c.0 as usize] * w
    }
}
