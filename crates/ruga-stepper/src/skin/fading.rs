//! Shares that rise smoothly from some vertices of a mesh on.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh, VertexId, edge_distances};

/// 0 at the vertices that are `held`, 1 at every vertex that is its `reach` (m, more than 0) or more
/// from them, without a kink at either end; the distance is measured along edges.
pub(crate) fn faded_from(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    held: &[bool],
    reach: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let sources = (0..held.len())
        .filter(|&i| held[i])
        .map(VertexId::from_index);
    let fraction = |(i, distance): (usize, f64)| {
        // Normal maps show slopes: where a straight ramp begins and ends they would show a line.
        let t = (distance / reach(i)).min(1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let furthest = (0..held.len()).map(&reach).fold(0.0, f64::max);
    let distances = edge_distances(mesh, positions, sources, furthest);
    let distances = distances.into_vec().into_iter().enumerate();
    distances.map(fraction).collect()
}
