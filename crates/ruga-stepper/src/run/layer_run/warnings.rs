//! Warnings about the run of a layer.

use ruga_blend::Driver;
use ruga_solver::{SolveReport, StopRule};

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

/// Why a solve ended without an equilibrium, and how far it was from one.
pub(crate) fn why_stopped(stop: StopRule, (iterations, residual): (usize, f64)) -> String {
    let why = match stop {
        StopRule::IterationLimit => format!("it still moved after {iterations} iterations"),
        StopRule::LineSearch => {
            format!("after {iterations} iterations no movement brought it nearer")
        }
        StopRule::Saddle => "the state that was found is an unstable one".to_owned(),
        StopRule::Infeasible => "the constraints that hold it contradict each other".to_owned(),
        StopRule::Breakdown => "some parts are too much stiffer than others".to_owned(),
        StopRule::OutsideDomain => "triangles are collapsed or turned over".to_owned(),
        // A converged solve has found one, and nobody is told of an interrupted one.
        StopRule::Decrement | StopRule::Residual | StopRule::Interrupted => {
            format!("it ended after {iterations} iterations")
        }
    };
    match residual.is_finite() {
        true => format!("{why}; forces were out of balance by {residual:.1e} of their scale"),
        false => why,
    }
}

/// Lag up to which a result on a body that still gives way counts as an equilibrium, in rad or as a
/// change of rest lengths.
const TOLERATED_LAG: f64 = 5e-2;

impl LayerRun<'_> {
    /// Notes that the body still gave way, by `lag`, when the solve that is kept ended.
    pub(super) fn warn_of_lag(&mut self, lag: f64, pose_fraction: f64) {
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
            false => why_stopped(solve.stop, (solve.iterations, solve.residual)),
        };
        self.warn(format!("{what} at load {pose_fraction:.3}: {why}"));
    }

    /// Notes creases that lie where neither wrinkles nor their anchors take them: a strong anchor can throw the
    /// layer into a crumpled equilibrium far away.
    pub(super) fn warn_of_runaway_creases(&mut self) {
        let specs = &self.layer.spec.creases;
        let runaways = self.report.creases.iter().filter_map(|crease| {
            let spec = specs.iter().find(|spec| spec.name == crease.name)?;
            let anchored = spec.anchor.map_or(0.0, |anchor| anchor.depth);
            let most = anchored + self.report.wavelength_predicted;
            (crease.largest_depth.abs() > most).then(|| {
                format!(
                    "crease '{}' lies {:.2} mm from the surface, where nothing draws it; its map is wrong: give it a shallower or softer `anchor`, or the pose a smaller weight",
                    crease.name,
                    1e3 * crease.largest_depth.abs()
                )
            })
        });
        for warning in runaways.collect::<Vec<_>>() {
            self.is_rough = true;
            self.warn(warning);
        }
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
            let were = match self.halved {
                1 => "1 step in time was too long and was".to_owned(),
                halved => format!("{halved} steps in time were too long and were"),
            };
            self.warn(format!(
                "{were} halved; the result is right. A shorter `time_step`, with as many more `steps`, is faster"
            ));
        }
        let Some(solid) = self.layer.solid() else {
            return;
        };
        // Less is hidden in the skin that goes across.
        let overlap = solid.slit_overlap();
        let overlap = overlap.filter(|(depth, _)| *depth > self.layer.spec.material.thickness);
        let overlap = overlap.map(|(depth, crease)| {
            format!(
                "the walls of the slit of crease '{crease}' overlap by {:.2} mm at the end of the pose, because nothing holds them apart; what folds into it is that much too deep there. Compress the skin across it less, or make it shallower",
                1e3 * depth
            )
        });
        let percent = 100.0 * self.layer.capped_fraction();
        if percent >= 1.0 {
            self.warn(format!(
                "{percent:.0} % of the layer are compressed by more than 15 %, where real skin folds, doubles its wrinkles or creases, which is not modelled. The map can be used there, but holds the wrinkles of 15 to 25 % compression; move handles and obstacles less far if they look wrong"
            ));
        }
        let depth = self.layer.penetration() / self.layer.spec.material.thickness;
        if depth > 0.1 {
            self.warn(format!(
                "the layer is {depth:.1} of its thickness inside an obstacle, which may show through it; take more `steps`, or move the obstacle less far"
            ));
        }
        if let Some(overlap) = overlap {
            self.warn(overlap);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_is_told_in_words_with_its_distance_from_balance() {
        let limit = why_stopped(StopRule::IterationLimit, (60, 2.5e-3));
        assert_eq!(
            limit,
            "it still moved after 60 iterations; forces were out of balance by 2.5e-3 of their scale"
        );
        let start = why_stopped(StopRule::OutsideDomain, (0, f64::INFINITY));
        assert_eq!(start, "triangles are collapsed or turned over");
    }
}
