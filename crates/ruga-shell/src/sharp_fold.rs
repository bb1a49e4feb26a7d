//! The resistance of an edge to being folded shut.

use std::f64::consts::PI;

/// Angle (rad) from which on an edge resists; wrinkles bend at no edge by half as much.
const SHARP: f64 = 2.0;

/// Part of the way from where an edge resists to where it is shut that is left in the denominator of the
/// energy: finite, because a driver may fold edges whose vertices a layer cannot move.
const LEFT: f64 = 0.01;

/// An edge that lies so much (rad) from shut in the driver's shape, or less, is as the artist wants it.
const SHUT: f64 = 0.2;

/// State of an edge folded by more than `theta_0`, in either sense:
/// `W = k u^3/(1.01 - u)`, `u = (|theta| - theta_0)/(pi - theta_0)`, with the stiffness `k` (J) of the plain
/// hinge.
///
/// A sheet has a thickness, and its two sides meet before a fold is shut. An angle that goes beyond
/// comes out on the other side, where the bending energy is another by as much as all of it: a solve would stop
/// at this step, which is no minimum and has no derivative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharpFold {
    /// `W` (J).
    pub(crate) value: f64,
    /// First derivative of `W` by `theta` (J).
    pub(crate) slope: f64,
    /// Second derivative of `W` by `theta` (J).
    pub(crate) curvature: f64,
}

impl SharpFold {
    /// The state at an `angle` (rad) of an edge that is at rest at `rest_angle`; `None` where it is not
    /// sharp.
    #[inline]
    pub(crate) fn new(angle: f64, rest_angle: f64, stiffness: f64) -> Option<Self> {
        if angle.abs() <= SHARP {
            return None;
        }
        // What is drawn sharp is not to be opened, only kept from closing.
        let start = SHARP.max(0.5 * (PI + rest_angle.abs()));
        let way = PI - start;
        if angle.abs() <= start || 2.0 * way < SHUT {
            return None;
        }
        let u = (angle.abs() - start) / way;
        let left = 1.0 + LEFT - u;
        let (square, cube) = (u * u, u * u * u);
        let by_u = 3.0 * square / left + cube / (left * left);
        let by_u_twice = 6.0 * u / left + 6.0 * square / (left * left) + 2.0 * cube / left.powi(3);
        Some(Self {
            value: stiffness * cube / left,
            slope: stiffness * by_u / way * angle.signum(),
            curvature: stiffness * by_u_twice / (way * way),
        })
    }
}
