//! Steps that are taken whole although the energy rises, for the next one to make up for it.

use super::Newton;
use crate::line_search::{Accepted, line_search};
use crate::soft_modes::dot;

/// The shortened step that a whole one replaced, for the case that this was a mistake.
pub(super) struct Overshot {
    /// The end of the shortened step, and its energy.
    shortened: Vec<f64>,
    energy: f64,
}

impl Newton<'_> {
    /// Takes a Newton step whole that would have to be shortened; false where the energy has no
    /// value there.
    ///
    /// What is in the way of a step into an obstacle is whatever touches it first. From inside the
    /// obstacle the next step sees all that touches, and lets go of what is drawn instead of pressed,
    /// for which no step has to be shortened (the watchdog of Chamberlain, Powell, Lemarechal and
    /// Pedersen 1982, with a patience of one step).
    pub(super) fn overshoot(&mut self, x: &mut [f64], accepted: Accepted) -> bool {
        let whole: Vec<f64> = x.iter().zip(&self.step).map(|(x, p)| x + p).collect();
        if !self.objective.value(&whole).is_finite() {
            return false;
        }
        self.overshot = Some(Overshot {
            shortened: self.trial.clone(),
            energy: accepted.energy,
        });
        x.copy_from_slice(&whole);
        true
    }

    /// Takes the step after a whole one, or goes back to the shortened one if that ends lower.
    pub(super) fn redeem(&mut self, x: &mut [f64], energy: f64, overshot: &Overshot) {
        let slope = dot(&self.gradient, &self.step);
        let (step, trial) = (&self.step, &mut self.trial);
        match line_search(self.objective, x, energy, step, slope, trial) {
            // Compared with the shortened step and not with its start: falling at all is not
            // enough.
            Some(accepted) if accepted.energy < overshot.energy => {
                x.copy_from_slice(&self.trial);
                self.report.energy = accepted.energy;
            }
            _ => self.go_back(x, overshot),
        }
    }

    pub(super) fn go_back(&mut self, x: &mut [f64], overshot: &Overshot) {
        x.copy_from_slice(&overshot.shortened);
        self.report.energy = overshot.energy;
    }
}
