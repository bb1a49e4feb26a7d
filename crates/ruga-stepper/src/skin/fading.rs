//! Shares that rise smoothly from some vertices of a mesh on.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh, VertexId, edge_distances};

/// Share at every vertex: 0 where it is `held`, 1 at `reach` (m, more than 0) from there and beyond.
pub(crate) fn faded_from(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    held: &[bool],
    reach: f64,
) -> Vec<f64> {
    let distances = distances_from(mesh, positions, held, reach).into_iter();
    distances.map(|distance| faded(distance, reach)).collect()
}

/// Distance (m) of every vertex from those that are `held`, along edges; infinite beyond `limit`.
pub(crate) fn distances_from(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    held: &[bool],
    limit: f64,
) -> Vec<f64> {
    let sources = (0..held.len()).filter(|&i| held[i]);
    let sources = sources.map(VertexId::from_index);
    edge_distances(mesh, positions, sources, limit).into_vec()
}

/// Share at a distance: 0 at none, 1 from `reach` on, without a kink at either end.
pub(crate) fn faded(distance: f64, reach: f64) -> f64 {
    // Normal maps show slopes: where a straight ramp begins and ends they would show a line.
    let t = (distance / reach).min(1.0);
    t * t * (3.0 - 2.0 * t)
}
