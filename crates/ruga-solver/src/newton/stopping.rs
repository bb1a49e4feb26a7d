//! Where a solve ends.

use super::Newton;
use crate::{AtSaddle, Inertia, Iteration, StopRule};

/// Relaxed decrement at which [`AtSaddle::Stop`] has recognised a saddle.
const SADDLE_DECREMENT: f64 = 1e-3;
/// Indefinite iterations after which [`AtSaddle::Stop`] waits for no small decrement any more.
const SADDLE_ITERATIONS: usize = 5;

/// Share that may be left with [`AtSaddle::PassFew`] of the most modes of negative curvature that one iteration has
/// found: the last tenth took a quarter of the factorisations in which a large patch of skin begins to wrinkle.
const FEW: f64 = 0.1;

/// Iterations in a row in which nothing but a diagonal mends the Hessian and hardly any energy is to be
/// gained, after which a solve is stuck.
const STUCK_ITERATIONS: usize = 5;

impl Newton<'_> {
    /// Why a solve ends at a state, if it does.
    pub(super) fn stop(&self, iteration: &Iteration, inertia: Inertia) -> Option<StopRule> {
        // What restoring constraints took counts as well.
        let gained = self.before.map_or(f64::INFINITY, |before| {
            (before - iteration.energy).abs() / self.objective.energy_scale()
        });
        // No tolerance counts at a saddle that is not to be passed: a flat film under compression has no residual at
        // all.
        if !inertia.is_minimum() {
            // A collapsed triangle is not passed: nothing but a diagonal mends it.
            if self.may_pass(inertia)
                && self.shifted_iterations == 0
                && iteration.decrement.max(gained) <= self.settings.energy_tolerance
            {
                return Some(StopRule::Decrement);
            }
            // A triangle that has all but collapsed: the state hardly moves, and would for hundreds of
            // iterations.
            if self.shifted_iterations >= STUCK_ITERATIONS
                && iteration.decrement <= self.settings.energy_tolerance
            {
                return Some(StopRule::Breakdown);
            }
            let recognised = iteration.decrement <= SADDLE_DECREMENT
                || self.indefinite_iterations >= SADDLE_ITERATIONS;
            let stop = self.settings.at_saddle == AtSaddle::Stop && recognised;
            return stop.then_some(StopRule::Saddle);
        }
        if iteration.residual <= self.settings.residual_tolerance {
            return Some(StopRule::Residual);
        }
        // A pattern that can slide along a curved valley keeps a residual of 1e-4 long after its
        // energy has stopped changing; the decrement sees that.
        (iteration.decrement <= self.settings.energy_tolerance).then_some(StopRule::Decrement)
    }

    /// Whether a saddle may be passed where there is little to be gained.
    fn may_pass(&self, inertia: Inertia) -> bool {
        match self.settings.at_saddle {
            AtSaddle::Leave | AtSaddle::Stop => false,
            AtSaddle::Pass => true,
            AtSaddle::PassFew => inertia.excess() as f64 <= FEW * self.most_modes as f64,
        }
    }
}
