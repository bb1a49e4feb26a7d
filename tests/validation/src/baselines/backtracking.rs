//! Backtracking on the energy.

use ruga_solver::Objective;

use super::dot;

/// Share of the predicted decrease that a step has to reach (Armijo).
const SUFFICIENT: f64 = 1e-4;

/// Lengths that are tried.
const TRIALS: usize = 30;

/// Energy differences below this times the energy are rounding.
const ROUNDING: f64 = 1e-14;

/// The end of `step` from `x`, shortened until the energy falls enough; `None` when the step does not
/// descend or no length will do.
///
/// Where differences of energy drown in rounding, the slope has to have flattened instead (Hager and
/// Zhang 2005, approximate Wolfe condition).
pub(super) fn shortened(
    objective: &dyn Objective,
    x: &[f64],
    energy: f64,
    step: &[f64],
    slope: f64,
) -> Option<Vec<f64>> {
    if slope.is_nan() || slope >= 0.0 {
        return None;
    }
    let noise = ROUNDING * energy.abs().max(objective.energy_scale());
    let mut length = 1.0;
    for _ in 0..TRIALS {
        let ends = x.iter().zip(step);
        let there: Vec<f64> = ends.map(|(x, step)| x + length * step).collect();
        let reached = objective.value(&there);
        let predicted = slope * length;
        if -predicted > noise {
            if reached <= energy + SUFFICIENT * predicted {
                return Some(there);
            }
        } else if reached <= energy + noise {
            let mut gradient = vec![0.0; x.len()];
            objective.gradient(&there, &mut gradient);
            let is_flat = dot(&gradient, step) <= (2.0 * SUFFICIENT - 1.0) * slope;
            return is_flat.then_some(there);
        }
        // The least point of the parabola through both energies and the slope.
        let curvature = reached - energy - predicted;
        length *= match curvature.is_finite() && curvature > 0.0 {
            true => (-0.5 * predicted / curvature).clamp(0.1, 0.5),
            false => 0.1,
        };
    }
    None
}
