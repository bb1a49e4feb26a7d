//! Moves new vertices along the surface towards round triangles.

use nalgebra::Vector3;

use crate::flip::flip_around;
use crate::patch::{Patch, Touched};
use crate::remesh::Counts;
use crate::sizing::metric_area;

/// Moves each new interior vertex to the centroid of its faces, weighted by metric area (Chen
/// 2004), where that does not make its worst face worse; then flips around what moved.
///
/// Old vertices stay, unless a collapse has set them free: what a vertex carries is carried
/// exactly wherever the mesh is fine enough already, and on a mesh without new vertices nothing
/// happens.
pub(crate) fn relax_new_vertices(patch: &mut Patch, counts: &mut Counts) {
    let mut touched = Touched::new();
    for v in 0..patch.topology.vertex_slots() as u32 {
        if is_free(patch, v) && move_to_centroid(patch, v) {
            counts.moves += 1;
            touched.add_around(&patch.topology, v);
        }
    }
    let edges = touched.edges(&patch.topology);
    flip_around(patch, edges, &mut touched, counts);
}

/// Whether a vertex exists, is new and lies on no feature.
fn is_free(patch: &Patch, v: u32) -> bool {
    patch.is_new(v)
        && patch.topology.is_alive_vertex(v)
        && patch.topology.neighbours(v).all(|(_, feature)| !feature)
}

fn move_to_centroid(patch: &mut Patch, v: u32) -> bool {
    let faces: Vec<[u32; 3]> = patch
        .topology
        .outgoing(v)
        .map(|h| patch.corners(h))
        .collect();
    let (mut sum, mut area) = (Vector3::zeros(), 0.0);
    for face in &faces {
        let [p, q, r] = face.map(|v| patch.positions[v as usize]);
        let mean = face
            .iter()
            .map(|&v| patch.tensors[v as usize])
            .reduce(|l, r| l + r);
        let weight = mean.map_or(0.0, |mean| metric_area(&[q - p, r - q, p - r], &mean));
        sum += (p + q + r) * (weight / 3.0);
        area += weight;
    }
    if area <= 0.0 {
        return false;
    }
    let worst = |patch: &Patch| faces.iter().map(|&f| patch.quality(f)).fold(1.0, f64::min);
    let upright = |patch: &Patch| {
        faces
            .iter()
            .map(|&f| patch.uprightness(f))
            .fold(1.0, f64::min)
    };
    let before = (worst(patch), upright(patch));
    patch.try_move(v, sum / area, |moved| {
        worst(moved) > before.0
            && Patch::stays_upright(before.1, upright(moved))
            && faces
                .iter()
                .all(|&[v, neighbour, _]| moved.may_join(v, neighbour))
    })
}
