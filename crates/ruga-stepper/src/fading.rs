//! Shares that rise smoothly from some vertices of a mesh on.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector3;
use ruga_mesh::{PerVertex, TriMesh};

/// 0 at the vertices that are `held`, 1 at `reach` (m, more than 0) from them and beyond, without a
/// kink at either end; the distance is measured along edges.
pub(crate) fn faded_from(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    held: &[bool],
    reach: f64,
) -> Vec<f64> {
    let share = |distance: f64| {
        let t = distance / reach;
        t * t * (3.0 - 2.0 * t)
    };
    distances(mesh, positions, held, reach)
        .into_iter()
        .map(share)
        .collect()
}

/// Distance of every vertex from the `held` ones along edges, m, as far as `reach`.
fn distances(mesh: &TriMesh, positions: &[Vector3<f64>], held: &[bool], reach: f64) -> Vec<f64> {
    let mut neighbours: PerVertex<Vec<u32>> = PerVertex::filled(held.len(), Vec::new());
    for edge in mesh.edges().as_slice() {
        let [a, b] = edge.vertices;
        neighbours[a].push(b.0);
        neighbours[b].push(a.0);
    }
    let neighbours = neighbours.as_slice();
    let mut distances: Vec<f64> = held.iter().map(|h| if *h { 0.0 } else { reach }).collect();
    let mut front: BinaryHeap<Reached> = (0..)
        .zip(held)
        .filter(|(_, held)| **held)
        .map(|(vertex, _)| Reached(0.0, vertex))
        .collect();
    while let Some(Reached(distance, vertex)) = front.pop() {
        let from = positions[vertex as usize];
        if distance > distances[vertex as usize] {
            continue;
        }
        for &next in &neighbours[vertex as usize] {
            let there = distance + (positions[next as usize] - from).norm();
            if there < distances[next as usize] {
                distances[next as usize] = there;
                front.push(Reached(there, next));
            }
        }
    }
    distances
}

/// A vertex and its distance; the nearest is the greatest.
#[derive(PartialEq)]
struct Reached(f64, u32);

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
