//! Centre of a constraint function on the mesh at hand.

use nalgebra::Vector3;
use ruga_mesh::{Id, MaterialPoint, TriMesh, VertexId};

use crate::ConstraintError;

/// Barycentric coordinates up to this size are rounding. A centre that is meant to lie on a border
/// then does, and doesn't see past it.
const ZERO: f64 = 1e-9;

/// A place of a mesh as the vertices that carry it: one at a vertex, two on an edge, else three.
pub(crate) struct Centre {
    /// Ascending vertices with their weights, which are positive and sum to one.
    carriers: Vec<(VertexId, f64)>,
}

impl Centre {
    /// Checks a place, the `number`th of the caller's, and snaps it to an edge or vertex it is on.
    pub(crate) fn new(
        mesh: &TriMesh,
        place: &MaterialPoint,
        number: usize,
    ) -> Result<Self, ConstraintError> {
        if place.face.index() >= mesh.face_count() {
            return Err(ConstraintError::FaceOutOfRange {
                centre: number,
                face: place.face,
                count: mesh.face_count(),
            });
        }
        let sum: f64 = place.barycentric.iter().sum();
        let is_inside = place.barycentric.iter().all(|&b| b >= -ZERO);
        // A sum of NaN is not near one either.
        let is_sound = is_inside && (sum - 1.0).abs() <= ZERO;
        if !is_sound {
            return Err(ConstraintError::OutsideFace {
                centre: number,
                barycentric: place.barycentric,
            });
        }
        let corners = mesh.faces()[place.face].into_iter().zip(place.barycentric);
        let mut carriers: Vec<_> = corners.filter(|corner| corner.1 > ZERO).collect();
        carriers.sort_by_key(|carrier| carrier.0);
        let sum: f64 = carriers.iter().map(|carrier| carrier.1).sum();
        // Snapping has dropped up to a few 1e-9. A place whose weights do not sum to one would move
        // with the origin.
        carriers.iter_mut().for_each(|carrier| carrier.1 /= sum);
        Ok(Self { carriers })
    }

    /// The vertices that carry the place, ascending.
    pub(crate) fn carriers(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.carriers.iter().map(|carrier| carrier.0)
    }

    /// The carriers with their weights.
    pub(crate) fn weights(&self) -> &[(VertexId, f64)] {
        &self.carriers
    }

    /// Identifies the place: equal for all addresses of one edge or vertex, which lies in several faces.
    pub(crate) fn key(&self) -> Vec<(VertexId, u64)> {
        let bits = self
            .carriers
            .iter()
            .map(|&(v, weight)| (v, weight.to_bits()));
        bits.collect()
    }

    /// A field at the place.
    pub(crate) fn interpolate(&self, field: &[Vector3<f64>]) -> Vector3<f64> {
        self.carriers
            .iter()
            .fold(Vector3::zeros(), |sum, &(v, weight)| {
                sum + field[v.index()] * weight
            })
    }

    /// The other corners of the faces that the place belongs to, and carriers unless it is one.
    pub(crate) fn neighbours<'a>(
        &'a self,
        mesh: &'a TriMesh,
    ) -> impl Iterator<Item = VertexId> + 'a {
        // Faces around one carrier that hold all others: those at a vertex, the two of an edge, or
        // one.
        let (first, others) = (self.carriers[0].0, &self.carriers[1..]);
        let faces = mesh
            .vertex_faces(first)
            .iter()
            .map(|&face| mesh.faces()[face]);
        faces
            .filter(|corners| others.iter().all(|(v, _)| corners.contains(v)))
            .flatten()
            .filter(move |&v| !others.is_empty() || v != first)
    }

    /// Direction towards the neighbour with the lowest id: turns and mirrors with the mesh.
    pub(crate) fn axis(&self, mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vector3<f64> {
        let lowest = self.neighbours(mesh).min();
        lowest.map_or_else(Vector3::x, |v| {
            positions[v.index()] - self.interpolate(positions)
        })
    }
}
