//! Soft and unstable modes: the inertia at a point, the softest mode, the negative-curvature
//! search.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::error::{check_finite, check_length};
use crate::objective::check_pattern;
use crate::{Inertia, Kkt, Objective, SolverError};

/// Inverse iterations from a random vector before a curvature search.
const INVERSE_ITERATIONS: usize = 3;
/// Rounds of inverse iterations spent at most on a mode that the exact Hessian still resists.
const MOST_ROUNDS: usize = 20;

/// First length of the curvature search over the objective's length scale; it doubles.
const FIRST_LENGTH: f64 = 1e-3;

/// Doublings granted before the energy must have fallen, against rounding at the first lengths.
const GRACE: usize = 4;

/// Doublings after which the search ends: 1e-3 to 1e6 length scales.
const MAX_DOUBLINGS: usize = 30;

/// A mode of the Hessian on the null space of the constraints.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftMode {
    /// The mode, one entry per unknown, largest entry 1 in absolute value.
    pub mode: Vec<f64>,
    /// `v'Kv / v'v` of the exact Hessian without damping (N/m).
    pub rayleigh_quotient: f64,
}

/// Signs of the pivots of the exact Hessian (plus damping) at `x`, to bisect a load with.
///
/// # Errors
/// [`SolverError::PatternMismatch`], [`SizeMismatch`](SolverError::SizeMismatch),
/// [`NotFinite`](SolverError::NotFinite), [`Breakdown`](SolverError::Breakdown).
pub fn inertia_at(
    objective: &dyn Objective,
    x: &[f64],
    kkt: &mut Kkt,
) -> Result<Inertia, SolverError> {
    Ok(factorize_at(objective, x, kkt)?.1)
}

/// The mode of the exact Hessian closest to zero stiffness at `x`, among those with `H v = 0`.
///
/// `iterations` inverse iterations from a vector seeded with `seed`; 5 to 40 are usual. Just
/// past the onset of buckling this is the buckling mode, with a negative quotient; far past it
/// a stiffer mode may lie closer to zero.
///
/// # Errors
/// As [`inertia_at`].
pub fn softest_mode(
    objective: &dyn Objective,
    x: &[f64],
    kkt: &mut Kkt,
    seed: u64,
    iterations: usize,
) -> Result<SoftMode, SolverError> {
    let (exact, _) = factorize_at(objective, x, kkt)?;
    let mut generator = Pcg64Mcg::seed_from_u64(seed);
    let mut mode = random_vector(&mut generator, x.len());
    // None at all would return the random vector, off the rows.
    inverse_iterations(kkt, None, &mut mode, iterations.max(1))?;
    let rayleigh_quotient = rayleigh_quotient(kkt, &exact, &mode);
    Ok(SoftMode {
        mode,
        rayleigh_quotient,
    })
}

fn factorize_at(
    objective: &dyn Objective,
    x: &[f64],
    kkt: &mut Kkt,
) -> Result<(Vec<f64>, Inertia), SolverError> {
    check_pattern(objective, kkt)?;
    check_length("x", kkt.pattern().size(), x.len())?;
    check_finite("x", x)?;
    let mut exact = vec![0.0; kkt.pattern().entries()];
    let mut relaxed = exact.clone();
    objective.hessian(x, &mut exact, &mut relaxed);
    // Neither relaxed nor shifted: a caller asks whether this very state has buckled.
    let inertia = kkt.factorize(&exact, objective.damping())?;
    Ok((exact, inertia))
}

fn random_vector(generator: &mut Pcg64Mcg, size: usize) -> Vec<f64> {
    // Around zero: a vector of one sign would be mostly a translation, which is no wrinkle.
    (0..size).map(|_| generator.random::<f64>() - 0.5).collect()
}

/// Turns `mode` towards the softest mode of the factorised matrix, softest in relation to the
/// `metric` where there is one; largest entry 1.
///
/// Unrefined: the regularisation hardly changes the mode, and what it leaves of `H v` shrinks
/// with the mode's stiffness, far below what counts as a violation.
fn inverse_iterations(
    kkt: &mut Kkt,
    metric: Option<&[f64]>,
    mode: &mut [f64],
    iterations: usize,
) -> Result<(), SolverError> {
    let mut next = vec![0.0; mode.len()];
    for _ in 0..iterations {
        match metric {
            Some(metric) => {
                let mut weighted = vec![0.0; mode.len()];
                kkt.pattern().add_product(metric, mode, &mut weighted);
                kkt.solve_once(&weighted, &mut next)?;
            }
            None => kkt.solve_once(mode, &mut next)?,
        }
        let largest = largest(&next);
        // The null space of the constraints may be empty.
        let scale = if largest > 0.0 { 1.0 / largest } else { 0.0 };
        for (mode, next) in mode.iter_mut().zip(&next) {
            *mode = next * scale;
        }
    }
    Ok(())
}

/// `v'Kv / v'v`; 0 for the zero vector.
fn rayleigh_quotient(kkt: &Kkt, values: &[f64], mode: &[f64]) -> f64 {
    let mut product = vec![0.0; mode.len()];
    kkt.pattern().add_product(values, mode, &mut product);
    let square = dot(mode, mode);
    if square > 0.0 {
        dot(mode, &product) / square
    } else {
        0.0
    }
}

/// A state with its energy and derivatives.
pub(crate) struct Point<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) energy: f64,
    pub(crate) gradient: &'a [f64],
    pub(crate) exact: &'a [f64],
    /// Hessian without compressive stress.
    pub(crate) relaxed: &'a [f64],
}

/// A step along negative curvature: `x + step` has the energy `energy`.
pub(crate) struct CurvatureStep {
    pub(crate) step: Vec<f64>,
    pub(crate) energy: f64,
}

/// Follows the buckling mode of the factorised matrix downhill as long as the energy falls.
///
/// `point.exact` is what negative curvature is looked for; what is factorised is a
/// relaxation of it, so the first few inverse iterations may end in a mode that is soft, but
/// stable. The next ones weigh with the `relaxed` Hessian, which makes them the power iteration for
/// the buckling load: a layer that hardly resists sliding has modes softer than any wrinkle, but in
/// relation to what they cost without compression none is softer than the one that buckles. From
/// the beginning they would keep too much of the random vector's shortest waves, and the last of a
/// round takes those away. After [`MOST_ROUNDS`] of them it takes what it has.
pub(crate) fn search_curvature(
    objective: &dyn Objective,
    kkt: &mut Kkt,
    generator: &mut Pcg64Mcg,
    point: &Point<'_>,
) -> Result<Option<CurvatureStep>, SolverError> {
    let Point {
        x,
        energy,
        gradient,
        exact,
        relaxed,
    } = *point;
    let mut mode = random_vector(generator, x.len());
    inverse_iterations(kkt, None, &mut mode, INVERSE_ITERATIONS)?;
    for _ in 1..MOST_ROUNDS {
        if rayleigh_quotient(kkt, exact, &mode) < 0.0 {
            break;
        }
        inverse_iterations(kkt, Some(relaxed), &mut mode, INVERSE_ITERATIONS - 1)?;
        inverse_iterations(kkt, None, &mut mode, 1)?;
    }
    // Both senses of a mode have the same curvature; this one descends at once.
    if dot(gradient, &mode) > 0.0 {
        for entry in &mut mode {
            *entry = -*entry;
        }
    }
    // Lengths are tried by doubling: a quadratic model of negative curvature has no minimum.
    let mut length = FIRST_LENGTH * objective.length_scale();
    let mut best = (0.0, energy);
    let mut trial = vec![0.0; x.len()];
    for doubling in 0..MAX_DOUBLINGS {
        for ((trial, x), mode) in trial.iter_mut().zip(x).zip(&mode) {
            *trial = x + length * mode;
        }
        let reached = objective.value(&trial);
        if reached < best.1 {
            best = (length, reached);
        } else if best.0 > 0.0 || doubling >= GRACE {
            break;
        }
        length *= 2.0;
    }
    let (length, energy) = best;
    if length == 0.0 {
        return Ok(None);
    }
    for entry in &mut mode {
        *entry *= length;
    }
    Ok(Some(CurvatureStep { step: mode, energy }))
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn largest(vector: &[f64]) -> f64 {
    vector
        .iter()
        .fold(0.0, |largest, entry| entry.abs().max(largest))
}
