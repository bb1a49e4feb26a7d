//! The run of one layer along its load path, its report and its warnings.

mod in_time;
mod loading;
mod reach;
mod solving;
pub(crate) mod warnings;

use ruga_solver::{
    AtSaddle, Kkt, LoadSettings, LoadStepper, Outcome, SolveReport, SolverError, StopRule, Trial,
    Verdict,
};

use crate::preparing::Preparing;
use crate::run::layer::{Layer, LayerState, LayerView, Output};
use crate::run::patches::{Patches, Width};
use crate::skin::upper_shell::UpperShell;
use crate::support::motion::Inertia;
use crate::{LayerPlan, LayerReport, Modelling, Observer, Phase, StepperError};

pub(crate) use loading::{Ending, Loading, loads_up_to};

/// Fraction of the critical strain below which nothing can wrinkle.
pub(crate) const LEAST_RATIO: f64 = 0.9;

/// Newton decrement, in energy scales, at which a state is a result. Where a pattern is held fast
/// the last step, which is taken, leaves a square of it; on a whole forehead some defect always
/// slides a little further, for hundreds of iterations, while the energy changes by a thousandth.
const RESULT_DECREMENT: f64 = 3e-5;

/// Newton decrement, in energy scales, at which a state that is only passed is good enough. What
/// is left then is the pattern sliding along itself, and the next load moves it anyway.
const PASSING_DECREMENT: f64 = 1e-3;

/// Lag of the energy behind the surface below up to which a result stands, in rad or as a change of rest
/// lengths: a layer that is a tenth of a wavelength off then moves by a ten-thousandth of one.
const LAG: f64 = 1e-3;

/// Solves after which a body that still gives way under its layer is taken as it is.
const MOST_SOLVES: usize = 4;

/// The convexification that a solve is tried with first, over what the last one needed: lets it shrink.
pub(crate) const SLOWLY_LESS: f64 = 0.97;

/// Accuracy that a state needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Accuracy {
    /// Exact enough to decide something, or to be given to the user.
    Result,
    /// Exact enough to start the next solve from.
    Passing,
}

/// A layer with its factorisation and its report.
pub(crate) struct LayerRun<'a> {
    pub(crate) modelling: &'a Modelling,
    /// Number of the layer in its stack.
    pub(crate) index: usize,
    /// Mesh points per wavelength that are asked for; on a coarse mesh those of the fine one.
    points: f64,
    pub(crate) layer: Layer,
    /// Factorisation of the whole layer, once it was needed.
    kkt: Option<Kkt>,
    /// Narrow patches of the layer, once it has wrinkles and where it is solved in some.
    patches: Option<Patches>,
    /// Wide ones of a layer that is too large for a factorisation of the whole, once they were needed.
    wide: Option<Patches>,
    pub(crate) report: LayerReport,
    /// Convexification of the first step of the last solve that began with a pattern.
    relaxation: f64,
    /// Warnings, without the layer's name.
    pub(crate) warnings: Vec<String>,
    /// Whether a result on a body is not as exact as it should be.
    pub(crate) is_rough: bool,
    /// Steps in time that had to be halved.
    halved: usize,
    /// Whether a run on a finer mesh goes on from what this one finds, so that nothing of it is a result.
    pub(crate) is_coarse: bool,
}

impl<'a> LayerRun<'a> {
    pub(crate) fn new(
        index: usize,
        layer: Layer,
        planned: &LayerPlan,
        (modelling, points): (&'a Modelling, f64),
    ) -> Self {
        let report = LayerReport {
            vertices: layer.vertex_count(),
            faces: layer.face_count(),
            constraints: layer.row_count(),
            ..LayerReport::planned(planned)
        };
        Self {
            modelling,
            index,
            points,
            report,
            kkt: None,
            patches: None,
            wide: None,
            relaxation: 0.0,
            warnings: layer.row_warning.iter().cloned().collect(),
            layer,
            is_rough: false,
            halved: 0,
            is_coarse: false,
        }
    }

    /// What others see of a layer that is solved no further, and what it is shown by; what solves it is forgotten.
    pub(crate) fn into_view(self) -> (LayerView<'static>, Output) {
        self.layer.into_view()
    }

    /// Counts in what an earlier run of the same layer has done.
    pub(crate) fn take_history(&mut self, before: LayerRun<'_>) {
        self.report.newton_iterations += before.report.newton_iterations;
        self.report.factorizations += before.report.factorizations;
        self.report.onset_load = self.report.onset_load.or(before.report.onset_load);
        // The pattern is carried over, so that it needs about the same on the new mesh.
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
    pub(crate) fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Takes the layer through every one of `loads`, a fraction `1 / steps` of the way apart: from
    /// equilibrium to equilibrium, and in between where it begins to wrinkle, or in time.
    pub(crate) fn follow(
        &mut self,
        loading: &mut dyn Loading,
        (loads, steps): (&[f64], u32),
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        match self.modelling.dynamics {
            None => self.climb(loading, loads, observer),
            Some(dynamics) => self.move_in_time(loading, (loads, steps), dynamics, observer),
        }
    }

    fn climb(
        &mut self,
        loading: &mut dyn Loading,
        loads: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        // Onsets are looked for on the whole of a layer.
        (self.patches, self.wide) = (None, None);
        let mut stepper = LoadStepper::new(loads, LoadSettings::default())
            .map_err(|source| self.solver_error(source))?;
        // The first pattern is chosen with care.
        self.relaxation = 0.0;
        // Every trial begins from the last state that was kept. A pattern that was made above the
        // onset, in a trial that is thrown away, would fix the wavelength for the next one.
        let mut kept = self.layer.state();
        let mut onset = None;
        while let Some(trial) = stepper.next_trial() {
            let solve = self.try_load(loading, trial, observer)?;
            let Some(solve) = solve.filter(|solve| solve.stop != StopRule::Interrupted) else {
                return Ok(Ending::Interrupted);
            };
            let pose_fraction = loading.pose_fraction(trial.load);
            let outcome = self.outcome(trial, &kept, &solve);
            if trial.probe && outcome == Outcome::Buckled {
                onset = Some(pose_fraction);
            }
            match stepper.report(outcome) {
                Verdict::Keep => {
                    // A probe is as exact as a result already.
                    let is_polished = trial.probe && self.layer.lag() <= LAG;
                    let is_wanted = loading.is_result(trial.load) && !is_polished;
                    if !is_wanted || self.layer.solid().is_none() {
                        self.warn_unverified(&solve);
                    } else if self.polish(None, pose_fraction, observer)?.stop
                        == StopRule::Interrupted
                    {
                        return Ok(Ending::Interrupted);
                    }
                    kept = self.layer.state();
                    if !trial.probe {
                        // Where it first wrinkled; another key may begin anew.
                        self.report.onset_load = self.report.onset_load.or(onset);
                    }
                    if !loading.kept(self, trial.load, observer)? {
                        return Ok(Ending::Interrupted);
                    }
                }
                Verdict::Discard => self.layer.restore(&kept)?,
                Verdict::GiveUp => {
                    self.warn_of_failure("no equilibrium found", pose_fraction, &solve);
                    self.layer.restore(&kept)?;
                    return Ok(Ending::GaveUp);
                }
            }
        }
        Ok(Ending::Reached)
    }

    /// Looks for the equilibrium at a load; `None` when the observer ends the work.
    fn try_load(
        &mut self,
        loading: &dyn Loading,
        trial: Trial,
        observer: &mut dyn Observer,
    ) -> Result<Option<SolveReport>, StepperError> {
        if !self.place(loading, trial.load, observer)? {
            return Ok(None);
        }
        let pose_fraction = loading.pose_fraction(trial.load);
        // On a body that moves a result is polished later, once it is known where the body is.
        let is_exact = loading.is_result(trial.load) && self.layer.solid().is_none();
        let accuracy = match trial.probe || is_exact {
            true => Accuracy::Result,
            false => Accuracy::Passing,
        };
        let at_saddle = match self.is_probe(trial) {
            true => AtSaddle::Stop,
            false => AtSaddle::Leave,
        };
        let solve = self.solve(None, (at_saddle, accuracy), pose_fraction, observer)?;
        if solve.stop == StopRule::Saddle && !self.is_probe(trial) {
            // Nothing wrinkles where the body has gone: what gives way is the body, or a noise of the
            // mesh.
            let how = (AtSaddle::Leave, accuracy);
            return self.solve(None, how, pose_fraction, observer).map(Some);
        }
        Ok(Some(solve))
    }

    /// Moves the surface below to where it is at `load`; false when the observer ends the work.
    fn place(
        &mut self,
        loading: &dyn Loading,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let mut preparing = Preparing::new(observer, self.index, Phase::Sampling);
        loading.place(&mut self.layer, load, None)?;
        if !preparing.goes_on() {
            return Ok(false);
        }
        observer.phase(self.index, Phase::Integration);
        Ok(true)
    }

    /// Makes a result of a state on a body: on the way there the surface below has turned and shrunk, and
    /// the layer's energy stands on it. Returns the last solve.
    fn polish(
        &mut self,
        inertia: Option<&Inertia>,
        pose_fraction: f64,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        let how = (AtSaddle::Leave, Accuracy::Result);
        let mut solves = 0;
        loop {
            let before = self.layer.state();
            let solve = self.solve(inertia, how, pose_fraction, observer)?;
            solves += 1;
            if solve.stop == StopRule::Interrupted {
                return Ok(solve);
            }
            // The state before is an equilibrium, only less exact, and better than none.
            if !solve.converged || self.layer.has_passed(&before) {
                self.warn_of_failure("only a rough equilibrium found", pose_fraction, &solve);
                self.layer.restore(&before)?;
                self.is_rough = true;
                return Ok(solve);
            }
            if self.layer.lag() <= LAG || solves == MOST_SOLVES {
                self.warn_unverified(&solve);
                self.warn_of_lag(self.layer.lag(), pose_fraction);
                return Ok(solve);
            }
        }
    }

    /// Patches of the layer, where it is large enough for such ones.
    fn patches_of(&self, width: Width) -> Option<Patches> {
        let most_in_whole = self.modelling.most_in_whole(self.points);
        let others = self.wide.as_ref().or(self.patches.as_ref());
        self.layer
            .patches((self.points, most_in_whole), width, others)
    }

    /// Gives back matrix and factor of the whole and what narrow patches are set up with, which the next solve makes
    /// anew. Wide patches keep nothing.
    fn release(&mut self) {
        self.layer.release_pattern();
        if let Some(kkt) = &mut self.kkt {
            kkt.release();
        }
        if let Some(patches) = &mut self.patches {
            patches.release();
        }
    }

    /// Measures the layer as it is now.
    pub(crate) fn measure(&mut self) {
        let layer = &self.layer;
        self.report.energy = layer.energy();
        self.report.bending_ratio = layer.bending_ratio;
        // Only faces that wrinkle count: over all of them the amplitude would depend on how wide a
        // margin the region has.
        let faces = layer.strain_ratios().supercritical_faces();
        let heights = layer.heights();
        let on = (heights.as_slice(), layer.skin().rest.positions.as_slice());
        let thickness = layer.spec.material.thickness;
        self.report.measure(on, &faces, thickness);
        self.report.left_out = layer.left_out();
        self.report.creases = layer.crease_reports();
        self.warn_of_runaway_creases();
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

    fn outcome(&self, trial: Trial, kept: &LayerState, solve: &SolveReport) -> Outcome {
        // Below the critical strain what gave way is no wrinkle, so that the onset is not looked
        // for there.
        let left_saddle = solve.left_saddle && (!trial.probe || self.is_probe(trial));
        if solve.stop == StopRule::Saddle {
            Outcome::Buckled
        } else if !solve.converged || self.layer.has_passed(kept) {
            Outcome::Failed
        } else if left_saddle {
            Outcome::Buckled
        } else {
            Outcome::Stable
        }
    }

    fn solver_error(&self, source: SolverError) -> StepperError {
        StepperError::Solver {
            layer: self.layer.spec.name.clone(),
            source,
        }
    }
}

/// The factorisation of the whole of a `layer`, analysed when it is needed first.
fn whole_kkt<'k>(kkt: &'k mut Option<Kkt>, layer: &Layer) -> Result<&'k mut Kkt, StepperError> {
    let analysed = match kkt.take() {
        Some(analysed) => analysed,
        None => {
            // A node of a lattice touches hundreds of vertices. Dissecting the graph with all nodes in it
            // is still better than to eliminate them last: by a tenth at six cells along a side, by a
            // third at ten.
            let (pattern, rows) = layer.system();
            Kkt::new(pattern, rows, 3).map_err(|source| StepperError::Solver {
                layer: layer.spec.name.clone(),
                source,
            })?
        }
    };
    Ok(kkt.insert(analysed))
}
