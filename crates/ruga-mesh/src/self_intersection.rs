//! Pairs of faces that pass through each other.

use crate::{FaceId, Id, TriMesh, VertexId};
use nalgebra::Vector3;

/// Every pair of faces that cross or overlap, lower id first, in ascending order.
///
/// Two faces cross when an edge of one passes through the inside of the other; faces in one plane
/// when they overlap there. Signs of volumes within rounding, 1e-13 of the product of their edges, count as zero. So
/// faces that merely touch, at a corner or along an edge, are no pair, nor are faces that come nearer to each other
/// than rounding. Faces with a common vertex are a pair where they pass through each other away from it, and those with
/// a common edge where they lie on each other.
pub fn intersecting_pairs(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<[FaceId; 2]> {
    let mut boxes: Vec<FaceBox> = (mesh.faces().ids())
        .map(|face| FaceBox::new(mesh, positions, face))
        .collect();
    // Sweep along the longest side of all: a box meets only those that begin before it ends.
    let along = longest_axis(&boxes);
    boxes.sort_by(|a, b| {
        let starts = a.low[along].total_cmp(&b.low[along]);
        starts.then(a.face.cmp(&b.face))
    });
    let mut pairs = Vec::new();
    for (i, first) in boxes.iter().enumerate() {
        let reached = boxes[i + 1..]
            .iter()
            .take_while(|b| b.low[along] <= first.high[along]);
        for second in reached.filter(|b| first.meets(b)) {
            let faces = [first.face.min(second.face), first.face.max(second.face)];
            if intersect(mesh, positions, faces) {
                pairs.push(faces);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

/// Axis along which the boxes together are longest.
fn longest_axis(boxes: &[FaceBox]) -> usize {
    let Some(first) = boxes.first() else { return 0 };
    let ends = (first.low, first.high);
    let join = |(low, high): (Vector3<f64>, _), b: &FaceBox| (low.inf(&b.low), b.high.sup(&high));
    let (low, high) = boxes.iter().fold(ends, join);
    (high - low).imax()
}

/// Volume of a tetrahedron, as a share of its longest edges' product, that counts as none.
const FLAT: f64 = 1e-13;

struct FaceBox {
    face: FaceId,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl FaceBox {
    fn new(mesh: &TriMesh, positions: &[Vector3<f64>], face: FaceId) -> Self {
        let [a, b, c] = mesh.faces()[face].map(|v| positions[v.index()]);
        Self {
            face,
            low: a.inf(&b).inf(&c),
            high: a.sup(&b).sup(&c),
        }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}

fn intersect(mesh: &TriMesh, positions: &[Vector3<f64>], faces: [FaceId; 2]) -> bool {
    let [first, second] = faces.map(|f| mesh.faces()[f]);
    let corners = |face: [VertexId; 3]| face.map(|v| positions[v.index()]);
    let shared = first.iter().filter(|&v| second.contains(v)).count();
    let one_way = |from: [VertexId; 3], through: [VertexId; 3]| {
        (0..3).any(|i| {
            let ends = [from[i], from[(i + 1) % 3]];
            // An edge that begins at the other face touches it there anyway.
            !ends.iter().any(|v| through.contains(v))
                && pierces(ends.map(|v| positions[v.index()]), corners(through))
        })
    };
    match shared {
        0 | 1 => {
            one_way(first, second)
                || one_way(second, first)
                || overlap_in_plane(corners(first), corners(second))
        }
        // Two triangles at a common edge meet elsewhere only if they lie on each other.
        _ => folded_flat(first, second, positions),
    }
}

/// Six times the volume of a tetrahedron; zero when it is flat up to rounding.
fn volume(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, d: &Vector3<f64>) -> f64 {
    let [u, v, w] = [b - a, c - a, d - a];
    // Compared with lengths, so that it does not depend on the unit or the size of the faces.
    let value = u.dot(&v.cross(&w));
    if value.abs() <= FLAT * u.norm() * v.norm() * w.norm() {
        0.0
    } else {
        value
    }
}

/// Whether a segment passes through the inside of a triangle, or of one of its edges.
fn pierces([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
    if volume(&p, &a, &b, &c) * volume(&q, &a, &b, &c) >= 0.0 {
        return false;
    }
    let turns = [
        volume(&p, &q, &a, &b),
        volume(&p, &q, &b, &c),
        volume(&p, &q, &c, &a),
    ];
    // A segment through an edge has one zero and counts, or two faces that meet there would both
    // let it pass. Through a corner it has two, and merely touches.
    let touched = turns.iter().filter(|&&t| t == 0.0).count();
    touched < 2 && (turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0))
}

/// Whether two triangles of one plane, with one common vertex or none, overlap.
fn overlap_in_plane(first: [Vector3<f64>; 3], second: [Vector3<f64>; 3]) -> bool {
    let [a, b, c] = &first;
    if second.iter().any(|p| volume(p, a, b, c) != 0.0) {
        return false;
    }
    let normal = (b - a).cross(&(c - a));
    // No edge of either separates them.
    let separates = |of: &[Vector3<f64>; 3], other: &[Vector3<f64>; 3]| {
        let third = |i: usize| of[(i + 2) % 3];
        (0..3).any(|i| {
            let across = normal.cross(&(of[(i + 1) % 3] - of[i]));
            let side = across.dot(&(third(i) - of[i]));
            // Faces with a common vertex or edge line reach each other by rounding.
            let reach = 1e-12 * side.abs();
            (other.iter()).all(|p| across.dot(&(p - of[i])) * side.signum() <= reach)
        })
    };
    !separates(&first, &second) && !separates(&second, &first)
}

/// Whether two faces at a common edge lie on each other.
fn folded_flat(first: [VertexId; 3], second: [VertexId; 3], positions: &[Vector3<f64>]) -> bool {
    let apex =
        |of: [VertexId; 3], other: [VertexId; 3]| of.into_iter().find(|v| !other.contains(v));
    let (Some(left), Some(right)) = (apex(first, second), apex(second, first)) else {
        // All three vertices in common: one face lies on the other.
        return true;
    };
    let mut ends = first.into_iter().filter(|&v| v != left);
    let (Some(tail), Some(head)) = (ends.next(), ends.next()) else {
        return true;
    };
    let [tail, head, left, right] = [tail, head, left, right].map(|v| positions[v.index()]);
    let normal = |apex: &Vector3<f64>| (head - tail).cross(&(apex - tail));
    volume(&tail, &head, &left, &right) == 0.0 && normal(&left).dot(&normal(&right)) > 0.0
}
