//! One layer on its way to its load, and what is told of it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_solver::{
    AtSaddle, LoadSettings, LoadStepper, NewtonSettings, Outcome, SolveReport, SolverError,
    StopRule, Trial, Verdict,
};

use crate::below::BelowSurface;
use crate::layer::{Layer, LayerState};
use crate::preparing::Preparing;
use crate::skin_energy::UpperShell;
use crate::skin_mesh::SkinMesh;
use crate::{LayerPlan, LayerReport, Modelling, Observer, Phase, Progress, StepperError};

/// Share of the critical strain below which nothing can wrinkle.
pub(crate) const LEAST_RATIO: f64 = 0.9;

/// Where the way up to the onset of a layer begins that lies on another, in critical strains: as
/// high as nothing buckles. Far above the onset a trial costs ten times as much.
const FIRST_RATIO: f64 = 0.9;

/// Largest factor between two steps' strains on a surface that has moved: up to 2 the wavelength
/// is kept.
const GROWTH: f64 = 1.5;

/// Newton decrement, in energy scales, at which a state is a result. Where a pattern is held fast
/// the last step, which is taken, leaves a square of it; on a whole forehead some defect always
/// slides a little further, for hundreds of iterations, while the energy changes by a thousandth.
const SETTLED: f64 = 3e-5;

/// Newton decrement, in energy scales, at which a state that is only passed is good enough. What
/// is left then is the pattern sliding along itself, and the next load moves it anyway.
const PASSING: f64 = 1e-3;

/// Newton decrement of the equilibrium, in energy scales, at which a moving layer counts as being
/// there.
const AT_REST: f64 = 1e-4;

/// Steps in time after which a layer that still moves is given up.
const MOST_STEPS_TO_REST: usize = 200;

/// The relaxation that a solve is tried with first, over what the last one needed: lets it shrink.
const SLOWLY_LESS: f64 = 0.97;

/// What is told of a solve whose method says nothing about stability, and of one that ended on a
/// saddle: [`Modelling::minimise`] may be such a method.
const MISSING_INERTIA: &str =
    "the solver cannot tell a wrinkled state from an unstable flat one; compare with the default";
const UNSTABLE: &str = "forces are in balance, but the state is an unstable one";

/// What a solve that converged leaves open about a layer that may wrinkle.
pub(crate) fn blind_spot(solve: &SolveReport) -> Option<&'static str> {
    match solve.inertia {
        None => Some(MISSING_INERTIA),
        Some(inertia) => (!inertia.is_minimum()).then_some(UNSTABLE),
    }
}

/// What a load means to a layer, and what follows from reaching one.
pub(crate) trait Course {
    /// The surface below the layer's vertices at `load`, and the share of its strain that counts.
    fn below(&self, skin: &SkinMesh, load: f64) -> (BelowSurface, f64);

    /// `load` as a fraction of the pose.
    fn shown(&self, load: f64) -> f64;

    /// Whether the state at `load` is wanted for itself, not only on the way to others.
    fn is_result(&self, load: f64) -> bool;

    /// The layer is in equilibrium at `load`; false when the observer ends the work.
    fn kept(
        &mut self,
        run: &LayerRun<'_>,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError>;
}

/// How following a course ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// At the last load.
    Reached,
    /// Without an equilibrium for the next load.
    GaveUp,
    /// By the observer.
    Interrupted,
}

/// Where a step in time led.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arrival {
    /// Where it was to lead: to its end, or to rest.
    Resting,
    /// To a state that still moves where it was to rest.
    Moving,
    /// To no state.
    Nowhere,
    /// Ended by the observer.
    Interrupted,
}

/// How exact a state has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pace {
    /// It decides something or is handed out.
    Result,
    /// It is the start of the next.
    Passing,
}

/// The settings of a solve, of which the last one with a pattern needed this `relaxation`.
pub(crate) fn newton_settings(
    modelling: &Modelling,
    (at_saddle, pace): (AtSaddle, Pace),
    relaxation: f64,
) -> NewtonSettings {
    NewtonSettings {
        at_saddle,
        energy_tolerance: match pace {
            Pace::Result => SETTLED,
            Pace::Passing => PASSING,
        },
        residual_tolerance: modelling.tolerance,
        first_relaxation: match at_saddle {
            AtSaddle::Leave => SLOWLY_LESS * relaxation,
            AtSaddle::Stop => 0.0,
        },
        seed: modelling.seed,
        ..NewtonSettings::default()
    }
}

/// A layer with its report.
pub(crate) struct LayerRun<'a> {
    pub(crate) modelling: &'a Modelling,
    /// Number of the layer in its stack.
    pub(crate) index: usize,
    pub(crate) layer: Layer,
    pub(crate) report: LayerReport,
    /// What had to be left out of the first step of the last solve that began with a pattern.
    relaxation: f64,
    /// What the user should know, without the layer's name.
    pub(crate) warnings: Vec<String>,
}

impl<'a> LayerRun<'a> {
    pub(crate) fn new(
        index: usize,
        layer: Layer,
        planned: &LayerPlan,
        modelling: &'a Modelling,
    ) -> Self {
        let report = LayerReport {
            painted: planned.painted,
            name: layer.spec.name.clone(),
            vertices: layer.vertex_count(),
            faces: layer.face_count(),
            constraints: layer.row_count(),
            wavelength_predicted: planned.wavelength,
            critical_strain_predicted: planned.critical_strain,
            ..LayerReport::default()
        };
        Self {
            modelling,
            index,
            report,
            relaxation: 0.0,
            warnings: layer.row_warning.iter().cloned().collect(),
            layer,
        }
    }

    /// Counts in what an earlier run of the same layer has done.
    pub(crate) fn take_history(&mut self, before: LayerRun<'_>) {
        self.report.newton_iterations += before.report.newton_iterations;
        self.report.factorizations += before.report.factorizations;
        self.report.onset_load = self.report.onset_load.or(before.report.onset_load);
        self.relaxation = before.relaxation;
        // What was wrong with the rows of another mesh is no longer so.
        let outdated = before.layer.row_warning;
        for warning in before.warnings {
            if outdated.as_ref() != Some(&warning) {
                self.warn(warning);
            }
        }
    }

    /// Adds to the warnings what is not among them.
    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Solves at every one of `loads`, and in between where the layer begins to wrinkle.
    pub(crate) fn follow(
        &mut self,
        course: &mut dyn Course,
        loads: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        self.climb(course, loads, LoadSettings::default(), observer)
    }

    /// Solves at load 1, with no more steps on the way than it takes to find the onset.
    pub(crate) fn follow_from_onset(
        &mut self,
        course: &mut dyn Course,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let (below, share) = course.below(self.layer.skin(), 1.0);
        self.layer.set_below(below, share)?;
        let settings = LoadSettings {
            first: self.layer.strain_ratios().fraction_for(FIRST_RATIO),
            ..LoadSettings::default()
        };
        self.climb(course, &[1.0], settings, observer)
    }

    /// Goes on from the present shape on a surface that has moved.
    ///
    /// The strain grows from the demand `before`, which the layer is used to. Gives up where it was
    /// not wrinkled and now may be: then the onset has to be found.
    pub(crate) fn move_on(
        &mut self,
        below: BelowSurface,
        (before, shown): (f64, f64),
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        observer.phase(self.index, Phase::Sampling);
        self.layer.set_below(below.clone(), 1.0)?;
        let demand = self.layer.strain_ratio();
        if before < 1.0 && demand > LEAST_RATIO {
            return Ok(Ending::GaveUp);
        }
        let mut share = if demand > LEAST_RATIO {
            self.layer.strain_ratios().fraction_for(before)
        } else {
            1.0
        };
        observer.phase(self.index, Phase::Integration);
        loop {
            share = (share * GROWTH).min(1.0);
            self.layer.set_below(below.clone(), share)?;
            let pace = if share < 1.0 {
                Pace::Passing
            } else {
                Pace::Result
            };
            let solve = self.solve((AtSaddle::Leave, pace), shown, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Ending::Interrupted);
            }
            if !solve.converged {
                return Ok(Ending::GaveUp);
            }
            if share == 1.0 {
                self.tell_of_blind_spot(&solve);
                return Ok(Ending::Reached);
            }
        }
    }

    /// Moves in time through `loads`, and stands still at the `keys` until the layer rests.
    pub(crate) fn follow_in_time(
        &mut self,
        course: &mut dyn Course,
        (loads, keys): (&[f64], &[f64]),
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let mut worst = Ending::Reached;
        for &load in loads {
            observer.phase(self.index, Phase::Sampling);
            let before = self.layer.state();
            let start = self.layer.positions().to_vec();
            let (below, share) = course.below(self.layer.skin(), load);
            self.layer.set_below(below, share)?;
            observer.phase(self.index, Phase::Integration);
            let shown = course.shown(load);
            let is_key = keys.iter().any(|key| (key - load).abs() < 1e-9);
            match self.move_in_time(start, is_key, shown, observer)? {
                Arrival::Resting => {}
                Arrival::Moving => worst = Ending::GaveUp,
                Arrival::Nowhere => {
                    self.layer.restore(&before)?;
                    return Ok(Ending::GaveUp);
                }
                Arrival::Interrupted => return Ok(Ending::Interrupted),
            }
            if !course.kept(self, load, observer)? {
                return Ok(Ending::Interrupted);
            }
        }
        Ok(worst)
    }

    /// One step in time from `start`, or as many as it takes to come to rest.
    fn move_in_time(
        &mut self,
        mut start: Vec<Vector3<f64>>,
        until_rest: bool,
        shown: f64,
        observer: &mut dyn Observer,
    ) -> Result<Arrival, StepperError> {
        for _ in 0..MOST_STEPS_TO_REST {
            let from = Some(start.as_slice());
            let solve = self.solve_from(from, (AtSaddle::Leave, Pace::Result), shown, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Arrival::Interrupted);
            }
            if !solve.converged {
                self.warnings.push(format!(
                    "no step in time found at load {shown:.3} ({:?} after {} iterations, relative residual {:.1e})",
                    solve.stop, solve.iterations, solve.residual
                ));
                return Ok(Arrival::Nowhere);
            }
            self.tell_of_blind_spot(&solve);
            if !until_rest || self.rests()? {
                return Ok(Arrival::Resting);
            }
            start = self.layer.positions().to_vec();
        }
        self.warnings.push(format!(
            "still moving after {MOST_STEPS_TO_REST} steps in time at load {shown:.3}; longer ones may bring it to rest"
        ));
        Ok(Arrival::Moving)
    }

    /// Whether the layer is in equilibrium, a stable one as far as the method can tell.
    fn rests(&mut self) -> Result<bool, StepperError> {
        let settings = NewtonSettings {
            at_saddle: AtSaddle::Stop,
            max_iterations: 1,
            energy_tolerance: AT_REST,
            residual_tolerance: self.modelling.tolerance,
            ..NewtonSettings::default()
        };
        let state = self.layer.state();
        let how = (self.modelling.minimise, &settings);
        let solve = self.layer.minimise(how, &mut |_| true);
        let solve = solve.map_err(|source| self.solver_error(source))?;
        self.report.factorizations += solve.factorizations;
        self.layer.restore(&state)?;
        Ok(solve.converged)
    }

    fn climb(
        &mut self,
        course: &mut dyn Course,
        loads: &[f64],
        settings: LoadSettings,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let mut stepper =
            LoadStepper::new(loads, settings).map_err(|source| self.solver_error(source))?;
        // The first pattern is chosen with care.
        self.relaxation = 0.0;
        let mut kept = self.layer.state();
        let mut onset = None;
        while let Some(trial) = stepper.next_trial() {
            let sampled = {
                let mut preparing = Preparing::new(observer, self.index, Phase::Sampling);
                let (below, share) = course.below(self.layer.skin(), trial.load);
                self.layer.set_below(below, share)?;
                preparing.goes_on()
            };
            if !sampled {
                return Ok(Ending::Interrupted);
            }
            observer.phase(self.index, Phase::Integration);
            let shown = course.shown(trial.load);
            let at_saddle = if self.is_probe(trial) {
                AtSaddle::Stop
            } else {
                AtSaddle::Leave
            };
            let pace = if trial.probe || course.is_result(trial.load) {
                Pace::Result
            } else {
                Pace::Passing
            };
            let solve = self.solve((at_saddle, pace), shown, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Ending::Interrupted);
            }
            let outcome = self.outcome(trial, &solve);
            if trial.probe && outcome == Outcome::Buckled {
                onset = Some(shown);
            }
            match stepper.report(outcome) {
                Verdict::Keep => {
                    kept = self.layer.state();
                    self.tell_of_blind_spot(&solve);
                    if !trial.probe {
                        // Where it first wrinkled; another key's course may begin anew.
                        self.report.onset_load = self.report.onset_load.or(onset);
                    }
                    if !course.kept(self, trial.load, observer)? {
                        return Ok(Ending::Interrupted);
                    }
                }
                Verdict::Discard => self.layer.restore(&kept)?,
                Verdict::GiveUp => {
                    self.give_up(&kept, shown, &solve)?;
                    return Ok(Ending::GaveUp);
                }
            }
        }
        Ok(Ending::Reached)
    }

    /// Finds the equilibrium.
    fn solve(
        &mut self,
        how: (AtSaddle, Pace),
        shown: f64,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        self.solve_from(None, how, shown, observer)
    }

    /// Finds the equilibrium, or the end of a step in time from `start`.
    fn solve_from(
        &mut self,
        start: Option<&[Vector3<f64>]>,
        (at_saddle, pace): (AtSaddle, Pace),
        shown: f64,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        let settings = newton_settings(self.modelling, (at_saddle, pace), self.relaxation);
        let vertices = self.layer.vertex_count();
        let mut keep_going = |iteration: &ruga_solver::Iteration| {
            observer.progress(Progress {
                load: shown,
                iteration: iteration.index,
                vertices,
            })
        };
        let layer = &mut self.layer;
        let how = (self.modelling.minimise, &settings);
        let solve = match start {
            None => layer.minimise(how, &mut keep_going),
            Some(start) => layer.step_in_time(start, how, &mut keep_going),
        };
        let solve = solve.map_err(|source| self.solver_error(source))?;
        if solve.converged && solve.first_relaxation > 0.0 && self.layer.strain_ratio() > 1.0 {
            self.relaxation = solve.first_relaxation;
        }
        self.report.take(&solve);
        Ok(solve)
    }

    fn tell_of_blind_spot(&mut self, solve: &SolveReport) {
        if let Some(blind_spot) = blind_spot(solve)
            && self.layer.strain_ratio() > 1.0
        {
            self.warn(blind_spot.to_owned());
        }
    }

    fn give_up(
        &mut self,
        kept: &LayerState,
        shown: f64,
        solve: &SolveReport,
    ) -> Result<(), StepperError> {
        self.layer.restore(kept)?;
        self.warnings.push(format!(
            "no equilibrium found at load {shown:.3} ({:?} after {} iterations, relative residual {:.1e})",
            solve.stop, solve.iterations, solve.residual
        ));
        Ok(())
    }

    /// Notes where the layer was to wrinkle and has not.
    pub(crate) fn warn_unwrinkled(&mut self, driver: &Driver) {
        for warning in self.layer.unwrinkled(driver) {
            self.warn(warning);
        }
    }

    /// Measures the layer as it is now.
    pub(crate) fn measure(&mut self) {
        let layer = &self.layer;
        self.report.energy = layer.energy();
        self.report.bending_ratio = layer.bending_ratio;
        let faces = layer.strain_ratios().supercritical_faces();
        let heights = layer.heights();
        let on = (heights.as_slice(), layer.skin().rest.positions.as_slice());
        let thickness = layer.spec.material.thickness;
        self.report.measure(on, &faces, thickness);
    }

    /// The report of the layer that moves together with this one, over what was `planned` of it.
    /// Energy and work of both stand with this one.
    pub(crate) fn upper_report(&self, upper: &UpperShell, planned: &LayerReport) -> LayerReport {
        let layer = &self.layer;
        let heights = layer.upper_heights();
        let on = (heights.as_slice(), layer.skin().rest.positions.as_slice());
        let faces = layer.strain_ratios().supercritical_faces();
        let mut report = LayerReport {
            vertices: self.report.vertices,
            faces: self.report.faces,
            residual: self.report.residual,
            stop: self.report.stop,
            onset_load: self.report.onset_load,
            ..planned.clone()
        };
        report.measure(on, &faces, upper.thickness());
        report
    }

    /// Whether a saddle at this load would be the onset of wrinkling: below the critical strain
    /// it is the noise of a detail finer than the layer is thick.
    fn is_probe(&self, trial: Trial) -> bool {
        trial.probe && self.layer.strain_ratio() > LEAST_RATIO
    }

    fn outcome(&self, trial: Trial, solve: &SolveReport) -> Outcome {
        let left_saddle = solve.left_saddle && (!trial.probe || self.is_probe(trial));
        if solve.stop == StopRule::Saddle || (left_saddle && solve.converged) {
            Outcome::Buckled
        } else if solve.converged {
            Outcome::Stable
        } else {
            Outcome::Failed
        }
    }

    fn solver_error(&self, source: SolverError) -> StepperError {
        StepperError::Solver {
            layer: self.layer.spec.name.clone(),
            source,
        }
    }
}
