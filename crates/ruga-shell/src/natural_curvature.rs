//! The angles that a natural curvature of the faces asks of the edges between them.

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_mesh::{FaceId, Id};

use crate::{HingeShape, RestTriangle};

/// Largest natural angle over one edge (rad).
///
/// Up to it a strip of such edges bends by half a per cent less than the circle that it stands for. Beyond,
/// a sheet that rolls up has fewer than eighteen edges to a turn, and angles far from what an edge can take.
pub const MAX_NATURAL_ANGLE: f64 = 0.35;

/// Natural angles of edges, and on how many faces they stopped short.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NaturalAngles {
    /// Crest-positive angle of each edge (rad).
    pub(crate) angles: Vec<f64>,
    /// Number of faces whose natural curvature is scaled down.
    pub(crate) capped_faces: usize,
}

impl NaturalAngles {
    /// Angles of the edges with these `sides` for a `curvature` (1/m, crest-positive) per face, in the frame
    /// of its rest triangle.
    ///
    /// Each is that of the piecewise linear surface through a quadratic one over the two faces, unfolded,
    /// with the mean of their tensors `k` and `q = p^T k p/2`:
    ///
    /// ```text
    /// angle = sum over both apexes (q(apex) - (1 - f) q(tail) - f q(head))/height         f: foot
    /// ```
    ///
    /// A star that is folded so has `P k` in the words of [`crate::StarShape`], as on a surface of that
    /// curvature. A face whose own tensor asks for more than [`MAX_NATURAL_ANGLE`] at one of its edges has
    /// it scaled down as a whole, because cut angles alone would turn its directions.
    pub(crate) fn new(
        sides: impl Iterator<Item = [(FaceId, usize); 2]> + Clone,
        rest: &[RestTriangle],
        curvatures: &[Matrix2<f64>],
    ) -> Self {
        let mut largest = vec![0.0_f64; rest.len()];
        // What the tensor of either face alone would make of the edge: the angle is linear in it.
        let own: Vec<_> = sides
            .clone()
            .map(|sides| {
                let fold = HingeShape::between(sides, rest).quadratic_fold();
                sides.map(|(face, corner)| {
                    let frame = rest[face.index()].edge_frame(corner);
                    let curvature = frame.transpose() * curvatures[face.index()] * frame;
                    let angle = fold.dot(&components(&curvature));
                    largest[face.index()] = largest[face.index()].max(angle.abs());
                    angle
                })
            })
            .collect();
        let scale = |face: FaceId| (MAX_NATURAL_ANGLE / largest[face.index()]).min(1.0);
        let angles = sides
            .zip(&own)
            .map(|([left, right], own)| 0.5 * (scale(left.0) * own[0] + scale(right.0) * own[1]));
        Self {
            angles: angles.collect(),
            capped_faces: largest
                .iter()
                .filter(|angle| **angle > MAX_NATURAL_ANGLE)
                .count(),
        }
    }
}

/// Components of a symmetric tensor, see [`crate::StarShape`].
fn components(tensor: &Matrix2<f64>) -> Vector3<f64> {
    let [xx, yy] = [tensor.m11, tensor.m22];
    let doubled = Vector3::new(xx + yy, xx - yy, tensor.m12 + tensor.m21);
    doubled * std::f64::consts::FRAC_1_SQRT_2
}

/// What the face with this `apex` adds to the angle at an edge (rad m): of piecewise linear surfaces through
/// quadratic ones, one per unit component of curvature.
///
/// The edge runs from the origin along `spoke`, and `height` is the distance of the apex from it.
pub(crate) fn side_fold(spoke: &Vector2<f64>, apex: &Vector2<f64>, height: f64) -> Vector3<f64> {
    // Depths of the three unit curvatures, crests positive.
    let depths = |p: &Vector2<f64>| {
        Vector3::new(p.norm_squared(), p.x * p.x - p.y * p.y, 2.0 * p.x * p.y)
            * (0.5 * std::f64::consts::FRAC_1_SQRT_2)
    };
    let length = spoke.norm();
    let foot = spoke.dot(apex) / (length * length);
    // The tail stays at depth zero: under the apex's foot the edge is at that share of its head's depth.
    (depths(apex) - depths(spoke) * foot) / height
}
