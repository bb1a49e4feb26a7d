//! Warnings about the run of a layer.

use ruga_blend::Driver;
use ruga_solver::SolveReport;

use super::LayerRun;

/// Warning of a solve whose method says nothing about stability, as
/// [`Modelling::minimise`](crate::Modelling::minimise) may be one.
const MISSING_INERTIA: &str =
    "the solver cannot tell a wrinkled state from an unstable flat one; compare with the default";
/// Warning of a solve that ended on a saddle.
const UNSTABLE: &str = "forces are in balance, but the state is an unstable one";

/// Why a solve that converged may not have ended in a stable state.
fn unverified_stability(solve: &SolveReport) -> Option<&'static str> {
    match solve.inertia {
        None => Some(MISSING_INERTIA),
        Some(inertia) => (!inertia.is_minimum()).then_some(UNSTABLE),
    }
}

/// Lag up to which a result on a body that still gives way counts as an equilibrium, in rad or as a
/// change of rest lengths.
const TOLERATED_LAG: f64 = 5e-2;

impl LayerRun<'_> {
    /// Notes that the body still gave way when the last solve ended.
    pub(super) fn warn_of_lag(&mut self, pose_fraction: f64) {
        let lag = self.layer.lag();
        if lag > TOLERATED_LAG {
            self.is_rough = true;
            self.warn(format!(
                "only a rough equilibrium found at load {pose_fraction:.3}: the body still gave way under the layer, by {:.1} %; take more `steps`",
                100.0 * lag
            ));
        }
    }

    /// Warns of a wrinkled state that may be unstable.
    pub(super) fn warn_unverified(&mut self, solve: &SolveReport) {
        // A layer that nothing compresses beyond its critical strain has no wrinkled state to miss.
        if let Some(warning) = unverified_stability(solve)
            && self.layer.strain_ratio() > 1.0
        {
            self.warn(warning.to_owned());
        }
    }

    /// Warns of a solve that found no equilibrium, and says why.
    pub(super) fn warn_of_failure(&mut self, what: &str, pose_fraction: f64, solve: &SolveReport) {
        let why = match solve.converged {
            true => "a vertex passed through an obstacle".to_owned(),
            false => format!(
                "{:?} after {} iterations, relative residual {:.1e}",
                solve.stop, solve.iterations, solve.residual
            ),
        };
        self.warn(format!("{what} at load {pose_fraction:.3} ({why})"));
    }

    /// Notes where the layer was to wrinkle and has not.
    pub(crate) fn warn_unwrinkled(&mut self, driver: &Driver) {
        for warning in self.layer.unwrinkled(driver) {
            self.warn(warning);
        }
    }

    /// Notes what a plan cannot know: steps that were halved, and what a body and its obstacles do to the
    /// layer.
    pub(crate) fn warn_of_loading(&mut self) {
        if self.halved > 0 {
            self.warn(format!("steps in time that were halved: {}", self.halved));
        }
        if self.layer.solid().is_none() {
            return;
        }
        let percent = 100.0 * self.layer.capped_fraction();
        if percent >= 1.0 {
            self.warn(format!(
                "{percent:.0} % of the layer are compressed by more than 15 %, where real skin folds, doubles its wrinkles or creases, which is not modelled. The map can be used there, but holds the wrinkles of 15 to 25 % compression; move handles and obstacles less far if they look wrong"
            ));
        }
        let depth = self.layer.penetration() / self.layer.spec.material.thickness;
        if depth > 0.1 {
            self.warn(format!(
                "the layer is {depth:.1} of its thickness inside an obstacle"
            ));
        }
    }
}
