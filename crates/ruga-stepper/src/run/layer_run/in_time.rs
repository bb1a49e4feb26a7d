//! Motion in time.

use ruga_solver::{AtSaddle, NewtonSettings, SolveReport, StopRule};

use super::{Accuracy, Ending, LayerRun, Loading, whole_kkt};
use crate::{Dynamics, Observer, Phase, StepperError};

/// Newton decrement of the equilibrium, in energy scales, at which a moving layer counts as being
/// there.
const AT_REST: f64 = 1e-4;

/// Steps in time after which a layer that still moves is given up.
const MOST_STEPS_TO_REST: usize = 200;

/// Halvings of a step in time before it counts as impossible.
const HALVINGS: u32 = 4;

/// How the steps until the layer rests have ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rest {
    Found,
    /// The layer still moves.
    StillMoving,
    /// A step had no end that could be found; the layer is where the solver left it.
    NoStep,
    /// The observer ended it.
    Interrupted,
}

impl LayerRun<'_> {
    /// Moves in time through `loads`, one step from each to the next, shorter where they are less than
    /// `1 / steps` apart; where the loading asks for it, stands still until the layer rests.
    pub(super) fn move_in_time(
        &mut self,
        loading: &mut dyn Loading,
        (loads, steps): (&[f64], u32),
        dynamics: Dynamics,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let mut worst = Ending::Reached;
        let mut from = 0.0;
        for &load in loads {
            let before = self.layer.state();
            let step = Dynamics {
                // A key or a keyframe may divide a step. The pieces take a part of its time each,
                // or whatever moves would be slower in them.
                time_step: f64::from(steps) * (load - from) * dynamics.time_step,
                ..dynamics
            };
            let mut ending = self.step(loading, [from, load], (step, HALVINGS), observer)?;
            if ending == Ending::Reached && loading.rests_at(load) {
                let rest = self.come_to_rest(dynamics, loading.pose_fraction(load), observer)?;
                ending = match rest {
                    Rest::Found => Ending::Reached,
                    // Positions at the end of a step are a valid state in motion: they are handed
                    // out, and the pose counts as not converged.
                    Rest::StillMoving => {
                        worst = Ending::GaveUp;
                        Ending::Reached
                    }
                    // The solver stopped somewhere on its way, which is no state at any time.
                    Rest::NoStep => Ending::GaveUp,
                    Rest::Interrupted => Ending::Interrupted,
                };
            }
            if ending != Ending::Reached {
                self.layer.restore(&before)?;
                return Ok(ending);
            }
            if !loading.kept(self, load, observer)? {
                return Ok(Ending::Interrupted);
            }
            from = load;
        }
        Ok(worst)
    }

    /// One step in time between two loads, in halves where it cannot be made at once.
    fn step(
        &mut self,
        loading: &mut dyn Loading,
        [from, to]: [f64; 2],
        (dynamics, halvings): (Dynamics, u32),
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let before = self.layer.state();
        let solve = self.step_at_once(loading, to, dynamics, observer)?;
        if solve.stop == StopRule::Interrupted {
            return Ok(Ending::Interrupted);
        }
        if solve.converged && !self.layer.has_passed(&before) {
            return Ok(Ending::Reached);
        }
        if halvings == 0 {
            self.warn_of_failure("no step in time found", loading.pose_fraction(to), &solve);
        }
        self.layer.restore(&before)?;
        if halvings == 0 {
            return Ok(Ending::GaveUp);
        }
        self.halved += 1;
        // Half of the way takes half of the time, so that velocities stay what they are.
        let half = Dynamics {
            time_step: 0.5 * dynamics.time_step,
            ..dynamics
        };
        let (half, middle) = ((half, halvings - 1), 0.5 * (from + to));
        match self.step(loading, [from, middle], half, observer)? {
            Ending::Reached => self.step(loading, [middle, to], half, observer),
            ending => Ok(ending),
        }
    }

    fn step_at_once(
        &mut self,
        loading: &dyn Loading,
        to: f64,
        dynamics: Dynamics,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        observer.phase(self.index, Phase::Sampling);
        let step = self.layer.time_step(dynamics);
        loading.place(&mut self.layer, to, Some(&step.inertia))?;
        observer.phase(self.index, Phase::Integration);
        let pose_fraction = loading.pose_fraction(to);
        // What a step leaves out of balance the next one inherits: without a second solve it has to be
        // a result at once.
        let is_polished_later = self.layer.solid().is_some() && loading.is_result(to);
        let accuracy = match is_polished_later {
            true => Accuracy::Passing,
            false => Accuracy::Result,
        };
        let how = (AtSaddle::Leave, accuracy);
        let mut solve = self.solve(Some(&step.inertia), how, pose_fraction, observer)?;
        if solve.converged && is_polished_later {
            let polished = self.polish(Some(&step.inertia), pose_fraction, observer)?;
            if polished.stop == StopRule::Interrupted {
                solve.stop = polished.stop;
            }
        } else if solve.converged {
            self.warn_unverified(&solve);
        }
        self.layer.end_step(&step);
        Ok(solve)
    }

    /// Makes steps in time with everything below standing still, until the layer is in equilibrium.
    fn come_to_rest(
        &mut self,
        dynamics: Dynamics,
        pose_fraction: f64,
        observer: &mut dyn Observer,
    ) -> Result<Rest, StepperError> {
        for _ in 0..MOST_STEPS_TO_REST {
            if self.is_at_rest()? {
                return Ok(Rest::Found);
            }
            // Steps are whole ones here: where nothing moves there is no load to divide.
            let step = self.layer.time_step(dynamics);
            let how = (AtSaddle::Leave, Accuracy::Result);
            let solve = self.solve(Some(&step.inertia), how, pose_fraction, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Rest::Interrupted);
            }
            if !solve.converged {
                self.warn_of_failure("no step in time found", pose_fraction, &solve);
                return Ok(Rest::NoStep);
            }
            self.warn_unverified(&solve);
            self.layer.end_step(&step);
        }
        if self.is_at_rest()? {
            return Ok(Rest::Found);
        }
        self.warn(format!(
            "still moving after {MOST_STEPS_TO_REST} steps in time at load {pose_fraction:.3}, and the result shows it on its way; take a longer `time_step` to bring it to rest"
        ));
        Ok(Rest::StillMoving)
    }

    /// Whether the layer is in equilibrium, a stable one as far as the method can tell.
    fn is_at_rest(&mut self) -> Result<bool, StepperError> {
        let settings = NewtonSettings {
            // At a saddle forces balance as well, but any disturbance moves the layer on. One
            // iteration gives the decrement and the matrix inertia, and nothing else is wanted.
            at_saddle: AtSaddle::Stop,
            max_iterations: 1,
            energy_tolerance: AT_REST,
            residual_tolerance: self.modelling.tolerance,
            ..NewtonSettings::default()
        };
        let state = self.layer.state();
        let how = (self.modelling.minimise, &settings);
        let kkt = whole_kkt(&mut self.kkt, &self.layer)?;
        let solve = self.layer.minimise(None, how, kkt, &mut |_| true)?;
        self.report.factorizations += solve.factorizations;
        // Looking must not move the layer: its velocities belong to where it was.
        self.layer.restore(&state)?;
        Ok(solve.converged)
    }
}
