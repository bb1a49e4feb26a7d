//! A body on its way through a pose, and what is told of it.

use ruga_material::CAP_START;
use ruga_solver::{
    AtSaddle, LoadSettings, LoadStepper, NewtonSettings, Outcome, SolveReport, StopRule, Trial,
    Verdict,
};

use super::embedded_layer::{BodyState, EmbeddedLayer};
use super::handles::Moves;
use super::plan::Interior;
use crate::error::Halt;
use crate::layer_run::{Ending, LEAST_RATIO, Pace, blind_spot, newton_settings};
use crate::motion::Inertia;
use crate::preparing::Preparing;
use crate::simulate::loads_up_to;
use crate::{
    Dynamics, Frame, KeyResult, LayerReport, Modelling, Observer, Phase, Plan, PoseResult,
    PoseSpec, Progress, StepperError,
};

/// Angle in rad by which the surface below may have turned since a result whose foundation stands on
/// its normals: a layer that is a tenth of a wavelength off then moves by a ten-thousandth of one.
const TURNED: f64 = 1e-3;

/// Halvings of a step in time before it counts as impossible.
const HALVINGS: u32 = 4;

/// A pose under way.
pub(crate) struct BodyRun<'a> {
    pose: &'a PoseSpec,
    modelling: &'a Modelling,
    moves: Moves<'a>,
    pub(crate) layer: EmbeddedLayer<'a>,
    report: LayerReport,
    result: PoseResult,
    /// What had to be left out of the first step of the last solve that began with a pattern.
    relaxation: f64,
    /// Steps in time that had to be halved.
    halved: usize,
    /// What the last solve leaves open.
    blind_spot: Option<&'static str>,
}

/// How exactly a trial is solved: a probe decides.
fn pace_of(trial: Trial) -> Pace {
    match trial.probe {
        true => Pace::Result,
        false => Pace::Passing,
    }
}

impl<'a> BodyRun<'a> {
    /// Builds the body and its layer for pose number `pose`, at rest.
    pub(crate) fn new(
        (plan, interior): (&'a Plan, &'a Interior),
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, Halt> {
        let mut preparing = Preparing::new(observer, 0, Phase::Remeshing);
        let spec = &plan.specs[pose];
        let moves = Moves::new(&interior.body, spec)?;
        let mut layer = EmbeddedLayer::new((plan, interior), pose, &mut preparing)?;
        layer.state.obstacles = moves.obstacles(0.0);
        let planned = plan.reports(pose).into_iter().next();
        let report = LayerReport {
            vertices: layer.skin.mesh.vertex_count(),
            faces: layer.skin.mesh.face_count(),
            constraints: layer.system.rows.count() / 3,
            ..planned.unwrap_or_default()
        };
        let row_warning = layer.system.row_warning.clone();
        let mut run = Self {
            pose: spec,
            modelling: &plan.modelling,
            moves,
            layer,
            report,
            result: PoseResult {
                converged: true,
                ..PoseResult::default()
            },
            relaxation: 0.0,
            halved: 0,
            blind_spot: None,
        };
        if let Some(warning) = row_warning {
            run.warn(warning);
        }
        Ok(run)
    }

    pub(crate) fn follow(&mut self, observer: &mut dyn Observer) -> Result<(), StepperError> {
        let keys = || self.pose.keys.iter().copied();
        // Beyond the last key nothing is asked for.
        let last = keys().fold(0.0, f64::max);
        let keyframes = self.moves.keyframes().filter(|&at| at < last);
        let loads = loads_up_to(last, self.pose.steps, keys().chain(keyframes));
        let ending = match self.modelling.dynamics {
            None => self.climb(&loads, observer)?,
            Some(dynamics) => self.move_in_time(&loads, dynamics, observer)?,
        };
        self.result.converged &= ending == Ending::Reached;
        self.result.interrupted |= ending == Ending::Interrupted;
        if self.halved > 0 {
            self.warn(format!("steps in time that were halved: {}", self.halved));
        }
        self.measure();
        Ok(())
    }

    pub(crate) fn into_result(mut self) -> PoseResult {
        self.result.layers = vec![self.report];
        self.result
    }

    /// From equilibrium to equilibrium.
    fn climb(
        &mut self,
        loads: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let stepper = LoadStepper::new(loads, LoadSettings::default());
        let mut stepper = stepper.map_err(|source| self.layer.solver_error(source))?;
        let mut kept = self.layer.state.clone();
        let mut onset = None;
        while let Some(trial) = stepper.next_trial() {
            let (outcome, solve) = self.trial(trial, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Ending::Interrupted);
            }
            if trial.probe && outcome == Outcome::Buckled {
                onset = Some(trial.load);
            }
            match stepper.report(outcome) {
                Verdict::Keep => {
                    if !trial.probe {
                        self.report.onset_load = self.report.onset_load.or(onset);
                    }
                    if !self.settle(pace_of(trial), None, trial.load, observer)? {
                        return Ok(Ending::Interrupted);
                    }
                    kept = self.layer.state.clone();
                    self.frame(trial.load, observer);
                }
                Verdict::Discard => self.layer.state.clone_from(&kept),
                Verdict::GiveUp => {
                    self.layer.state.clone_from(&kept);
                    self.tell_of_failure("no equilibrium found", trial.load, &solve);
                    return Ok(Ending::GaveUp);
                }
            }
        }
        Ok(Ending::Reached)
    }

    /// Looks for the equilibrium at a load.
    fn trial(
        &mut self,
        trial: Trial,
        observer: &mut dyn Observer,
    ) -> Result<(Outcome, SolveReport), StepperError> {
        let before = self.layer.state.clone();
        observer.phase(0, Phase::Sampling);
        let weights = &self.pose.weights;
        self.layer.place((&self.moves, weights), trial.load)?;
        observer.phase(0, Phase::Integration);
        let at_saddle = match trial.probe {
            true => AtSaddle::Stop,
            false => AtSaddle::Leave,
        };
        let pace = pace_of(trial);
        let mut solve = self.solve(None, (at_saddle, pace), trial.load, observer)?;
        if solve.stop == StopRule::Saddle && self.layer.strain_ratio() < LEAST_RATIO {
            // Nothing wrinkles yet: what gives way is the body, or a noise of the mesh.
            solve = self.solve(None, (AtSaddle::Leave, pace), trial.load, observer)?;
        }
        let may_wrinkle = !trial.probe || self.layer.strain_ratio() > LEAST_RATIO;
        let left_saddle = solve.left_saddle && may_wrinkle;
        let outcome = if solve.stop == StopRule::Saddle {
            Outcome::Buckled
        } else if !solve.converged || self.layer.has_passed(&before) {
            Outcome::Failed
        } else if left_saddle {
            Outcome::Buckled
        } else {
            Outcome::Stable
        };
        Ok((outcome, solve))
    }

    /// Makes a result of what has been reached at this pace, if one is wanted: on the way there the
    /// surface below has turned, and the foundation stands on its normals. False when interrupted.
    fn settle(
        &mut self,
        pace: Pace,
        inertia: Option<&Inertia>,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let is_one = pace == Pace::Result && self.layer.turned() <= TURNED;
        if !self.is_result(load, observer) || is_one {
            return Ok(true);
        }
        let before = self.layer.state.clone();
        let how = (AtSaddle::Leave, Pace::Result);
        let solve = self.solve(inertia.cloned(), how, load, observer)?;
        if solve.stop == StopRule::Interrupted {
            return Ok(false);
        }
        if !solve.converged || self.layer.has_passed(&before) {
            self.layer.state = before;
            self.result.converged = false;
            self.tell_of_failure("only a rough equilibrium found", load, &solve);
        }
        Ok(true)
    }

    /// One step in time per load, shorter where a key or a keyframe lies between two.
    fn move_in_time(
        &mut self,
        loads: &[f64],
        dynamics: Dynamics,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let mut from = 0.0;
        for &load in loads {
            let before = self.layer.state.clone();
            let share = f64::from(self.pose.steps) * (load - from);
            // A share of nearly one is one: the Hessian of inertia and springs, which depends on the
            // time step, is then kept from one step to the next.
            let dynamics = match (share - 1.0).abs() < 1e-9 {
                true => dynamics,
                false => Dynamics {
                    time_step: share * dynamics.time_step,
                    ..dynamics
                },
            };
            match self.step([from, load], dynamics, HALVINGS, observer)? {
                Ending::Reached => self.frame(load, observer),
                ending => {
                    self.layer.state = before;
                    return Ok(ending);
                }
            }
            from = load;
        }
        Ok(Ending::Reached)
    }

    /// One step in time between two loads, in halves where it cannot be made at once.
    fn step(
        &mut self,
        [from, to]: [f64; 2],
        dynamics: Dynamics,
        halvings: u32,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let before = self.layer.state.clone();
        let solve = self.step_at_once(&before, to, dynamics, observer)?;
        if solve.stop == StopRule::Interrupted {
            return Ok(Ending::Interrupted);
        }
        if solve.converged && !self.layer.has_passed(&before) {
            return Ok(Ending::Reached);
        }
        self.layer.state = before;
        if halvings == 0 {
            self.tell_of_failure("no step in time found", to, &solve);
            return Ok(Ending::GaveUp);
        }
        self.halved += 1;
        let half = Dynamics {
            time_step: 0.5 * dynamics.time_step,
            ..dynamics
        };
        let middle = 0.5 * (from + to);
        match self.step([from, middle], half, halvings - 1, observer)? {
            Ending::Reached => self.step([middle, to], half, halvings - 1, observer),
            ending => Ok(ending),
        }
    }

    fn step_at_once(
        &mut self,
        before: &BodyState,
        to: f64,
        dynamics: Dynamics,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        observer.phase(0, Phase::Sampling);
        let weights = &self.pose.weights;
        let around = (&self.moves, weights);
        let inertia = self.layer.place_in_time(around, to, dynamics);
        observer.phase(0, Phase::Integration);
        // What a step leaves out of balance the next one inherits: without a second solve it has to be
        // a result at once.
        let pace = match self.is_result(to, observer) {
            true => Pace::Passing,
            false => Pace::Result,
        };
        let how = (AtSaddle::Leave, pace);
        let mut solve = self.solve(Some(inertia.clone()), how, to, observer)?;
        if solve.converged && !self.settle(pace, Some(&inertia), to, observer)? {
            solve.stop = StopRule::Interrupted;
        }
        self.layer.take_velocities(before, dynamics.time_step);
        Ok(solve)
    }

    fn solve(
        &mut self,
        inertia: Option<Inertia>,
        (at_saddle, pace): (AtSaddle, Pace),
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        let settings = NewtonSettings {
            overshoot: self.layer.is_touched(),
            ..newton_settings(self.modelling, (at_saddle, pace), self.relaxation)
        };
        let vertices = self.report.vertices;
        let mut keep_going = |iteration: &ruga_solver::Iteration| {
            observer.progress(Progress {
                load,
                iteration: iteration.index,
                vertices,
            })
        };
        let how = (self.modelling.minimise, &settings);
        let solve = self.layer.minimise(inertia, how, &mut keep_going);
        let solve = solve.map_err(|source| self.layer.solver_error(source))?;
        if solve.converged && solve.first_relaxation > 0.0 {
            self.relaxation = solve.first_relaxation;
        }
        self.blind_spot = blind_spot(&solve);
        self.report.take(&solve);
        Ok(solve)
    }

    fn tell_of_blind_spot(&mut self) {
        if let Some(blind_spot) = self.blind_spot
            && self.layer.strain_ratio() > 1.0
        {
            self.warn(blind_spot.to_owned());
        }
    }

    fn is_result(&self, load: f64, observer: &dyn Observer) -> bool {
        observer.wants_frames() || self.pose.has_key(load)
    }

    /// Hands out what was reached.
    fn frame(&mut self, load: f64, observer: &mut dyn Observer) {
        self.tell_of_blind_spot();
        if self.is_result(load, observer) {
            let layers = vec![self.layer.snapshot()];
            observer.frame(&Frame {
                index: self.result.frames,
                load,
                layers: &layers,
            });
            if self.pose.has_key(load) {
                self.result.keys.push(KeyResult {
                    load,
                    layers,
                    artist_positions: Some(self.layer.artist_positions()),
                });
            }
        }
        self.result.frames += 1;
    }

    fn tell_of_failure(&mut self, what: &str, load: f64, solve: &SolveReport) {
        let why = match solve.converged {
            true => "a vertex passed through an obstacle".to_owned(),
            false => format!(
                "{:?} after {} iterations, relative residual {:.1e}",
                solve.stop, solve.iterations, solve.residual
            ),
        };
        self.warn(format!("{what} at load {load:.3} ({why})"));
    }

    fn warn(&mut self, warning: String) {
        let (pose, layer) = (&self.pose.name, &self.report.name);
        self.result.warn(pose, layer, &warning);
    }

    fn measure(&mut self) {
        let layer = &self.layer;
        self.report.energy = layer.energy();
        let heights = layer.heights();
        let on = (heights.as_slice(), layer.skin.rest.positions.as_slice());
        self.report
            .measure(on, &layer.supercritical_faces(), layer.thickness());
        let strains = layer.strains();
        let capped = strains.iter().filter(|(_, s)| s.first > CAP_START).count();
        let percent = 100.0 * capped as f64 / strains.len().max(1) as f64;
        if percent >= 1.0 {
            self.warn(format!(
                "{percent:.0} % of the layer are compressed beyond 15 %, where skin folds, doubles its wrinkles or creases, which is not modelled"
            ));
        }
        let depth = self.layer.penetration() / self.layer.thickness();
        if depth > 0.1 {
            self.warn(format!(
                "the layer is {depth:.1} of its thickness inside an obstacle"
            ));
        }
    }
}
