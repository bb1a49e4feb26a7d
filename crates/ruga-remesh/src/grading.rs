//! Limits how fast the wanted edge length changes over the surface.

use std::collections::VecDeque;

use nalgebra::Vector3;
use ruga_mesh::Id;

use crate::SurfaceMesh;
use crate::tensor2::Tensor2;

/// Updates per vertex after which grading stops; fields met in practice need two or three.
const MAX_UPDATES: usize = 40;

/// Growth faster than the rate by this factor is left alone, so that a field that was graded on
/// one mesh and carried to another is not graded again for rounding's sake.
const RATE_SLACK: f64 = 1.25;

/// Refines tensors until the wanted length grows by at most `rate` per metric length.
///
/// Vertex `i` lets its neighbour over edge `e` want at most `h_i (1 + rate l_i(e))`: the tensor
/// `M_i (1 + rate l_i)^-2`, in the neighbour's tangent plane, is a lower bound for `M_j`
/// (Borouchaki et al. 1998, gradation in the metric's own space). Finest vertices are taken
/// first, so most are visited once.
pub(crate) fn grade(
    mesh: &SurfaceMesh,
    frames: &[[Vector3<f64>; 2]],
    rate: f64,
    tensors: &mut [Tensor2],
) {
    if rate.is_infinite() {
        return;
    }
    let neighbours = neighbours(mesh);
    let mut order: Vec<u32> = (0..tensors.len() as u32).collect();
    let finest: Vec<f64> = tensors.iter().map(|t| t.eigenvalues()[0]).collect();
    order.sort_by(|&l, &r| finest[r as usize].total_cmp(&finest[l as usize]));
    let mut is_queued = vec![true; tensors.len()];
    let mut queue = VecDeque::from(order);
    let mut left = MAX_UPDATES * tensors.len();
    while let Some(v) = queue.pop_front() {
        is_queued[v as usize] = false;
        for &w in &neighbours.0[neighbours.1[v as usize]..neighbours.1[v as usize + 1]] {
            if left > 0 && refine_neighbour(mesh, frames, rate, tensors, [v, w]) {
                left -= 1;
                if !std::mem::replace(&mut is_queued[w as usize], true) {
                    queue.push_back(w);
                }
            }
        }
    }
}

/// Neighbours of all vertices in one list, and where each vertex's part starts.
fn neighbours(mesh: &SurfaceMesh) -> (Vec<u32>, Vec<usize>) {
    let mut starts = vec![0; mesh.mesh.vertex_count() + 1];
    for edge in mesh.mesh.edges().as_slice() {
        for v in edge.vertices {
            starts[v.index() + 1] += 1;
        }
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut cursor = starts.clone();
    let mut list = vec![0; starts[starts.len() - 1]];
    for edge in mesh.mesh.edges().as_slice() {
        let [a, b] = edge.vertices;
        for (v, w) in [(a, b), (b, a)] {
            list[cursor[v.index()]] = w.0;
            cursor[v.index()] += 1;
        }
    }
    (list, starts)
}

/// Refines the tensor of the second vertex where the first asks for it; says whether it did.
fn refine_neighbour(
    mesh: &SurfaceMesh,
    frames: &[[Vector3<f64>; 2]],
    rate: f64,
    tensors: &mut [Tensor2],
    [v, w]: [u32; 2],
) -> bool {
    let positions = mesh.positions.as_slice();
    // The chord, which is shorter than the way over the surface: grading errs on the fine side.
    let edge = positions[w as usize] - positions[v as usize];
    let (own, frame) = (tensors[v as usize], &frames[v as usize]);
    let (x, y) = (frame[0].dot(&edge), frame[1].dot(&edge));
    let length = (own.xx * x * x + 2.0 * own.xy * x * y + own.yy * y * y)
        .max(0.0)
        .sqrt();
    let own = in_other_frame(own, frame, &frames[w as usize]);
    // Lengths go with the inverse root of a tensor, hence the square.
    let bound = |rate: f64| own.scaled((1.0 + rate * length).powi(-2));
    let other = tensors[w as usize];
    // In the order of tensors, by all directions at once: an anisotropic neighbour may be fine
    // enough across wrinkles and too coarse along them.
    if other.minus(bound(RATE_SLACK * rate)).is_nonnegative() {
        return false;
    }
    tensors[w as usize] = other.finest(bound(rate));
    true
}

/// The tensor seen in a neighbour's tangent plane.
fn in_other_frame(tensor: Tensor2, from: &[Vector3<f64>; 2], to: &[Vector3<f64>; 2]) -> Tensor2 {
    // Projected, not turned: over one edge normals differ little, and the loss is of second order.
    let part = |direction: &Vector3<f64>| (from[0].dot(direction), from[1].dot(direction));
    let ((a, b), (c, d)) = (part(&to[0]), part(&to[1]));
    Tensor2 {
        xx: tensor.xx * a * a + 2.0 * tensor.xy * a * b + tensor.yy * b * b,
        xy: tensor.xx * a * c + tensor.xy * (a * d + b * c) + tensor.yy * b * d,
        yy: tensor.xx * c * c + 2.0 * tensor.xy * c * d + tensor.yy * d * d,
    }
}
