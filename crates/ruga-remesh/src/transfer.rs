//! Transfer of values from the old mesh to the new one.

use ruga_mesh::{Id, MaterialPoint, PerVertex, SparseRows, VertexId};

/// Map from per-vertex values of the old mesh to values of the new one.
///
/// A vertex that survives takes its value as it is; a new one the linear interpolation at the
/// place of the old mesh closest to it: three weights, not negative, of sum one.
///
/// On a curved surface carry *displacements* from the surface below, not positions: a new vertex
/// lies on the smooth surface, off the old facets, and zero displacement must stay zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// Place of each new vertex on the old mesh.
    pub origins: PerVertex<MaterialPoint>,
    /// Row per new vertex, column per old vertex: what carries numbers and vectors over.
    pub rows: SparseRows,
    /// Old vertex that each new vertex is, if it is one.
    pub survivors: PerVertex<Option<VertexId>>,
}

impl Transfer {
    /// Pins and flags at the new vertices: the survivor's own, `born` for a new vertex.
    ///
    /// # Panics
    /// Where `old` has fewer values than the old mesh has vertices.
    pub fn flags<T: Clone>(&self, old: &PerVertex<T>, born: T) -> PerVertex<T> {
        // A pin belongs to a vertex, not to a place: between two pinned ones nothing is pinned.
        self.survivors
            .iter()
            .map(|(_, survivor)| survivor.map_or_else(|| born.clone(), |v| old[v].clone()))
            .collect()
    }

    /// The new vertex that each old one became; `None` where it was removed.
    ///
    /// # Panics
    /// Where the old mesh has more than `old_count` vertices.
    pub fn new_from_old(&self, old_count: usize) -> PerVertex<Option<VertexId>> {
        let mut result = PerVertex::filled(old_count, None);
        for (new, survivor) in self.survivors.iter() {
            if let Some(old) = survivor {
                result[*old] = Some(new);
            }
        }
        result
    }

    /// Says whether new and old vertices are the same in the same order, as after a remesh that had
    /// nothing to do.
    pub fn is_identity(&self, old_count: usize) -> bool {
        self.survivors.len() == old_count
            && self
                .survivors
                .iter()
                .all(|(v, survivor)| survivor.is_some_and(|s| s.index() == v.index()))
    }
}
