//! Steps that follow a curve.

use super::Newton;
use crate::SolverError;
use crate::line_search::{Accepted, curved_search};

/// Distance at which the bend is measured, as a share of the shortened step.
const DIFFERENCE: f64 = 0.1;

impl Newton<'_> {
    /// Bends a Newton step that had to be shortened, and leaves the better one in `trial`.
    ///
    /// A pattern that slides along itself follows a curve: straight on, its waves grow higher and
    /// the energy stops the step at a small part of its length. The second derivative `a` of the
    /// path on which forces fade evenly solves `K a = -D^3 E[p, p]`, with the factor at hand
    /// (Transtrum and Sethna 2012, geodesic acceleration); `x + s p + s^2 a / 2`.
    pub(super) fn bend(&mut self, x: &[f64], straight: Accepted) -> Result<f64, SolverError> {
        let step = std::mem::take(&mut self.step);
        let reach = DIFFERENCE * straight.length;
        let mut sum = vec![0.0; x.len()];
        let mut side = vec![0.0; x.len()];
        // From both sides: the Hessian cancels and no third derivatives have to be coded.
        for reach in [reach, -reach] {
            let beside: Vec<f64> = x.iter().zip(&step).map(|(x, p)| x + reach * p).collect();
            self.objective.gradient(&beside, &mut side);
            for (sum, side) in sum.iter_mut().zip(&side) {
                *sum += side;
            }
        }
        for ((force, sum), gradient) in self.force.iter_mut().zip(&sum).zip(&self.gradient) {
            // Half of `a`, as it stands in the parabola.
            *force = -0.5 * (sum - 2.0 * gradient) / (reach * reach);
        }
        // Behind `x` the energy may end.
        if !self.force.iter().all(|force| force.is_finite()) {
            self.step = step;
            return Ok(straight.energy);
        }
        // With `H a = 0` the whole parabola stays on the rows.
        self.offset.fill(0.0);
        self.step = vec![0.0; x.len()];
        // The bend's multipliers are no reactions: those of the straight step are reported.
        let multipliers = self.multipliers.clone();
        self.solve()?;
        self.multipliers = multipliers;
        let mut trial = vec![0.0; x.len()];
        let bent = curved_search(
            self.objective,
            x,
            straight.energy,
            [&step, &self.step],
            straight.length,
            &mut trial,
        );
        self.step = step;
        if bent.is_some() {
            self.trial = trial;
        }
        Ok(bent.unwrap_or(straight.energy))
    }
}
