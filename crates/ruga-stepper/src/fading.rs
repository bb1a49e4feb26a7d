//! Shares that rise smoothly from some vertices of a mesh on.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh, VertexId, edge_distances};

/// 0 at the vertices that are `held`, 1 at `reach` (m, more than 0) from them and beyond, without a
/// kink at either end; the distance is measured along edges.
pub(crate) fn faded_from(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    held: &[bool],
    reach: f64,
) -> Vec<f64> {
    let sources = (0..held.len())
        .filter(|&i| held[i])
        .map(VertexId::from_index);
    let share = |distance: f64| {
        let t = (distance / reach).min(1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let distances = edge_distances(mesh, positions, sources, reach);
    distances.into_vec().into_iter().map(share).collect()
}
