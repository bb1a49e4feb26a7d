//! One pose from rest to full weight.

use nalgebra::Vector3;
use ruga_blend::{BaseSurface, Driver};
use ruga_mesh::FaceId;
use ruga_solver::{
    AtSaddle, LoadSettings, LoadStepper, NewtonSettings, Outcome, SolveReport, SolverError,
    StopRule, Trial, Verdict,
};

use crate::adaptivity::adapted;
use crate::layer::Layer;
use crate::measure::waviness;
use crate::plan::LayerPlan;
use crate::skin_mesh::RegionMesh;
use crate::{
    Frame, KeyResult, LayerReport, LayerSpec, LoadPath, Modelling, Observer, Phase, Plan,
    PoseResult, PoseSpec, Progress, StepperError,
};

/// Simulates pose number `pose` of the plan.
///
/// The layer follows the driver from rest to full weight, or at each key the growth of its strain
/// ([`LoadPath`]); a load at which it first buckles is
/// approached by bisection, so that the wavelength is chosen at the onset. Not converging is
/// reported, not an error; the results reached until then are kept.
///
/// # Errors
/// [`StepperError::TooManyLayers`], and what shell, constraints or solver refuse.
pub fn simulate(
    driver: &Driver,
    layers: &[LayerSpec],
    plan: &Plan,
    pose: usize,
    spec: &PoseSpec,
    modelling: &Modelling,
    observer: &mut dyn Observer,
) -> Result<PoseResult, StepperError> {
    let [layer] = layers else {
        return Err(StepperError::TooManyLayers {
            count: layers.len(),
        });
    };
    let layer_plan = &plan.poses[pose].layers[0];
    if layer_plan.region.is_empty() {
        return Ok(neutral(spec, layer_plan));
    }
    observer.phase(Phase::Sampling);
    let surface = layer_surface(driver, plan, layer_plan, modelling);
    let region = RegionMesh::new(driver, &surface, modelling.smoothing);
    observer.phase(Phase::Remeshing);
    let adapted = adapted(driver, layer, &plan.wrinkling[0], &region, spec, modelling)?;
    observer.phase(Phase::Constraints);
    let layer = Layer::new(
        driver,
        layer,
        &plan.wrinkling[0],
        region,
        adapted,
        modelling.seed,
    )?;
    let mut run = PoseRun {
        driver,
        spec,
        modelling,
        layer,
        observer,
        result: PoseResult {
            converged: true,
            ..PoseResult::default()
        },
        report: LayerReport::default(),
        told_of_missing_inertia: false,
    };
    run.follow(plan.poses[pose].path)?;
    Ok(run.finish())
}

/// What a pose gives in which nothing can wrinkle.
fn neutral(spec: &PoseSpec, plan: &LayerPlan) -> PoseResult {
    PoseResult {
        keys: spec
            .keys
            .iter()
            .map(|&load| KeyResult {
                load,
                layers: Vec::new(),
            })
            .collect(),
        layers: vec![LayerReport {
            name: plan.name.clone(),
            wavelength_predicted: plan.wavelength,
            critical_strain_predicted: plan.critical_strain,
            ..LayerReport::default()
        }],
        converged: true,
        ..PoseResult::default()
    }
}

/// The part of the base surface that the plan wants simulated, at the plan's resolution.
fn layer_surface(
    driver: &Driver,
    plan: &Plan,
    layer: &LayerPlan,
    modelling: &Modelling,
) -> BaseSurface {
    let whole_driver = |face: &u64| FaceId((face >> (2 * plan.planning_levels)) as u32);
    let mut coarse: Vec<FaceId> = layer.region.iter().map(whole_driver).collect();
    coarse.dedup();
    let whole = BaseSurface::new(driver, &coarse, layer.levels, modelling.smoothing);
    // Faces larger than the region's are taken when any part of them is in it.
    let level = plan.planning_levels.min(layer.levels);
    let shift = 2 * (plan.planning_levels - level);
    let mut region: Vec<u64> = layer.region.iter().map(|face| face >> shift).collect();
    region.dedup();
    let wanted = |face: &FaceId| region.binary_search(&whole.ancestor(*face, level)).is_ok();
    let faces: Vec<FaceId> = whole.mesh().faces().ids().filter(wanted).collect();
    whole.restrict(&faces)
}

/// Share of the critical strain below which nothing can wrinkle.
const LEAST_DEMAND: f64 = 0.9;

/// Amplitude below which a layer counts as flat, in thicknesses.
const LEAST_AMPLITUDE: f64 = 0.01;

/// What a load step asks for: the driver's pose and how much of its strain.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Fraction of the pose's weights.
    weight: f64,
    /// Share of the strain there.
    share: f64,
}

impl Place {
    /// The fraction of the pose as the user sees it.
    fn load(self) -> f64 {
        self.weight * self.share
    }
}

/// `steps` equal steps to 1, as far as `last`, and the `keys`; ascending.
fn loads_up_to(last: f64, steps: u32, keys: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut loads: Vec<f64> = (1..=steps)
        .map(|i| f64::from(i) / f64::from(steps))
        .filter(|&load| load < last)
        .chain(keys)
        .collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    loads
}

struct PoseRun<'a> {
    driver: &'a Driver,
    spec: &'a PoseSpec,
    modelling: &'a Modelling,
    layer: Layer,
    observer: &'a mut dyn Observer,
    result: PoseResult,
    report: LayerReport,
    /// Whether the user was told that minima and saddles look alike.
    told_of_missing_inertia: bool,
}

impl PoseRun<'_> {
    fn follow(&mut self, path: LoadPath) -> Result<(), StepperError> {
        let last = self.spec.keys.iter().copied().fold(0.0, f64::max);
        let control = self.driver.pose(&self.spec.weights.scaled(last));
        let below = self.layer.points().pose(&control);
        self.layer.calibrate_bending(below)?;
        match path {
            LoadPath::Weight => {
                // Beyond the last key nothing was planned for.
                let keys = self.spec.keys.iter().copied();
                let loads = loads_up_to(last, self.spec.steps, keys);
                self.follow_loads(&loads, |weight| Place { weight, share: 1.0 })?;
            }
            LoadPath::Strain => {
                let at_rest = self.layer.state();
                let loads = loads_up_to(1.0, self.spec.steps, [1.0]);
                for &weight in &self.spec.keys {
                    self.layer.restore(&at_rest)?;
                    if !self.follow_loads(&loads, |share| Place { weight, share })? {
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    /// Solves at every one of `loads`; `place` says what a load means. False when the observer
    /// ended the work.
    fn follow_loads(
        &mut self,
        loads: &[f64],
        place: impl Fn(f64) -> Place,
    ) -> Result<bool, StepperError> {
        let mut stepper = LoadStepper::new(loads, LoadSettings::default())
            .map_err(|source| self.solver_error(source))?;
        let mut kept = self.layer.state();
        while let Some(trial) = stepper.next_trial() {
            self.observer.phase(Phase::Sampling);
            let place = place(trial.load);
            let control = self.driver.pose(&self.spec.weights.scaled(place.weight));
            let below = self.layer.points().pose(&control);
            self.layer.set_below(below, place.share)?;
            self.observer.phase(Phase::Integration);
            let solve = self.solve(trial, place.load())?;
            if solve.stop == StopRule::Interrupted {
                self.result.interrupted = true;
                self.result.converged = false;
                return Ok(false);
            }
            let outcome = self.outcome(trial, &solve);
            if trial.probe && outcome == Outcome::Buckled {
                self.report.onset_load = Some(place.load());
            }
            match stepper.report(outcome) {
                Verdict::Keep => {
                    kept = self.layer.state();
                    self.keep(place, &control, &solve);
                }
                Verdict::Discard => self.layer.restore(&kept)?,
                Verdict::GiveUp => {
                    self.layer.restore(&kept)?;
                    self.give_up(place.load(), &solve);
                }
            }
        }
        Ok(true)
    }

    fn solve(&mut self, trial: Trial, load: f64) -> Result<SolveReport, StepperError> {
        let settings = NewtonSettings {
            linear: self.modelling.linear,
            at_saddle: if self.is_probe(trial) {
                AtSaddle::Stop
            } else {
                AtSaddle::Leave
            },
            residual_tolerance: self.modelling.tolerance,
            seed: self.modelling.seed,
            ..NewtonSettings::default()
        };
        let vertices = self.layer.vertex_count();
        let observer = &mut *self.observer;
        let mut keep_going = |iteration: &ruga_solver::Iteration| {
            observer.progress(Progress {
                load,
                iteration: iteration.index,
                vertices,
            })
        };
        let solve = self
            .layer
            .minimise(&settings, &mut keep_going)
            .map_err(|source| self.solver_error(source))?;
        self.report.newton_iterations += solve.iterations;
        self.report.factorizations += solve.factorizations;
        self.report.residual = solve.residual;
        self.report.stop = Some(solve.stop);
        Ok(solve)
    }

    fn keep(&mut self, place: Place, control: &[Vector3<f64>], solve: &SolveReport) {
        if solve.inertia.is_none() && self.layer.demand() > 1.0 && !self.told_of_missing_inertia {
            self.told_of_missing_inertia = true;
            self.result.warnings.push(format!(
                "pose '{}', layer '{}': linear = \"minres\" cannot tell a wrinkled state from an unstable flat one; compare with \"ldlt\"",
                self.spec.name, self.layer.spec.name
            ));
        }
        let layers = [self.layer.snapshot(control)];
        self.observer.frame(&Frame {
            index: self.result.frames,
            load: place.load(),
            layers: &layers,
        });
        self.result.frames += 1;
        if place.share == 1.0
            && self
                .spec
                .keys
                .iter()
                .any(|key| (key - place.weight).abs() < 1e-9)
        {
            self.result.keys.push(KeyResult {
                load: place.weight,
                layers: layers.into(),
            });
        }
    }

    fn give_up(&mut self, load: f64, solve: &SolveReport) {
        self.result.converged = false;
        self.result.warnings.push(format!(
            "pose '{}', layer '{}': no equilibrium found at load {load:.3} ({:?} after {} iterations, relative residual {:.1e})",
            self.spec.name, self.layer.spec.name, solve.stop, solve.iterations, solve.residual
        ));
    }

    fn finish(mut self) -> PoseResult {
        let layer = &self.layer;
        self.report.name.clone_from(&layer.spec.name);
        self.report.vertices = layer.vertex_count();
        self.report.faces = layer.face_count();
        self.report.constraints = layer.row_count();
        self.report.wavelength_predicted = layer.wrinkling.wavelength;
        self.report.critical_strain_predicted = layer.wrinkling.critical_strain;
        self.report.energy = layer.energy();
        self.report.bending_ratio = layer.bending_ratio;
        let heights = layer.heights();
        let faces = layer.supercritical_faces();
        if let Some(waves) = waviness(&heights, &layer.rest().positions, faces) {
            self.report.amplitude = waves.amplitude;
            let is_wrinkled = waves.amplitude > LEAST_AMPLITUDE * layer.spec.material.thickness;
            self.report.wavelength = is_wrinkled.then_some(waves.wavelength);
        }
        self.result.layers.push(self.report);
        self.result
    }

    /// Whether a saddle at this load would be the onset of wrinkling: below the critical strain
    /// it is the noise of a detail finer than the layer is thick.
    fn is_probe(&self, trial: Trial) -> bool {
        trial.probe && self.layer.demand() > LEAST_DEMAND
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
