//! Moves new vertices along the surface towards round triangles.

use nalgebra::Vector3;

use crate::counts::Counts;
use crate::flip::flip_around;
use crate::patch::Patch;
use crate::sizing::{metric_area, metric_length};
use crate::touched::Touched;

/// Step of a vertex over the distance to the centroid of its faces.
///
/// Bisection leaves grids of right triangles, in which the centroid is an unstable rest: 1.5 leaves
/// it in four sweeps where 1 takes twelve; at 2 shapes get worse again.
const OVERSHOOT: f64 = 1.5;

/// Shape (1 equilateral, 0 degenerate) down to which the worst face at a vertex may fall when it
/// moves. Moves that had to improve the worst face would leave those grids as they are, and with
/// them a plate modulus that depends on direction: spread 15 % instead of 11 % between directions,
/// mean 7 % instead of 3 % high, interpolated, with the per-hinge factor of the notes.
const GOOD_SHAPE: f64 = 0.7;

/// Metric length under which a step is not worth asking the surface for a place.
const LEAST_STEP: f64 = 0.02;

/// Moves each new interior vertex past the centroid of its faces, weighted by metric area (Chen
/// 2004), where that leaves its faces in good shape; then flips around what moved.
///
/// Old vertices stay, unless a collapse has set them free: what a vertex carries is carried
/// exactly wherever the mesh is fine enough already, and on a mesh without new vertices nothing
/// happens.
pub(crate) fn relax_new_vertices(patch: &mut Patch, counts: &mut Counts) {
    let mut touched = Touched::new();
    // One after the other, each seeing the moves before it: two neighbours that moved at once could
    // turn a face over that neither alone would.
    for v in 0..patch.topology.vertex_slots() as u32 {
        if is_movable(patch, v) && move_to_centroid(patch, v) {
            counts.moves += 1;
            touched.add_around(&patch.topology, v);
        }
    }
    let edges = touched.edges(&patch.topology);
    flip_around(patch, edges, &mut touched, counts);
}

/// Says whether a vertex exists, is new and lies on no feature.
fn is_movable(patch: &Patch, v: u32) -> bool {
    patch.is_new(v) && patch.topology.is_alive_vertex(v) && patch.is_free(v)
}

fn move_to_centroid(patch: &mut Patch, v: u32) -> bool {
    let faces: Vec<[u32; 3]> = patch
        .topology
        .outgoing(v)
        .map(|h| patch.corners(h))
        .collect();
    let Some(centroid) = centroid(patch, &faces) else {
        return false;
    };
    let here = patch.position(v);
    let step = (centroid - here) * OVERSHOOT;
    if metric_length(&step, &patch.tensor(v)) < LEAST_STEP {
        return false;
    }
    let (shape, upright) = worst(patch, &faces);
    patch.try_move(v, here + step, |moved| {
        let after = worst(moved, &faces);
        after.0 > shape.min(GOOD_SHAPE)
            && Patch::stays_upright(upright, after.1)
            // Spokes stay short enough, or the next split would cut what was just moved.
            && faces
                .iter()
                .all(|&[v, neighbour, _]| moved.may_join(v, neighbour))
    })
}

/// Centroid of some faces weighted by metric area; `None` where they have none.
fn centroid(patch: &Patch, faces: &[[u32; 3]]) -> Option<Vector3<f64>> {
    let (mut sum, mut area) = (Vector3::zeros(), 0.0);
    for face in faces {
        let [p, q, r] = face.map(|v| patch.position(v));
        let [l, m, n] = face.map(|v| patch.tensor(v));
        let weight = metric_area(&[q - p, r - q, p - r], &((l + m + n) * (1.0 / 3.0)));
        sum += (p + q + r) * (weight / 3.0);
        area += weight;
    }
    (area > 0.0).then(|| sum / area)
}

/// Worst shape and uprightness of some faces.
fn worst(patch: &Patch, faces: &[[u32; 3]]) -> (f64, f64) {
    faces.iter().fold((1.0, 1.0), |(shape, upright), &face| {
        (
            patch.quality(face).min(shape),
            patch.uprightness(face).min(upright),
        )
    })
}
