//! Backtracking on the energy, with a fallback for differences that drown in rounding.

use crate::Objective;
use crate::soft_modes::dot;

/// Share of the predicted decrease that a step must reach (Armijo).
const SUFFICIENT: f64 = 1e-4;

/// Backtracking gives up after this many trials: steps of 1e-9 and less.
const MAX_TRIALS: usize = 30;

/// Energy differences below this times the energy are rounding.
const ROUNDING: f64 = 1e-14;

/// Shortens `step` until the energy falls enough; leaves `trial` at the accepted point and
/// returns its energy.
///
/// `None` when `step` does not descend or no length is accepted.
pub(crate) fn line_search(
    objective: &dyn Objective,
    x: &[f64],
    energy: f64,
    step: &[f64],
    slope: f64,
    trial: &mut [f64],
) -> Option<f64> {
    if slope.is_nan() || slope >= 0.0 {
        return None;
    }
    let noise = ROUNDING * energy.abs().max(objective.energy_scale());
    let mut length = 1.0;
    for _ in 0..MAX_TRIALS {
        for ((trial, x), step) in trial.iter_mut().zip(x).zip(step) {
            *trial = x + length * step;
        }
        let reached = objective.value(trial);
        if reached <= energy + SUFFICIENT * length * slope && -slope * length > noise {
            return Some(reached);
        }
        if reached <= energy + noise && -slope * length <= noise {
            return slope_has_flattened(objective, trial, step, slope).then_some(reached);
        }
        length *= shrink(energy, slope * length, reached);
    }
    None
}

/// Minimum of the parabola through both energies and the slope, within [0.1, 0.5].
fn shrink(energy: f64, predicted: f64, reached: f64) -> f64 {
    let curvature = reached - energy - predicted;
    if curvature.is_finite() && curvature > 0.0 {
        (-0.5 * predicted / curvature).clamp(0.1, 0.5)
    } else {
        0.1
    }
}

/// The slope test that replaces the energy test within rounding (Hager & Zhang 2005,
/// approximate Wolfe condition): a good step leaves little slope, and not much uphill.
fn slope_has_flattened(objective: &dyn Objective, trial: &[f64], step: &[f64], slope: f64) -> bool {
    let mut gradient = vec![0.0; trial.len()];
    objective.gradient(trial, &mut gradient);
    dot(&gradient, step) <= (2.0 * SUFFICIENT - 1.0) * slope
}
