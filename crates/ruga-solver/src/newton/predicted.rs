//! Steps after which the Hessian takes the stresses that a linearisation predicted.

use super::{LITTLE_GAIN, Newton};
use crate::{Inertia, Iteration, StopRule};

/// Rises of the energy since it was lowest after which the solve goes back there. Most are made up for by the steps that
/// follow.
const PATIENCE: usize = 3;
/// States above the lowest energy, falling or not, after which it goes back as well.
const MOST_ABOVE: usize = 8;

/// Ordinary steps after going back, so that the same way is not tried again at once.
const ORDINARY_STEPS: usize = 5;
/// Factor on the reach after going back. A way that led to a lower energy undoes one such factor.
const SHORTER: f64 = 0.6;

/// Decrement of the step before, below which the stresses that are there are as good as predicted ones. Only with them
/// a minimum is proven without another factorisation.
const NEAR: f64 = 1e-3;

/// Trials of a step that ends where the energy has no value, each half as long. A reach that does not see what is in the
/// way is off by a factor of a few, not of hundreds.
const MOST_TRIALS: usize = 5;

/// Where a solve with predicted stresses has been.
#[derive(Default)]
pub(super) struct Predicted {
    /// Start of the last step, from which the next stresses are predicted.
    from: Option<Vec<f64>>,
    /// Whether the Hessian at hand has such stresses.
    is_at_hand: bool,
    /// Place of the lowest energy so far, and that energy (J).
    lowest: Option<(Vec<f64>, f64)>,
    /// Energy of the state before (J), if that was above it, too.
    before: Option<f64>,
    /// States in a row that are above it, and those of them to which the energy rose.
    above: usize,
    rises: usize,
    /// Ordinary steps still to be made.
    ordinary: usize,
    /// Whether the last step was a predicted one.
    is_on_its_way: bool,
    /// Times that it has gone back, less those that it has found a lower energy.
    failures: i32,
}

impl Newton<'_> {
    /// Writes both Hessians at `x`: with predicted stresses right after a predicted step, else the exact ones.
    pub(super) fn write_hessian(&mut self, x: &[f64]) {
        let (exact, relaxed) = (&mut self.exact, &mut self.relaxed);
        let is_near = self.report.decrement < NEAR
            && self
                .report
                .inertia
                .is_some_and(|inertia| inertia.is_minimum());
        let from = self.predicted.from.take().filter(|_| !is_near);
        self.predicted.is_at_hand = from.is_some();
        match (self.objective.prediction(), from) {
            (Some(prediction), Some(from)) => prediction.hessian(x, &from, exact, relaxed),
            _ => self.objective.hessian(x, exact, relaxed),
        }
    }

    /// Whether the Hessian at hand has predicted stresses; written again it has none.
    pub(super) fn is_predicted(&self) -> bool {
        self.predicted.is_at_hand
    }

    /// Whether a solve that has converged may stop there: not above the lowest energy, which belongs to another one
    /// than it was on the way to.
    pub(super) fn may_stop(&mut self, stop: StopRule, energy: f64) -> bool {
        let has_converged = matches!(stop, StopRule::Decrement | StopRule::Residual);
        let lowest = self.predicted.lowest.as_ref();
        if has_converged && lowest.is_some_and(|(_, lowest)| energy > lowest + self.tolerance()) {
            self.predicted.rises = PATIENCE;
            return false;
        }
        true
    }

    /// Whether the next step is one of this kind. Where a saddle is hardly left, the ordinary one looks for the way
    /// down.
    pub(super) fn predicts(&mut self, iteration: &Iteration, inertia: Inertia) -> bool {
        // Nothing would make up for a rise in the last iteration.
        let is_last = iteration.index + 1 == self.settings.max_iterations;
        if is_last || self.objective.prediction().is_none() {
            return false;
        }
        if self.predicted.ordinary > 0 {
            self.predicted.ordinary -= 1;
            return false;
        }
        inertia.is_minimum() || iteration.decrement > LITTLE_GAIN
    }

    /// Takes the Newton step whole, as far as linearisation reaches, also where the energy rises; after too many
    /// rises goes back to where it was lowest, and to the exact Hessian. False if it has that and stands there.
    pub(super) fn advance_predicted(&mut self, x: &mut [f64], energy: f64) -> bool {
        let Some(prediction) = self.objective.prediction() else {
            return false;
        };
        if self.goes_on(x, energy) {
            let mut length = prediction.reach(x, &self.step);
            length *= SHORTER.powi(self.predicted.failures);
            for _ in 0..MOST_TRIALS {
                for ((trial, x), step) in self.trial.iter_mut().zip(&*x).zip(&self.step) {
                    *trial = x + length * step;
                }
                if self.objective.value(&self.trial).is_finite() {
                    self.predicted.from = Some(x.to_vec());
                    self.predicted.is_on_its_way = true;
                    x.copy_from_slice(&self.trial);
                    return true;
                }
                length *= 0.5;
            }
        }
        self.predicted.ordinary = ORDINARY_STEPS;
        self.predicted.failures += 1;
        self.predicted.is_on_its_way = false;
        (self.predicted.above, self.predicted.rises) = (0, 0);
        let lowest = self.predicted.lowest.take();
        match lowest.filter(|(_, lowest)| *lowest < energy) {
            Some((place, _)) => {
                x.copy_from_slice(&place);
                true
            }
            None => self.is_predicted(),
        }
    }

    /// Takes note of a state; whether it is no reason to go back to the lowest.
    fn goes_on(&mut self, x: &[f64], energy: f64) -> bool {
        let predicted = &mut self.predicted;
        match &predicted.lowest {
            Some((_, lowest)) if energy >= *lowest => {
                predicted.above += 1;
                let falls = predicted
                    .before
                    .replace(energy)
                    .is_some_and(|before| energy < before);
                predicted.rises += usize::from(!falls);
            }
            _ => {
                predicted.lowest = Some((x.to_vec(), energy));
                predicted.before = None;
                (predicted.above, predicted.rises) = (0, 0);
                // Ordinary steps prove nothing.
                let paid = i32::from(predicted.is_on_its_way);
                predicted.failures = (predicted.failures - paid).max(0);
            }
        }
        predicted.rises < PATIENCE && predicted.above < MOST_ABOVE
    }

    /// Leaves `x` at the lowest energy if the solve ended above it.
    pub(super) fn end_prediction(&mut self, x: &mut [f64]) {
        let Some((place, energy)) = self.predicted.lowest.take() else {
            return;
        };
        if self.report.energy > energy + self.tolerance() {
            x.copy_from_slice(&place);
            self.report.energy = energy;
        }
    }

    /// Energy that does not matter (J).
    fn tolerance(&self) -> f64 {
        self.settings.energy_tolerance * self.objective.energy_scale()
    }
}
