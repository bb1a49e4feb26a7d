//! The resistance of an edge to being folded shut.

use std::f64::consts::PI;

/// Bend (rad) from which on an edge resists; wrinkles bend no edge by half as much.
const SHARP: f64 = 2.0;

/// Part of the way from there to half a turn that is left in the denominator of the energy where the edge
/// is shut: finite, because a driver may fold edges whose vertices a layer cannot move.
const LEFT: f64 = 0.01;

/// State of an edge that is bent by more than `b_0`, in either sense:
/// `W = k u^3/(1.01 - u)`, `u = (|b| - b_0)/(pi - b_0)`, with the stiffness `k` (J) of a plain hinge.
///
/// A sheet has a thickness, and its two sides meet before a fold is shut. Half a turn from rest a bend
/// changes its sign, and the curvature at the ends of the edge with it: without this a solve that goes
/// there stops at a step of the energy, which is no minimum and has no derivative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharpFold {
    /// `W` (J).
    pub(crate) value: f64,
    /// First derivative of `W` by the bend (J).
    pub(crate) slope: f64,
    /// Second derivative of `W` by the bend (J), never negative.
    pub(crate) curvature: f64,
}

impl SharpFold {
    /// The state at a `bend` (rad) from rest; `None` where it is not sharp.
    #[inline]
    pub(crate) fn new(bend: f64, stiffness: f64) -> Option<Self> {
        if bend.abs() <= SHARP {
            return None;
        }
        let way = PI - SHARP;
        let u = (bend.abs() - SHARP) / way;
        let left = 1.0 + LEFT - u;
        let (square, cube) = (u * u, u * u * u);
        let by_u = 3.0 * square / left + cube / (left * left);
        let by_u_twice = 6.0 * u / left + 6.0 * square / (left * left) + 2.0 * cube / left.powi(3);
        Some(Self {
            value: stiffness * cube / left,
            slope: stiffness * by_u / way * bend.signum(),
            curvature: stiffness * by_u_twice / (way * way),
        })
    }
}
