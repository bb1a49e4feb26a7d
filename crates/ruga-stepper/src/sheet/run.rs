//! One pose of a sheet from rest to its keys.

#[cfg(test)]
mod momentum;
#[cfg(test)]
mod remeshing;
#[cfg(test)]
mod test_fires;

use std::collections::BTreeSet;

use ruga_mesh::{FaceId, intersecting_pairs};
use ruga_shell::MAX_NATURAL_ANGLE;
use ruga_solver::{NewtonSettings, SolveReport, StopRule};

use super::Sheet;
use super::state::{Moving, SheetState};
use crate::error::Halt;
use crate::preparing::Preparing;
use crate::run::layer_run::loads_up_to;
use crate::run::layer_run::warnings::why_stopped;
use crate::run::layer_run::{Ending, SLOWLY_LESS};
use crate::skin::skin_mesh::RegionMesh;
use crate::support::Moves;
use crate::{
    Dynamics, FireReport, Frame, KeyResult, LayerReport, Observer, Phase, Plan, PoseResult,
    PoseSpec, Progress, StepperError,
};

/// Newton decrement of a result, and of a state that is only passed, in the sheet's energy scale. With 1e-6 a strip that
/// curls as it burns ends 3 % too high; with 1e-7 within 0.1 %.
const RESULT: f64 = 1e-7;
const PASSING: f64 = 1e-4;

/// Parts of a time step that its divisions are counted in, a power of two: of the same share of a pose they have the same
/// length to the last bit, and the matrix of the heat stays the same.
const PARTS: f64 = 1_048_576.0;

/// Iterations of one solve: a disc that rolls up turns its axis slowly.
const MOST_ITERATIONS: usize = 300;

/// Halvings of a step before it counts as impossible.
const HALVINGS: u32 = 6;

/// Share of the faces with a curl that edges cannot show from which on it is told.
const CAPPED: f64 = 0.05;

impl Plan {
    /// Simulates pose number `pose` of a sheet.
    pub(crate) fn simulate_sheet(
        &self,
        sheet: &Sheet,
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<PoseResult, StepperError> {
        let mut result = PoseResult {
            layers: self.reports(pose),
            converged: true,
            ..PoseResult::default()
        };
        let made = self.sheet_state(sheet, pose, observer);
        let Some(state) = Halt::unless_interrupted(made)? else {
            result.converged = false;
            result.interrupted = true;
            return Ok(result);
        };
        let mut run = SheetRun::new(self, (sheet, pose), state, result)?;
        let name = |line: usize| format!("crease '{}'", run.state.spec.creases[line].name);
        let shared = run.state.region.shared.iter();
        let shared: Vec<String> = shared.map(|warning| warning.told(&name)).collect();
        shared.iter().for_each(|warning| run.warn(warning));
        let ending = run.follow(observer)?;
        Ok(run.finished(ending))
    }

    fn sheet_state<'a>(
        &'a self,
        sheet: &'a Sheet,
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<SheetState<'a>, Halt> {
        let mut preparing = Preparing::new(observer, 0, Phase::Sampling);
        let layer = &self.poses[pose].layers[0];
        let (piece, _) =
            preparing.while_wanted(|goes_on| self.layer_pieces((layer, false, 1.0), goes_on))?;
        let on = (piece, self.modelling.smoothing, 0.0);
        let spec = &self.stacking.specs[0];
        let region = RegionMesh::new(&self.driver, spec, on, &mut || preparing.goes_on())?;
        preparing.step()?;
        let on = (spec, sheet);
        let state = SheetState::new(&self.driver, on, region, &self.modelling, &mut || {
            preparing.goes_on()
        })?;
        preparing.step()?;
        Ok(state)
    }
}

/// Simulation of one pose of a sheet, with what it has found so far.
struct SheetRun<'a> {
    plan: &'a Plan,
    pose: &'a PoseSpec,
    moves: Moves<'a>,
    state: SheetState<'a>,
    report: LayerReport,
    result: PoseResult,
    /// Steps that were divided.
    divided: usize,
    /// Meshes that were taken during the pose, after the first, and whether there can be no more.
    remeshed: usize,
    stays: bool,
    /// Solves of all steps, whole and divided.
    solves: usize,
    /// Triangles that cross others at fractions of the pose, where some do.
    crossing: Vec<(usize, f64)>,
    /// Fraction of the pose to which it has been solved.
    reached: f64,
    /// Share of the compressive stress stiffness that the last step left out at first.
    relaxation: f64,
}

impl<'a> SheetRun<'a> {
    fn new(
        plan: &'a Plan,
        (sheet, pose): (&'a Sheet, usize),
        state: SheetState<'a>,
        result: PoseResult,
    ) -> Result<Self, StepperError> {
        let spec = &plan.specs[pose];
        let report = LayerReport {
            vertices: state.vertex_count(),
            faces: state.meshed.skin.mesh.face_count(),
            ..result.layers[0].clone()
        };
        Ok(Self {
            plan,
            pose: spec,
            moves: sheet.moves(spec)?,
            state,
            report,
            result,
            divided: 0,
            remeshed: 0,
            stays: false,
            solves: 0,
            crossing: Vec::new(),
            reached: 0.0,
            relaxation: 0.0,
        })
    }

    fn follow(&mut self, observer: &mut dyn Observer) -> Result<Ending, StepperError> {
        let last = self.pose.keys.iter().copied().fold(0.0, f64::max);
        // Between keyframes motions are linear. A step across one would cut the corner.
        let keyframes = self.moves.keyframes().filter(|&at| at < last);
        let keys = self.pose.keys.iter().copied();
        let loads = loads_up_to(last, self.pose.steps, keys.chain(keyframes));
        let mut from = 0.0;
        for load in loads {
            let solves = self.solves;
            match self.refit([from, load], observer)? {
                Ending::Reached => {}
                ending => return Ok(ending),
            }
            match self.step([from, load], HALVINGS, observer)? {
                Ending::Reached => {}
                ending => return Ok(ending),
            }
            if self.solves > solves + 1 {
                self.divided += 1;
            }
            self.frame(load, observer)?;
            from = load;
        }
        Ok(Ending::Reached)
    }

    /// Takes another mesh where this one is too coarse for what burns between two fractions of the pose.
    fn refit(
        &mut self,
        times: [f64; 2],
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        if self.stays {
            return Ok(Ending::Reached);
        }
        let Some(zones) = self.state.too_coarse(&self.moves, times) else {
            return Ok(Ending::Reached);
        };
        let mut preparing = Preparing::new(observer, 0, Phase::Remeshing);
        let driver = &self.plan.driver;
        match self
            .state
            .refit(driver, &zones, &mut || preparing.goes_on())
        {
            Ok(()) => {}
            Err(Halt::Interrupted) => return Ok(Ending::Interrupted),
            Err(Halt::Failed(StepperError::Remesh { source, .. })) => {
                self.stays = true;
                self.warn(&format!(
                    "from {:.1} % of the pose on its mesh does not follow the fire, because no finer one could be made ({source}); give `[sheet]` an `edge` of about half the width of the front",
                    100.0 * times[0]
                ));
                return Ok(Ending::Reached);
            }
            Err(Halt::Failed(error)) => return Err(error),
        }
        self.remeshed += 1;
        self.report.vertices = self.report.vertices.max(self.state.vertex_count());
        let faces = self.state.meshed.skin.mesh.face_count();
        self.report.faces = self.report.faces.max(faces);
        Ok(Ending::Reached)
    }

    /// The dynamics of a step between two fractions of the pose, which takes its share of the time.
    fn dynamics(&self, [from, to]: [f64; 2]) -> Option<Dynamics> {
        let dynamics = self.plan.modelling.dynamics?;
        let steps = f64::from(self.pose.steps) * (to - from);
        // Keys may be closer to each other than that.
        let steps = (steps * PARTS).round().max(1.0) / PARTS;
        Some(Dynamics {
            time_step: steps * dynamics.time_step,
            ..dynamics
        })
    }

    /// One step between two fractions of the pose, in halves where it cannot be made at once.
    fn step(
        &mut self,
        [from, to]: [f64; 2],
        halvings: u32,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let before = self.state.moving.clone();
        let solve = self.step_at_once([from, to], &before, observer)?;
        if solve.stop == StopRule::Interrupted {
            return Ok(Ending::Interrupted);
        }
        if solve.converged && !self.state.has_passed(&before) {
            self.reached = to;
            // A step that fails leaves masses and pieces of its own behind.
            let remeshed = self.remeshed;
            let fire = self.state.fire_report();
            self.report.fire = fire.map(|fire| FireReport { remeshed, ..fire });
            return Ok(Ending::Reached);
        }
        self.state.moving = before;
        if halvings == 0 {
            self.warn(&format!(
                "no way on was found at {:.1} % of the pose, and it ends there: {}; take more `steps`, {}",
                100.0 * from,
                why_stopped(solve.stop, (solve.iterations, solve.residual)),
                match self.state.fire() {
                    Some(_) => "shorter time steps, or a shorter `edge`",
                    None => "a shorter `edge` or motion in time",
                }
            ));
            return Ok(Ending::GaveUp);
        }
        let middle = 0.5 * (from + to);
        match self.step([from, middle], halvings - 1, observer)? {
            Ending::Reached => self.step([middle, to], halvings - 1, observer),
            ending => Ok(ending),
        }
    }

    fn step_at_once(
        &mut self,
        [from, to]: [f64; 2],
        before: &Moving,
        observer: &mut dyn Observer,
    ) -> Result<SolveReport, StepperError> {
        observer.phase(0, Phase::Sampling);
        let dynamics = self.dynamics([from, to]);
        let inertia = dynamics.map(|dynamics| self.state.inertia(dynamics));
        let around = (self.pose, &self.moves);
        let driver = &self.plan.driver;
        let times = [from, to];
        self.state.place(driver, around, times, inertia.as_ref())?;
        observer.phase(0, Phase::Integration);
        let modelling = &self.plan.modelling;
        // What a step in time leaves out of balance the next one inherits.
        let is_result = self.pose.has_key(to) || dynamics.is_some() || observer.wants_frames();
        let energy_tolerance = if is_result { RESULT } else { PASSING };
        let settings = NewtonSettings {
            max_iterations: MOST_ITERATIONS,
            energy_tolerance,
            residual_tolerance: modelling.tolerance,
            first_relaxation: SLOWLY_LESS * self.relaxation,
            // What burns keeps no symmetry anyway.
            any_minimum: self.state.fire().is_some(),
            seed: modelling.seed,
            ..NewtonSettings::default()
        };
        let vertices = self.state.vertex_count();
        let how = (modelling, &settings);
        // Where nothing is left to solve, nobody else asks.
        let start = Progress {
            load: to,
            iteration: 0,
            vertices,
        };
        if self.state.is_gone() && !observer.progress(start) {
            return Ok(SolveReport::interrupted());
        }
        let mut keep_going = |iteration: &ruga_solver::Iteration| {
            observer.progress(Progress {
                load: to,
                iteration: iteration.index,
                vertices,
            })
        };
        let solve = self
            .state
            .minimise(inertia.as_ref(), how, &mut keep_going)?;
        self.report.count(&solve);
        self.report.end_with(&solve);
        self.solves += 1;
        let time = dynamics.map_or(to - from, |dynamics| dynamics.time_step);
        self.state.end_step(before, time);
        if solve.converged {
            self.relaxation = solve.first_relaxation;
        }
        Ok(solve)
    }

    /// Reports the frame at a fraction of the pose.
    fn frame(&mut self, load: f64, observer: &mut dyn Observer) -> Result<(), StepperError> {
        let is_key = self.pose.has_key(load);
        if is_key || observer.wants_frames() {
            observer.phase(0, Phase::Sampling);
            let driver = &self.plan.driver;
            let artist = self.state.artist_positions(driver);
            let mut surface = self.state.surface(driver, &artist);
            if observer.wants_face_states() {
                surface.face_states = Some(self.state.face_states());
            }
            if let Some(fire) = self.state.fire() {
                surface = self.state.cut(surface, fire)?;
            }
            let layers = vec![surface];
            observer.frame(&Frame {
                index: self.result.frames,
                load,
                layers: &layers,
                artist_positions: Some(&artist),
            });
            if is_key {
                self.count_crossing(load);
                self.result.keys.push(KeyResult {
                    load,
                    layers,
                    artist_positions: Some(artist),
                });
            }
        }
        self.result.frames += 1;
        Ok(())
    }

    /// Counts the triangles that cross others at a fraction of the pose.
    fn count_crossing(&mut self, load: f64) {
        let standing = &self.state.meshed.standing;
        let positions = standing.of_vertices(&self.state.moving.positions);
        let pairs = intersecting_pairs(&standing.part.mesh, &positions);
        let crossing: BTreeSet<FaceId> = pairs.into_iter().flatten().collect();
        self.report.intersections = Some(crossing.len());
        if !crossing.is_empty() {
            self.crossing.push((crossing.len(), load));
        }
    }

    /// Warns of keys at which the sheet passes through itself.
    fn warn_of_crossing(&mut self) {
        let keys = self.crossing.iter().map(|(count, load)| {
            let triangles = if *count == 1 { "triangle" } else { "triangles" };
            format!("{count} {triangles} at {:.1} % of the pose", 100.0 * load)
        });
        let keys: Vec<String> = keys.collect();
        if !keys.is_empty() {
            self.warn(&format!(
                "it passes through itself, which nothing keeps it from: {} cross others; where that can be seen, let it curl less, keep its parts from each other by an obstacle, or end at an earlier key",
                keys.join(", ")
            ));
        }
    }

    fn warn(&mut self, warning: &str) {
        let (pose, layer) = (&self.pose.name, &self.state.spec.name);
        self.result.warn(pose, layer, warning);
    }

    /// Warns of a fire that has done nothing, or has left nothing where it matters.
    fn tell_of_fire(&mut self) {
        let Some((_, burning)) = self.state.fire() else {
            return;
        };
        let has_burnt = burning.has_burnt();
        if !has_burnt {
            self.warn("nothing has burnt: no source has touched the sheet for long enough; bring one nearer, make it hotter or give it a larger `coefficient`");
        }
        if self.state.is_gone() {
            self.warn(
                "all of it has burnt or fallen off before the end; maps show nothing from there on",
            );
            return;
        }
        let burnt: Vec<String> = self.state.burnt_handles().map(str::to_owned).collect();
        for handle in burnt {
            self.warn(&format!("all that handle '{handle}' held has burnt"));
        }
    }

    fn finished(mut self, ending: Ending) -> PoseResult {
        self.result.converged &= ending == Ending::Reached;
        self.result.interrupted = ending == Ending::Interrupted;
        let capped = self.state.capped as f64 / self.report.faces.max(1) as f64;
        if capped > CAPPED {
            self.warn(&format!(
                "{:.0} % of its triangles are too large for its curl, which is cut to {:.0} degrees over an edge there; give `[sheet]` an `edge` below {:.1e} m",
                100.0 * capped,
                MAX_NATURAL_ANGLE.to_degrees(),
                self.state.sheet.edges(&self.state.region.skin.rest.positions)[0]
            ));
        }
        let is_counted = self
            .result
            .keys
            .last()
            .is_some_and(|key| key.load == self.reached);
        if ending == Ending::GaveUp && !is_counted {
            self.count_crossing(self.reached);
        }
        self.warn_of_crossing();
        let divided = self.divided;
        if divided > 0 && ending == Ending::Reached {
            self.warn(&format!(
                "{divided} of its steps had to be divided; take more `steps`"
            ));
        }
        // Where the pose ended early, growth and folds of the step that failed are still in place.
        if ending == Ending::Reached {
            self.tell_of_fire();
            self.report.energy = self.state.elastic_energy();
            self.report.creases = self.state.crease_reports();
        }
        self.result.layers = vec![self.report];
        self.result
    }
}
