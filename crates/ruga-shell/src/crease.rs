//! The extra compliance of a line along which a layer folds, and what it makes of one star.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use crate::ShellError;

/// Bounds of `c D/l`, the compliance over that of a strip as long as the layer's bending length `l`.
/// Beyond either a crease is a hinge without friction, or none, to six digits.
const COMPLIANCE_RATIOS: [f64; 2] = [1e-6, 1e6];

/// Largest bending length in units of the crease edge. A layer without foundation has none; and beyond
/// this the matrix of a star would lose its digits.
const MAX_LENGTH_RATIO: f64 = 1e3;

/// Semismooth Newton steps of one star. Two do for one branch, and a junction needs one for each branch
/// that opens or closes.
const MAX_STEPS: usize = 60;

/// Halvings of such a step, enough for every digit of its length.
const MAX_HALVINGS: usize = 60;

/// The side to which a crease may fold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FoldSense {
    /// Sinks in, seen from the side that the normals point to; never a ridge.
    #[default]
    Valley,
    /// Stands out; never a furrow.
    Mountain,
    /// Folds to either side.
    Both,
}

/// A crease on one edge: extra compliance and a rest angle, in series with the bending of the layer.
///
/// ```text
/// phi = theta_0 + c m                      phi: internal fold angle; m: moment per length (N)
/// E   = (phi - theta_0)^2 / (2 c)          per length
/// c   = w (1/f - 1)/D                      a strip of width w whose bending stiffness is f D
/// ```
///
/// The internal angle is eliminated in closed form, so that a crease adds no unknown. Its width
/// enters through `c` alone: the line stays as sharp as it is on any mesh, and its onset and depth do
/// not depend on the mesh. A factor on the stiffness of an edge would not do: the stars beside a fold
/// get stiffer with every refinement, and the onset moves with them.
///
/// # Validity
/// `c D/l` is kept between 1e-6 and 1e6, with `l = (D/K0)^(1/4)`, at most a thousand edges. Edges have
/// to lie on the line: the smoothest zigzag along other edges folds at 3 to 9 % too high a load, for `c D/l` of
/// 1 to 6, and one that turns more at its vertices at a higher one. Along the line there have to be four
/// vertices per wavelength, or a soft crease folds like a saw. Beyond two radians every edge resists being
/// shut, creases too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// Extra compliance `c`: angle per moment per length (rad/N), ≥ 0. With 0 and no rest angle the
    /// edge is as any other.
    pub compliance: f64,
    /// Angle `theta_0` at which the crease has no moment (rad), positive in a valley, between -pi and
    /// pi; 0 or of the sense in which it may fold.
    pub rest_angle: f64,
    /// The side to which it may fold. An angle that is held at 0 is no crease.
    pub sense: FoldSense,
}

impl Crease {
    /// Compliance `w (1/f - 1)/D` (rad/N) of a strip of `width` (m) that keeps the share `stiffness` of
    /// the layer's bending modulus `D` (N m).
    pub fn strip_compliance(width: f64, stiffness: f64, bending_modulus: f64) -> f64 {
        width * (1.0 / stiffness - 1.0) / bending_modulus
    }

    /// Whether the edge is as any other.
    pub(crate) fn is_plain(&self) -> bool {
        self.compliance == 0.0 && self.rest_angle == 0.0
    }

    pub(crate) fn check(&self, edge: usize) -> Result<(), ShellError> {
        let Self {
            compliance,
            rest_angle,
            sense,
        } = *self;
        let angle = match sense {
            FoldSense::Valley => (0.0..PI).contains(&rest_angle),
            FoldSense::Mountain => (0.0..PI).contains(&-rest_angle),
            FoldSense::Both => rest_angle.abs() < PI,
        };
        let angles = match sense {
            FoldSense::Valley => "0 <= angle < pi in a valley",
            FoldSense::Mountain => "-pi < angle <= 0 on a mountain",
            FoldSense::Both => "-pi < angle < pi",
        };
        let checks = [
            ("crease compliance", compliance, compliance >= 0.0, ">= 0"),
            ("crease rest angle", rest_angle, angle, angles),
        ];
        match checks.into_iter().find(|(_, _, valid, _)| !valid) {
            None => Ok(()),
            Some((name, value, _, range)) => Err(ShellError::ParameterOutOfRange {
                element: "edge",
                index: edge,
                name,
                value,
                range,
            }),
        }
    }

    /// Compliance within its bounds, on an edge of this length (m) in a layer of bending modulus `D`
    /// (N m) on a foundation `K0` (N/m³).
    pub(crate) fn bounded_compliance(&self, length: f64, modulus: f64, foundation: f64) -> f64 {
        // Without foundation the ratio is infinite, and the bound in edges takes over.
        let bending_length = (modulus / foundation).sqrt().sqrt();
        let unit = bending_length.min(MAX_LENGTH_RATIO * length) / modulus;
        let [least, most] = COMPLIANCE_RATIOS.map(|ratio| ratio * unit);
        self.compliance.clamp(least, most)
    }
}

/// One internal fold angle of a star: a crease that passes through, or ends at, its vertex.
///
/// Angles are those of hinges, positive on crests, while [`Crease`] counts valleys positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    /// `p`: sum of the star's rows over the edges of the branch (J^1/2).
    pub(crate) lever: Vector3<f64>,
    /// Fold angle per moment (1/J): `c/L`, with `L` the length of line that the star owns.
    compliance: f64,
    rest_angle: f64,
    sense: FoldSense,
    /// Which of the star's inner edges it consists of.
    pub(crate) folds: [Option<u32>; 2],
}

impl Branch {
    /// The part of a crease on inner edge `fold`, with `compliance` `c/L` (1/J).
    pub(crate) fn new(fold: u32, lever: Vector3<f64>, compliance: f64, crease: &Crease) -> Self {
        Self {
            lever,
            compliance,
            rest_angle: -crease.rest_angle,
            sense: crease.sense,
            folds: [Some(fold), None],
        }
    }

    /// Two edges of one line, which fold by one angle: parallel springs.
    ///
    /// `None` where they fold to different sides.
    pub(crate) fn joined(&self, other: &Self) -> Option<Self> {
        if self.sense != other.sense {
            return None;
        }
        let [first, second] = [self, other].map(|branch| 1.0 / branch.compliance);
        let stiffness = first + second;
        let moment = first * self.rest_angle + second * other.rest_angle;
        Some(Self {
            lever: self.lever + other.lever,
            compliance: 1.0 / stiffness,
            rest_angle: moment / stiffness,
            sense: self.sense,
            folds: [self.folds[0], other.folds[0]],
        })
    }

    /// Stiffness of a hinge in series with it, while it is free to fold (J).
    pub(crate) fn series_stiffness(&self) -> f64 {
        let plain = self.lever.norm_squared();
        plain / (1.0 + self.compliance * plain)
    }

    /// Fold angle under a moment (J), and whether it follows the moment.
    fn angle(&self, moment: f64) -> (f64, bool) {
        let angle = self.rest_angle + self.compliance * moment;
        let is_free = match self.sense {
            FoldSense::Valley => angle < 0.0,
            FoldSense::Mountain => angle > 0.0,
            FoldSense::Both => true,
        };
        (if is_free { angle } else { 0.0 }, is_free)
    }

    /// Energy of the crease itself (J) under a moment (J).
    fn energy(&self, moment: f64) -> f64 {
        match self.angle(moment) {
            // Not from the angle, whose difference from rest has no digits left on a stiff crease.
            (_, true) => 0.5 * self.compliance * moment * moment,
            (_, false) => 0.5 * self.rest_angle * self.rest_angle / self.compliance,
        }
    }
}

/// Fold of the creases in a star of bend `v`, half of whose square would be its energy without them.
///
/// ```text
/// E = min over phi of |v - sum_b p_b phi_b|^2/2 + sum_b (phi_b - theta_b)^2 L_b/(2 c_b)
///   = |m|^2/2 + ...      dE/dv = m      m = v - sum_b p_b phi_b,   phi_b = theta_b + c_b/L_b p_b.m
/// d2E/dv2 = (I + sum_b c_b/L_b p_b p_b^T)^-1           over the branches that are free to fold
/// ```
///
/// A one-sided branch has `phi_b = max(0, ...)` in its sense: the energy then still has a continuous
/// gradient, and at 0 its second derivative is that of the plain star.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StarFold<'a> {
    branches: &'a [Branch],
    /// `m` (J^1/2).
    pub(crate) moment: Vector3<f64>,
}

impl<'a> StarFold<'a> {
    pub(crate) fn new(branches: &'a [Branch], bend: Vector3<f64>) -> Self {
        let moment = match branches {
            // Nearly all there are.
            [branch] => branch.moment(bend),
            _ => moment(branches, bend),
        };
        Self { branches, moment }
    }

    /// Energy of star and creases (J).
    pub(crate) fn energy(&self) -> f64 {
        let branches = self.branches.iter();
        let own = branches.map(|b| b.energy(b.lever.dot(&self.moment)));
        0.5 * self.moment.norm_squared() + own.sum::<f64>()
    }

    /// Fold angle (rad), positive in a valley, and energy (J) of one of the creases.
    pub(crate) fn state(&self, branch: &Branch) -> (f64, f64) {
        let moment = branch.lever.dot(&self.moment);
        // Not the negative, which would be -0 where a crease is shut.
        (0.0 - branch.angle(moment).0, branch.energy(moment))
    }

    /// The second derivative of the energy by the bend.
    pub(crate) fn softening(&self) -> Softening {
        let is_free = |b: &&Branch| b.angle(b.lever.dot(&self.moment)).1;
        Softening::new(self.branches.iter().filter(is_free))
    }
}

/// `(I + sum c/L p p^T)^-1` over some branches, as the square of a matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Softening {
    /// Lower triangular `L` with `L L^T = I + sum c/L p p^T`.
    factor: Matrix3<f64>,
}

impl Softening {
    fn new<'b>(branches: impl Iterator<Item = &'b Branch>) -> Self {
        let mut matrix = Matrix3::identity();
        for branch in branches {
            matrix += branch.compliance * branch.lever * branch.lever.transpose();
        }
        // Identity plus squares is positive definite; what is not finite stays as it came.
        Self {
            factor: matrix.cholesky().map_or(matrix, |factor| factor.l()),
        }
    }

    /// `R rows`, where `R^T R` is the matrix.
    ///
    /// A triangular root instead of the symmetric one: all that anyone needs is `R^T R`.
    pub(crate) fn root(&self, mut rows: Matrix3<f64>) -> Matrix3<f64> {
        self.factor.solve_lower_triangular_mut(&mut rows);
        rows
    }

    fn apply(&self, mut right: Vector3<f64>) -> Vector3<f64> {
        self.factor.solve_lower_triangular_mut(&mut right);
        self.factor.tr_solve_lower_triangular_mut(&mut right);
        right
    }
}

/// Makes the rows of a star those of a star in series with creases that are free to fold.
pub(crate) fn soften(branches: &[Branch], rows: &mut [Vector3<f64>]) {
    let softening = Softening::new(branches.iter());
    for row in rows {
        softening.factor.solve_lower_triangular_mut(row);
    }
}

impl Branch {
    /// `m` of a star with this branch alone.
    fn moment(&self, bend: Vector3<f64>) -> Vector3<f64> {
        let square = self.lever.norm_squared();
        let pull = self.lever.dot(&bend) - square * self.rest_angle;
        let moment = pull / (1.0 + self.compliance * square);
        bend - self.lever * self.angle(moment).0
    }
}

/// `m` of a star with several branches.
///
/// In the space of the moment the problem has three unknowns, however many branches meet. It is convex and
/// quadratic in pieces: Newton steps end on it after finitely many, and begin with all branches free.
fn moment(branches: &[Branch], bend: Vector3<f64>) -> Vector3<f64> {
    let pull = branches.iter().map(|b| b.lever * b.rest_angle);
    let softening = Softening::new(branches.iter());
    let mut moment = softening.apply(bend - pull.sum::<Vector3<f64>>());
    let mut free = vec![true; branches.len()];
    let mut share = 1.0;
    for _ in 0..MAX_STEPS {
        let now = free_branches(branches, &moment);
        if share == 1.0 && now == free {
            break;
        }
        free = now;
        let of_step = branches.iter().zip(&free).filter(|(_, free)| **free);
        let softening = Softening::new(of_step.map(|(branch, _)| branch));
        let step = -softening.apply(slope(branches, bend, &moment));
        share = step_length(branches, bend, &moment, &step);
        moment += step * share;
    }
    moment
}

fn free_branches(branches: &[Branch], moment: &Vector3<f64>) -> Vec<bool> {
    let branches = branches.iter();
    branches.map(|b| b.angle(b.lever.dot(moment)).1).collect()
}

/// `m - v + sum_b p_b phi_b(m)`: zero at the solution, and the slope of a convex function of `m`.
fn slope(branches: &[Branch], bend: Vector3<f64>, moment: &Vector3<f64>) -> Vector3<f64> {
    let folds = branches.iter();
    let folds = folds.map(|b| b.lever * b.angle(b.lever.dot(moment)).0);
    moment - bend + folds.sum::<Vector3<f64>>()
}

/// Share of a step at which the convex function is least along it, or 1 where that is still falling.
fn step_length(
    branches: &[Branch],
    bend: Vector3<f64>,
    moment: &Vector3<f64>,
    step: &Vector3<f64>,
) -> f64 {
    let along = |share: f64| slope(branches, bend, &(moment + step * share)).dot(step);
    let (mut low, mut high) = (0.0, 1.0);
    if along(high) <= 1e-12 * step.norm_squared() {
        return high;
    }
    for _ in 0..MAX_HALVINGS {
        let middle = 0.5 * (low + high);
        if along(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
