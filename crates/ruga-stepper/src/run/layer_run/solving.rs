//! One solve of a layer, and again where averaging constraints come to know better what anchors pull with.

use ruga_solver::{AtSaddle, NewtonSettings, SolveReport, StopRule};

use super::{Accuracy, LayerRun, PASSING_DECREMENT, RESULT_DECREMENT, SLOWLY_LESS, whole_kkt};
use crate::run::patches::Width;
use crate::support::motion::Inertia;
use crate::{Observer, Progress, StepperError};

/// Solves after the first, at most, in which averaging constraints are told what anchors pull with; two are the rule.
const MOST_PULLS: usize = 4;

impl LayerRun<'_> {
    /// Finds the equilibrium, or the end of a step in time, in which averaging constraints know what anchors pull with.
    pub(super) fn solve(
        &mut self,
        inertia: Option<&Inertia>,
        how: (AtSaddle, Accuracy),
        pose_fraction: f64,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        self.layer.expect_pulls();
        let mut solve = self.solve_once(inertia, how, pose_fraction, observer)?;
        // A state that is only passed is not worth another solve.
        let most = match how.1 {
            Accuracy::Result => MOST_PULLS,
            Accuracy::Passing => 0,
        };
        for _ in 0..most {
            if !solve.converged {
                break;
            }
            let Some(off) = self.layer.pulls_off() else {
                break;
            };
            let (before, lag) = (self.layer.state(), self.layer.lag());
            self.layer.tell_pulls(off);
            let again = self.solve_once(inertia, how, pose_fraction, observer)?;
            if !again.converged && again.stop != StopRule::Saddle {
                // The equilibrium before is only a little less exact. An interrupted run is told of as such.
                self.layer.restore(&before)?;
                self.warn_of_lag(lag, pose_fraction);
                if again.stop == StopRule::Interrupted {
                    solve = again;
                }
                break;
            }
            solve = SolveReport {
                left_saddle: solve.left_saddle || again.left_saddle,
                ..again
            };
        }
        self.report.end_with(&solve);
        Ok(solve)
    }

    /// The same with what the layer takes the anchors to pull with.
    fn solve_once(
        &mut self,
        inertia: Option<&Inertia>,
        (at_saddle, accuracy): (AtSaddle, Accuracy),
        pose_fraction: f64,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        let settings = NewtonSettings {
            at_saddle,
            energy_tolerance: match accuracy {
                Accuracy::Result => RESULT_DECREMENT,
                Accuracy::Passing => PASSING_DECREMENT,
            },
            residual_tolerance: self.modelling.tolerance,
            // A pattern that has only moved takes what it took before. A probe searches anew,
            // because the least convexification is what picks the mode that buckles first.
            first_relaxation: match at_saddle {
                AtSaddle::Leave | AtSaddle::Pass | AtSaddle::PassFew => {
                    SLOWLY_LESS * self.relaxation
                }
                AtSaddle::Stop => 0.0,
            },
            // Obstacles push from one side only, and where they do the energy shortens steps too
            // much: whole ones saved ten of 24 iterations when a cushion landed.
            overshoot: self.layer.is_touched(),
            seed: self.modelling.seed,
            ..NewtonSettings::default()
        };
        let vertices = self.layer.vertex_count();
        let mut keep_going = |iteration: &ruga_solver::Iteration| {
            observer.progress(Progress {
                load: pose_fraction,
                iteration: iteration.index,
                vertices,
            })
        };
        let how = (self.modelling.minimise, &settings);
        let patches = self.patches.as_mut().filter(|_| inertia.is_none());
        // What patches refuse the whole may still do.
        let patched = patches.and_then(|patches| {
            self.layer
                .minimise_patches(patches, how, &mut keep_going)
                .ok()
        });
        if let Some(patched) = &patched {
            self.report.count(patched);
        }
        let is_done = |solve: &SolveReport| solve.converged || solve.stop == StopRule::Interrupted;
        let solve = match patched.filter(is_done) {
            Some(solve) => solve,
            None => {
                // A probe asks the whole, and so does a step in time.
                let is_divisible = inertia.is_none() && at_saddle != AtSaddle::Stop;
                if is_divisible && self.wide.is_none() {
                    self.wide = self.patches_of(Width::Wide);
                }
                let solve = match self.wide.as_mut().filter(|_| is_divisible) {
                    Some(wide) => self.layer.minimise_patches(wide, how, &mut keep_going)?,
                    None => {
                        let kkt = whole_kkt(&mut self.kkt, &self.layer)?;
                        self.layer.minimise(inertia, how, kkt, &mut keep_going)?
                    }
                };
                self.report.count(&solve);
                solve
            }
        };
        // Below the critical strain it was not a pattern that needed the convexification.
        if solve.converged && solve.first_relaxation > 0.0 && self.layer.strain_ratio() > 1.0 {
            self.relaxation = solve.first_relaxation;
        }
        Ok(solve)
    }
}
