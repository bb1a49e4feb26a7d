//! Distance over the surface from a set of vertices.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::Vector3;

use crate::{Id, PerVertex, TriMesh, VertexId};

/// Shortest distance (m) along edges from the nearest of `sources`; infinite beyond `limit`.
///
/// Dijkstra 1959. Edge paths are up to 15 % longer than true geodesics on regular meshes, which is
/// good enough to grow a region. Nothing is reached through a position that is not finite, or with a
/// `limit` that is not a number.
///
/// # Panics
/// When there is not one position per vertex, or a source is none of the mesh's vertices.
pub fn edge_distances(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    sources: impl IntoIterator<Item = VertexId>,
    limit: f64,
) -> PerVertex<f64> {
    let sources = sources.into_iter().map(|source| (source, 0.0));
    edge_distances_with_starts(mesh, positions, sources, limit)
}

/// Shortest distance (m) along edges where each of the `sources` begins with a distance of its own (m, at least 0), as
/// what lies on an edge is away from the ends of that; infinite beyond `limit`.
///
/// # Panics
/// As [`edge_distances`].
pub fn edge_distances_with_starts(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    sources: impl IntoIterator<Item = (VertexId, f64)>,
    limit: f64,
) -> PerVertex<f64> {
    assert_eq!(
        positions.len(),
        mesh.vertex_count(),
        "one position per vertex"
    );
    let mut distances = PerVertex::filled(mesh.vertex_count(), f64::INFINITY);
    let mut begun = Vec::new();
    for (source, start) in sources {
        // What is at no distance counts whatever the limit.
        if start < distances[source] && (start == 0.0 || start <= limit) {
            distances[source] = start;
            begun.push((Metres(start), source));
        }
    }
    // A source that is no nearer than any vertex around it leads nowhere nearer: of sources that cover a part of
    // the surface the rim is left.
    begun.retain(|(start, source)| {
        let faces = mesh.vertex_faces(*source).iter();
        let mut around = faces.flat_map(|&face| mesh.faces()[face]);
        around.any(|next| distances[next] > start.0)
    });
    let mut queue: BinaryHeap<_> = begun.into_iter().map(Reverse).collect();
    while let Some(Reverse((Metres(distance), vertex))) = queue.pop() {
        // A shorter way has been found since; the heap cannot lower an entry that it holds.
        if distance > distances[vertex] {
            continue;
        }
        // A mesh keeps the faces around a vertex, not the edges: that most neighbours come up twice
        // does no harm.
        for &face in mesh.vertex_faces(vertex) {
            for next in mesh.faces()[face] {
                let step = (positions[next.index()] - positions[vertex.index()]).norm();
                let reached = distance + step;
                // Both are false for NaN, so that nothing is reached through a place that is not
                // finite.
                if reached < distances[next] && reached <= limit {
                    distances[next] = reached;
                    queue.push(Reverse((Metres(reached), next)));
                }
            }
        }
    }
    distances
}

#[derive(PartialEq)]
struct Metres(f64);

impl Eq for Metres {}

impl PartialOrd for Metres {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Metres {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
