//! Steps after which the Hessian takes the stresses that a linearisation predicted.

use super::{LITTLE_GAIN, Newton};
use crate::soft_modes::dot;
use crate::{Inertia, Iteration, StopRule};

/// Steps in a row that may end above the lowest energy so far. Most rises are made up for by the next step; twice as
/// many took more factorisations on burning and on curling paper.
const PATIENCE: usize = 4;

/// Ordinary steps after one that never came down again.
const ORDINARY_STEPS: usize = 5;

/// Share of the decrease expected from a step above which its stresses need no prediction: the last steps of a solve
/// are those of the exact Hessian, and so is the inertia that proves a minimum.
const AS_EXPECTED: f64 = 0.8;

/// Halvings of a step that ends where the energy has no value.
const MOST_HALVINGS: usize = 5;

/// Where a solve with predicted stresses has been.
#[derive(Default)]
pub(super) struct Predicted {
    /// Start of the last step, from which the next stresses are predicted.
    from: Option<Vec<f64>>,
    /// Place of the lowest energy so far, and that energy (J).
    lowest: Option<(Vec<f64>, f64)>,
    /// Steps in a row that ended above it.
    above: usize,
    /// Ordinary steps still to be made.
    ordinary: usize,
}

impl Newton<'_> {
    /// Writes both Hessians at `x`, after a step that is to be predicted with its stresses.
    pub(super) fn write_hessian(&mut self, x: &[f64]) {
        let (exact, relaxed) = (&mut self.exact, &mut self.relaxed);
        match (self.objective.prediction(), &self.predicted.from) {
            (Some(prediction), Some(from)) => prediction.hessian(x, from, exact, relaxed),
            _ => self.objective.hessian(x, exact, relaxed),
        }
    }

    /// Whether a solve may stop here: not with stresses that are only predicted, and not above the lowest energy.
    pub(super) fn may_stop(&mut self, stop: StopRule, energy: f64) -> bool {
        if !matches!(stop, StopRule::Decrement | StopRule::Residual) {
            return true;
        }
        let lowest = self.predicted.lowest.as_ref();
        let is_low = lowest.is_none_or(|(_, lowest)| energy <= lowest + self.tolerance());
        if !is_low {
            // Another minimum than the one it was on the way to.
            self.predicted.above = PATIENCE;
        }
        is_low && self.predicted.from.is_none()
    }

    /// Whether the next step is one of this kind. Where a saddle is hardly left, the ordinary one looks for the way
    /// down.
    pub(super) fn predicts(&mut self, iteration: &Iteration, inertia: Inertia) -> bool {
        self.predicted.from = None;
        if self.objective.prediction().is_none() {
            return false;
        }
        if self.predicted.ordinary > 0 {
            self.predicted.ordinary -= 1;
            return false;
        }
        inertia.is_minimum() || iteration.decrement > LITTLE_GAIN
    }

    /// Takes the Newton step whole, as far as linearisation reaches, also where the energy rises; after too many
    /// rises goes back to where it was lowest. False if neither is possible.
    pub(super) fn advance_predicted(&mut self, x: &mut [f64], energy: f64) -> bool {
        let Some(prediction) = self.objective.prediction() else {
            return false;
        };
        let lowest = self.predicted.lowest.as_ref();
        if lowest.is_none_or(|(_, lowest)| energy < *lowest) {
            self.predicted.lowest = Some((x.to_vec(), energy));
            self.predicted.above = 0;
        } else {
            self.predicted.above += 1;
        }
        if self.predicted.above < PATIENCE {
            let mut length = prediction.reach(x, &self.step);
            for _ in 0..MOST_HALVINGS {
                for ((trial, x), step) in self.trial.iter_mut().zip(&*x).zip(&self.step) {
                    *trial = x + length * step;
                }
                let reached = self.objective.value(&self.trial);
                if reached.is_finite() {
                    let slope = dot(&self.gradient, &self.step);
                    let expected = -slope * length * (1.0 - 0.5 * length);
                    // Below the tolerance differences of energies may be rounding.
                    let is_expected = energy - reached >= AS_EXPECTED * expected - self.tolerance();
                    self.predicted.from = (!is_expected).then(|| x.to_vec());
                    x.copy_from_slice(&self.trial);
                    return true;
                }
                length *= 0.5;
            }
        }
        self.predicted.ordinary = ORDINARY_STEPS;
        let lowest = self.predicted.lowest.take();
        match lowest.filter(|(_, lowest)| *lowest < energy) {
            Some((place, _)) => {
                x.copy_from_slice(&place);
                true
            }
            None => false,
        }
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
