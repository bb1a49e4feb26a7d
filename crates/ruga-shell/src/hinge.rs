//! Bending energy of one interior edge.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};

/// `W = k/2 (theta - theta_rest)^2` on the two triangles at an edge.
///
/// ```text
///        2            x: edge tail 0, edge head 1, left apex 2, right apex 3.
///       / \           theta: angle from the left normal to the right one about the edge;
///      0-->1          zero when flat, positive when the edge is a crest (seen from the
///       \ /           side that the normals point to), in (-pi, pi].
///        3
/// ```
///
/// # Shapes and units
/// Value J, gradient N, Hessian N/m as the 3×3 blocks of the lower triangle, row by row:
/// (0,0) (1,0) (1,1) (2,0) ... (3,3).
///
/// # Validity
/// `theta` jumps where the hinge is folded shut, and the slope of the energy where it is half a turn from
/// rest. A triangle that has collapsed to a line has no angle: it then contributes a value but no
/// derivative, and never a NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge {
    /// `k` (J).
    pub stiffness: f64,
    /// `theta_rest` (rad).
    pub rest_angle: f64,
}

/// One triangle of a hinge in the frame of its edge.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// Unit, in the triangle, from the edge to the apex.
    outward: Vector3<f64>,
    /// `edge direction x outward`.
    normal: Vector3<f64>,
    /// Fraction of the edge under the apex.
    foot: f64,
    /// 1 / distance of the apex from the edge; 0 when it lies on the edge.
    inverse_height: f64,
    /// Derivative of theta by the apex.
    gradient: Vector3<f64>,
}

/// Geometry that value, gradient and Hessian of one hinge share.
#[derive(Clone, Copy, Debug)]
pub struct HingeState {
    angle: f64,
    direction: Vector3<f64>,
    inverse_length: f64,
    sides: [Side; 2],
}

/// The direction in which theta grows when an apex turns about the edge, left and right.
const TURN: [f64; 2] = [-1.0, 1.0];

impl HingeState {
    /// Angle and frame of the hinge at `x`.
    #[inline]
    pub fn new(x: &[Vector3<f64>; 4]) -> Self {
        let edge = x[1] - x[0];
        let inverse_length = reciprocal(edge.norm());
        let direction = edge * inverse_length;
        let side = |apex: Vector3<f64>, turn: f64| {
            let arm = apex - x[0];
            let along = arm.dot(&direction);
            let across = arm - along * direction;
            let inverse_height = reciprocal(across.norm());
            let outward = across * inverse_height;
            let normal = direction.cross(&outward);
            Side {
                outward,
                normal,
                foot: along * inverse_length,
                inverse_height,
                gradient: normal * (turn * inverse_height),
            }
        };
        let sides = [side(x[2], TURN[0]), side(x[3], TURN[1])];
        // The right triangle's normal is minus its side's, which is measured towards its apex.
        let (left, right) = (sides[0].normal, -sides[1].normal);
        // The arc cosine of the normals' product would lose half of the digits near flat, where
        // wrinkles begin, and the side on which the hinge is folded.
        let angle = left.cross(&right).dot(&direction).atan2(left.dot(&right));
        Self {
            angle,
            direction,
            inverse_length,
            sides,
        }
    }

    /// Dihedral angle (rad).
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Derivative of the angle by the four points (rad/m).
    #[inline]
    pub fn angle_gradient(&self) -> [Vector3<f64>; 4] {
        let [left, right] = &self.sides;
        let (at_2, at_3) = (left.gradient, right.gradient);
        // A rigid motion changes no angle: the moments about the tail give the head's row, and the
        // sum of all rows the tail's.
        let at_1 = -(left.foot * at_2 + right.foot * at_3);
        [-(at_1 + at_2 + at_3), at_1, at_2, at_3]
    }

    /// Adds `moment` (J) times `d2theta` to blocks in the order of [`Hinge::hessian`].
    ///
    /// Per side, with unit vectors e (edge), m (outward), n = e x m, edge length l, foot t and
    /// height h, the angle by which the apex turns about the edge has the second derivatives
    ///
    /// ```text
    /// apex, apex   -P/h^2                                P = n m^T + m n^T
    /// apex, head    t P/h^2 - e n^T/(l h)
    /// head, head   -(t^2/h^2 + 1/(2 l^2)) P + t (e n^T + n e^T)/(l h)
    /// ```
    ///
    /// and the tail's rows make the sums vanish. The (l^-2) term is symmetric only summed over the
    /// two sides, whose antisymmetric parts cancel; here each keeps its symmetric part.
    #[inline]
    pub fn add_curvature(&self, moment: f64, blocks: &mut [Matrix3<f64>; 10]) {
        let half_inverse_square = 0.5 * self.inverse_length * self.inverse_length;
        // Positions in the list of the blocks (apex, tail), (apex, head), (apex, apex).
        for ((side, turn), [tail, head, apex]) in
            self.sides.iter().zip(TURN).zip([[3, 4, 5], [6, 7, 9]])
        {
            let weight = moment * turn;
            let outer = side.normal * side.outward.transpose();
            let bend = (outer + outer.transpose()) * weight;
            let twist = self.direction
                * (side.normal * (weight * self.inverse_length * side.inverse_height)).transpose();
            let inverse_square = side.inverse_height * side.inverse_height;
            let (t, s) = (side.foot, 1.0 - side.foot);
            let twist_both = twist + twist.transpose();
            blocks[apex] -= bend * inverse_square;
            blocks[head] += bend * (t * inverse_square) - twist;
            blocks[tail] += bend * (s * inverse_square) + twist;
            blocks[0] -= bend * (s * s * inverse_square + half_inverse_square) + twist_both * s;
            blocks[1] += bend * (half_inverse_square - s * t * inverse_square)
                + twist.transpose() * s
                - twist * t;
            blocks[2] += twist_both * t - bend * (t * t * inverse_square + half_inverse_square);
        }
    }
}

impl Hinge {
    /// Energy (J).
    pub fn value(&self, x: &[Vector3<f64>; 4]) -> f64 {
        self.energy(&HingeState::new(x))
    }

    /// Energy (J) in a state.
    #[inline]
    pub fn energy(&self, state: &HingeState) -> f64 {
        let bend = self.bend(state);
        0.5 * self.stiffness * bend * bend
    }

    /// Angle from rest (rad), in [-pi, pi]: an edge that is drawn almost shut may close and come out on the
    /// other side, where `theta` jumps and this does not.
    #[inline]
    pub fn bend(&self, state: &HingeState) -> f64 {
        let bend = state.angle - self.rest_angle;
        match bend.abs() > PI {
            true => bend - TAU.copysign(bend),
            false => bend,
        }
    }

    /// Derivative of the energy by the four points (N).
    #[inline]
    pub fn gradient(&self, x: &[Vector3<f64>; 4]) -> [Vector3<f64>; 4] {
        let state = HingeState::new(x);
        let moment = self.stiffness * self.bend(&state);
        state.angle_gradient().map(|g| g * moment)
    }

    /// Second derivative of the energy (N/m): `k (g g^T + (theta - theta_rest) d2theta)`.
    pub fn hessian(&self, x: &[Vector3<f64>; 4]) -> [Matrix3<f64>; 10] {
        let state = HingeState::new(x);
        let mut blocks = self.gauss_newton(&state);
        self.add_curvature(&state, &mut blocks);
        blocks
    }

    /// `k g g^T`: positive semidefinite.
    #[inline]
    pub fn gauss_newton(&self, state: &HingeState) -> [Matrix3<f64>; 10] {
        // The square of one row: semidefinite at any bend, without an eigenproblem per hinge.
        let g = state.angle_gradient();
        let block = |i: usize, j: usize| (g[i] * self.stiffness) * g[j].transpose();
        [
            block(0, 0),
            block(1, 0),
            block(1, 1),
            block(2, 0),
            block(2, 1),
            block(2, 2),
            block(3, 0),
            block(3, 1),
            block(3, 2),
            block(3, 3),
        ]
    }

    /// Adds `k (theta - theta_rest) d2theta` to blocks in the order of [`Self::hessian`].
    #[inline]
    pub fn add_curvature(&self, state: &HingeState, blocks: &mut [Matrix3<f64>; 10]) {
        state.add_curvature(self.stiffness * self.bend(state), blocks);
    }
}

#[inline]
fn reciprocal(length: f64) -> f64 {
    // A collapsed hinge has no direction; zero keeps every derivative finite.
    // The bound is a root because second derivatives square the reciprocal.
    if length > f64::MIN_POSITIVE.sqrt() {
        1.0 / length
    } else {
        0.0
    }
}
