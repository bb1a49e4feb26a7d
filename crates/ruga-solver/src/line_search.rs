//! Backtracking on the energy, with a fallback for differences that drown in rounding.

use crate::Objective;
use crate::soft_modes::dot;

/// Share of the predicted decrease that a step must reach (Armijo).
const SUFFICIENT: f64 = 1e-4;

/// Backtracking gives up after this many trials: steps of 1e-9 and less.
const MAX_TRIALS: usize = 30;

/// Energy differences below this times the energy are rounding.
const ROUNDING: f64 = 1e-14;

/// An accepted step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accepted {
    /// Share of the step that was taken.
    pub(crate) length: f64,
    /// Energy there.
    pub(crate) energy: f64,
}

/// Shortens `step` until the energy falls enough; leaves `trial` at the accepted point.
///
/// `None` when `step` does not descend or no length is accepted.
pub(crate) fn line_search(
    objective: &dyn Objective,
    x: &[f64],
    energy: f64,
    step: &[f64],
    slope: f64,
    trial: &mut [f64],
) -> Option<Accepted> {
    // The factor has the inertia of a minimum: a step that does not descend is zero or rounding.
    if slope.is_nan() || slope >= 0.0 {
        return None;
    }
    // An energy near zero may be a sum of large terms that cancel: the scale bounds its rounding
    // from below.
    let noise = ROUNDING * energy.abs().max(objective.energy_scale());
    let mut length = 1.0;
    for _ in 0..MAX_TRIALS {
        for ((trial, x), step) in trial.iter_mut().zip(x).zip(step) {
            *trial = x + length * step;
        }
        let reached = objective.value(trial);
        let accepted = |energy| Accepted { length, energy };
        // Within the noise the energy test would pass or fail by chance, so it is not asked.
        if reached <= energy + SUFFICIENT * length * slope && -slope * length > noise {
            return Some(accepted(reached));
        }
        if reached <= energy + noise && -slope * length <= noise {
            let is_flat = slope_has_flattened(objective, trial, step, slope);
            // A failure ends the search: a shorter step lies still deeper in the noise.
            return is_flat.then(|| accepted(reached));
        }
        length *= shrink(energy, slope * length, reached);
    }
    None
}

/// Goes from `x` along the parabola `x + s step + s^2 bend` as far as the energy falls below
/// `energy`, from `s = 1` down to `least`; leaves `trial` there and returns its energy.
pub(crate) fn curved_search(
    objective: &dyn Objective,
    x: &[f64],
    energy: f64,
    [step, bend]: [&[f64]; 2],
    least: f64,
    trial: &mut [f64],
) -> Option<f64> {
    let mut length: f64 = 1.0;
    while length > least {
        let directions = step.iter().zip(bend);
        for ((trial, x), (step, bend)) in trial.iter_mut().zip(x).zip(directions) {
            *trial = x + length * (step + length * bend);
        }
        let reached = objective.value(trial);
        // Any decrease will do: `energy` is where the straight step led, so this is all gain.
        if reached < energy {
            return Some(reached);
        }
        length *= 0.5;
    }
    None
}

/// Minimum of the parabola through both energies and the slope, within [0.1, 0.5].
fn shrink(energy: f64, predicted: f64, reached: f64) -> f64 {
    // The lower bound is that of Dennis and Schnabel (1983, section 6.3.2): a minimum nearer than a
    // tenth says that the energy is no parabola here. The failed test implies the upper one.
    let curvature = reached - energy - predicted;
    if curvature.is_finite() && curvature > 0.0 {
        (-0.5 * predicted / curvature).clamp(0.1, 0.5)
    } else {
        // An infinite energy says nothing about where on the way the domain ends.
        0.1
    }
}

/// The slope test that replaces the energy test within rounding (Hager & Zhang 2005,
/// approximate Wolfe condition): a good step leaves little slope, and not much uphill.
fn slope_has_flattened(objective: &dyn Objective, trial: &[f64], step: &[f64], slope: f64) -> bool {
    let mut gradient = vec![0.0; trial.len()];
    objective.gradient(trial, &mut gradient);
    // Only the upper bound of that condition, which stands for the energy test: the lower one
    // guards against short steps, and the first trial is the whole Newton step.
    dot(&gradient, step) <= (2.0 * SUFFICIENT - 1.0) * slope
}
