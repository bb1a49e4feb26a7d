//! Flips edges until the mesh is Delaunay in the metric.

use std::collections::VecDeque;

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::counts::Counts;
use crate::half_edges::{next, prev};
use crate::patch::Patch;
use crate::tensor2::Tensor2;
use crate::touched::Touched;

/// Sine by which the angles opposite an edge must exceed 180 degrees together before it is
/// flipped; regular grids, where it is zero, are left as they are.
const TOLERANCE: f64 = 1e-3;
/// Sine for flips among four vertices of the old mesh: 3 degrees of hysteresis against churn.
const TOLERANCE_OLD: f64 = 0.05;
/// Flips per edge asked about after which flipping stops: in a metric that varies, Lawson's
/// algorithm may go round in circles. Two are seldom reached.
const MAX_FLIPS_PER_EDGE: usize = 8;
/// Number of edges from which on all are measured before the first is flipped.
const MANY: usize = 1 << 12;
/// Edges that a thread measures at least.
const AT_ONCE: usize = 1 << 10;

/// Flips the given edges and those around them where the metric asks for it; lists the faces it
/// changes in `touched`. Returns how many edges were left when the bound on flips was reached.
pub(crate) fn flip_around(
    patch: &mut Patch,
    edges: Vec<u32>,
    touched: &mut Touched,
    counts: &mut Counts,
) -> usize {
    let mut left = MAX_FLIPS_PER_EDGE * edges.len();
    let mut changed = Touched::new();
    let mut queue = VecDeque::from(measured(patch, edges));
    while let Some((h, known)) = queue.pop_front() {
        let Some(twin) = patch.topology.twin(h) else {
            continue;
        };
        let faces = [h, twin].map(|side| side / 3);
        let known = known.filter(|_| !faces.iter().any(|&face| changed.contains(face)));
        debug_assert!(known.is_none_or(|wrong| wrong == is_wrong(patch, h)));
        if !known.unwrap_or_else(|| is_wrong(patch, h)) || !has_place(patch, [h, twin]) {
            continue;
        }
        if left == 0 {
            return queue.len() + 1;
        }
        left -= 1;
        patch.topology.flip(h);
        counts.flips += 1;
        touched.extend(faces);
        changed.extend(faces);
        for side in [h, twin] {
            // A flip can spoil the four edges around it, and no others.
            queue.extend([next(side), prev(side)].map(|beside| (beside, None)));
        }
    }
    0
}

/// The edges, each with whether it is wrong, which holds until one of its two faces changes; `None` for fewer edges
/// than [`MANY`].
fn measured(patch: &Patch, edges: Vec<u32>) -> Vec<(u32, Option<bool>)> {
    let are_many = edges.len() >= MANY;
    let each = edges.into_par_iter().with_min_len(AT_ONCE);
    each.map(|h| (h, are_many.then(|| is_wrong(patch, h))))
        .collect()
}

/// Says whether the diagonal that a flip makes is no edge elsewhere.
fn has_place(patch: &Patch, sides: [u32; 2]) -> bool {
    let [c, d] = sides.map(|side| patch.topology.apex(side));
    !patch.topology.are_joined(c, d)
}

/// Says whether an edge should be flipped, by its two faces alone; see [`has_place`].
fn is_wrong(patch: &Patch, h: u32) -> bool {
    let topology = &patch.topology;
    let Some(twin) = topology.twin(h).filter(|_| !topology.is_feature(h)) else {
        return false;
    };
    let [a, b, c] = patch.corners(h);
    let d = topology.apex(twin);
    let is_old = [a, b, c, d].iter().all(|&v| !patch.is_new(v));
    let tolerance = if is_old { TOLERANCE_OLD } else { TOLERANCE };
    let sine = delaunay_sine(patch, [a, b, c, d]);
    // Faces at an angle unfold differently about the two diagonals, and each of these may seem
    // the wrong one: such an edge would be flipped to and fro for ever.
    if sine >= -tolerance || delaunay_sine(patch, [d, c, a, b]) <= sine {
        return false;
    }
    // The diagonal may be long only where it replaces a longer one: this keeps what splitting
    // has reached, so that splitting and flipping cannot chase each other.
    let keeps_length = patch.may_join(c, d) || patch.length(c, d) <= patch.length(a, b);
    let before = patch
        .uprightness([a, b, c])
        .min(patch.uprightness([b, a, d]));
    let after = patch
        .uprightness([d, c, a])
        .min(patch.uprightness([c, d, b]));
    keeps_length && Patch::stays_upright(before, after)
}

/// Sine of the sum of the two angles opposite edge `ab`, measured in the mean metric of the four
/// vertices after unfolding the faces `abc` and `bad` into a plane. Negative: not Delaunay.
///
/// With `u × v` and `u·Mv` at each apex it is Narain et al. (2012), section 4.2, normalised.
fn delaunay_sine(patch: &Patch, quad: [u32; 4]) -> f64 {
    let [a, b, c, d] = quad.map(|v| patch.position(v));
    let length = (b - a).norm();
    if length == 0.0 {
        return 0.0;
    }
    let x = (b - a) / length;
    let unfold = |apex: Vector3<f64>| {
        let along = (apex - a).dot(&x);
        let up = (apex - a) - x * along;
        let height = up.norm();
        (along, height, up / height.max(f64::MIN_POSITIVE))
    };
    let ((cx, cy, up), (dx, dy, down)) = (unfold(c), unfold(d));
    // The sum will do for the mean: a sine does not depend on the metric's scale.
    let sum = quad.iter().map(|&v| patch.tensor(v)).reduce(|l, r| l + r);
    let metric = sum.map_or(
        Tensor2 {
            xx: 1.0,
            xy: 0.0,
            yy: 1.0,
        },
        |sum| {
            // Each face has its own plane, unfolded about the edge. `down` leads to `d`, so it is
            // turned around to give both planes the same axes.
            let (above, below) = (Tensor2::of(&sum, &[x, up]), Tensor2::of(&sum, &[x, -down]));
            Tensor2 {
                xx: above.xx,
                xy: (above.xy + below.xy) / 2.0,
                yy: (above.yy + below.yy) / 2.0,
            }
        },
    );
    let (cross_c, dot_c, scale_c) = angle(metric, [-cx, -cy], [length - cx, -cy]);
    let (cross_d, dot_d, scale_d) = angle(metric, [length - dx, dy], [-dx, dy]);
    (cross_c * dot_d + cross_d * dot_c) / (scale_c * scale_d).max(f64::MIN_POSITIVE)
}

/// Sine and cosine of the angle from `u` to `v` in a metric, both times the lengths, and these.
fn angle(m: Tensor2, u: [f64; 2], v: [f64; 2]) -> (f64, f64, f64) {
    let dot = |p: [f64; 2], q: [f64; 2]| {
        m.xx * p[0] * q[0] + m.xy * (p[0] * q[1] + p[1] * q[0]) + m.yy * p[1] * q[1]
    };
    // Areas go with the root of the metric's determinant.
    let cross = (u[0] * v[1] - u[1] * v[0]) * m.determinant().max(0.0).sqrt();
    (cross, dot(u, v), (dot(u, u) * dot(v, v)).max(0.0).sqrt())
}
