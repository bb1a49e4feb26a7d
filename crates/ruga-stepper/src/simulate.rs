//! One pose from rest to its keys, layer by layer.

use std::rc::Rc;

use nalgebra::Vector3;

use crate::below::{BelowSurface, surface_below};
use crate::cover::Covers;
use crate::embedded::simulate_body;
use crate::error::Halt;
use crate::layer_run::{Course, Ending, LayerRun};
use crate::layer_setup::BelowOf;
use crate::skin_mesh::SkinMesh;
use crate::{
    Frame, KeyResult, LayerReport, LoadPath, Observer, Phase, Plan, PoseResult, PoseSpec,
    StepperError,
};

impl Plan {
    /// Simulates pose number `pose`, from rest to its keys.
    ///
    /// On a driver, the lowest layer that can wrinkle follows it from rest to full weight, or at each
    /// key the growth of its strain ([`LoadPath`]); a load at which it first buckles is approached by
    /// bisection, so that the wavelength is chosen at the onset. On its equilibrium the next layer is
    /// solved, its strain growing from none, and so on up (Li 2014); from one result to the next it
    /// goes on from its last shape, on a mesh that is fitted anew when the old one no longer serves.
    ///
    /// On a soft body, layer and body are one minimum of all energies. Handles and obstacles go their
    /// ways and blend shapes draw the surface with growing weights; weight acts in full from the first
    /// load on, and [`KeyResult::artist_positions`] say where the artist's mesh has gone. With
    /// [`Modelling::dynamics`](crate::Modelling::dynamics) every load is one step in time instead,
    /// whole where the solver finds its end, or else in shorter ones, and nothing waits at keys for
    /// rest.
    ///
    /// Not converging is reported, not an error; the results reached until then are kept. An observer
    /// may end the work at any time, also before the first step, while meshes and constraints are made
    /// ([`Observer::preparing`]); the result then says that it was interrupted.
    ///
    /// # Errors
    /// [`StepperError::NoSuchPose`] for a pose that the plan does not have; what shell, constraints,
    /// remeshing or solver refuse.
    pub fn simulate(
        &self,
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<PoseResult, StepperError> {
        if pose >= self.specs.len() {
            return Err(StepperError::NoSuchPose {
                pose,
                poses: self.specs.len(),
            });
        }
        match &self.body {
            None => self.simulate_stack(pose, observer),
            Some(body) => simulate_body((self, body), pose, observer),
        }
    }

    fn simulate_stack(
        &self,
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<PoseResult, StepperError> {
        let mut run = StackRun {
            plan: self,
            pose,
            result: PoseResult {
                layers: self.reports(pose),
                converged: true,
                ..PoseResult::default()
            },
            upper: self.stacking.specs.iter().map(|_| None).collect(),
            covers: Rc::default(),
        };
        run.follow(observer)?;
        Ok(run.result)
    }

    /// What is known of the layers of pose number `pose` before they are simulated.
    pub(crate) fn reports(&self, pose: usize) -> Vec<LayerReport> {
        let reports = self.poses[pose].layers.iter().map(|layer| LayerReport {
            name: layer.name.clone(),
            wavelength_predicted: layer.wavelength,
            critical_strain_predicted: layer.critical_strain,
            painted: layer.painted,
            ..LayerReport::default()
        });
        reports.collect()
    }
}

/// `steps` equal steps to 1, as far as `last`, and the `keys`; ascending.
pub(crate) fn loads_up_to(last: f64, steps: u32, keys: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut loads: Vec<f64> = (1..=steps)
        .map(|i| f64::from(i) / f64::from(steps))
        .filter(|&load| load < last)
        .chain(keys)
        .collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    loads
}

/// A fraction of the pose's weights, and a share of the strain there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) weight: f64,
    pub(crate) share: f64,
}

/// The layers of one pose.
pub(crate) struct StackRun<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) pose: usize,
    pub(crate) result: PoseResult,
    /// The layers above the lowest one, as they were left by the last frame that had them.
    pub(crate) upper: Vec<Option<LayerRun<'a>>>,
    /// Where their meshes lie on those below.
    pub(crate) covers: Rc<Covers>,
}

impl<'a> StackRun<'a> {
    /// The pose as it was asked for.
    pub(crate) fn spec(&self) -> &'a PoseSpec {
        &self.plan.specs[self.pose]
    }

    fn follow(&mut self, observer: &mut dyn Observer) -> Result<(), StepperError> {
        let layers = &self.plan.poses[self.pose].layers;
        let Some(lowest) = layers.iter().position(|layer| !layer.region.is_empty()) else {
            self.result.keys = self
                .spec()
                .keys
                .iter()
                .map(|&load| flat_key(load))
                .collect();
            return Ok(());
        };
        let keys = self.spec().keys.iter();
        let keys: Vec<_> = keys.map(|&key| self.control(key)).collect();
        let (driver, seat) = (&self.plan.driver, self.plan.stacking.seats[lowest]);
        let at_key = |control: Vec<Vector3<f64>>| -> BelowOf<'_> {
            Box::new(move |skin| surface_below(driver, skin, seat, &control, &[]))
        };
        let below: Vec<BelowOf<'_>> = keys.into_iter().map(at_key).collect();
        let made = self.build(lowest, &below, observer);
        let Some(mut run) = Halt::unless_interrupted(made)? else {
            self.result.converged = false;
            self.result.interrupted = true;
            return Ok(());
        };
        let ending = match self.plan.poses[self.pose].path {
            LoadPath::Weight => self.follow_weight(lowest, &mut run, observer)?,
            LoadPath::Strain => self.follow_strain(lowest, &mut run, observer)?,
        };
        if ending == Ending::Reached {
            run.warn_unwrinkled(&self.plan.driver);
        }
        self.tell(&run, ending);
        run.measure();
        if let Some(upper) = run.layer.upper() {
            let planned = &self.result.layers[upper.index];
            self.result.layers[upper.index] = run.upper_report(upper, planned);
        }
        self.result.layers[lowest] = run.report;
        Ok(())
    }

    fn follow_weight(
        &mut self,
        lowest: usize,
        run: &mut LayerRun<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        // Beyond the last key nothing was planned for.
        let last = self.spec().keys.iter().copied().fold(0.0, f64::max);
        let loads = loads_up_to(last, self.spec().steps, self.spec().keys.iter().copied());
        let mut course = DriverCourse {
            stack: self,
            lowest,
            key: None,
            wants_frames: observer.wants_frames(),
        };
        let keys = course.stack.spec().keys.clone();
        follow_course(run, &mut course, (&loads, &keys), observer)
    }

    fn follow_strain(
        &mut self,
        lowest: usize,
        run: &mut LayerRun<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let at_rest = run.layer.state();
        let loads = loads_up_to(1.0, self.spec().steps, [1.0]);
        let mut worst = Ending::Reached;
        for key in self.spec().keys.clone() {
            run.layer.restore(&at_rest)?;
            let mut course = DriverCourse {
                stack: self,
                lowest,
                key: Some(key),
                wants_frames: observer.wants_frames(),
            };
            match follow_course(run, &mut course, (&loads, &[1.0]), observer)? {
                Ending::Reached => {}
                Ending::GaveUp => worst = Ending::GaveUp,
                Ending::Interrupted => return Ok(Ending::Interrupted),
            }
        }
        Ok(worst)
    }

    /// Where the driver's vertices are at a fraction of the pose.
    fn control(&self, weight: f64) -> Vec<Vector3<f64>> {
        self.plan.driver.pose(&self.spec().weights.scaled(weight))
    }

    /// Takes over what a layer's run has to say.
    pub(crate) fn tell(&mut self, run: &LayerRun<'_>, ending: Ending) {
        self.result.converged &= ending == Ending::Reached;
        self.result.interrupted |= ending == Ending::Interrupted;
        for warning in &run.warnings {
            let (pose, layer) = (&self.plan.specs[self.pose].name, &run.layer.spec.name);
            self.result.warn(pose, layer, warning);
        }
    }

    fn is_key(&self, place: Place) -> bool {
        place.share == 1.0 && self.spec().has_key(place.weight)
    }

    /// Hands out what was reached at `place` by layer `lowest`, after solving the layers above.
    /// False when the observer ends the work.
    fn frame(
        &mut self,
        lowest: usize,
        run: &LayerRun<'_>,
        place: Place,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let is_key = self.is_key(place);
        if !is_key && !observer.wants_frames() {
            self.result.frames += 1;
            return Ok(true);
        }
        observer.phase(lowest, Phase::Sampling);
        let control = self.control(place.weight);
        let mut layers = self.snapshot(run, &control, &[]);
        if place.share == 1.0 {
            let upper = self.upper_layers(lowest, run, place, &control, observer)?;
            let Some(upper) = upper else { return Ok(false) };
            layers.extend(upper);
        }
        observer.frame(&Frame {
            index: self.result.frames,
            load: place.weight * place.share,
            layers: &layers,
        });
        self.result.frames += 1;
        if is_key {
            self.result.keys.push(KeyResult {
                load: place.weight,
                layers,
                artist_positions: None,
            });
        }
        Ok(true)
    }
}

/// Follows a course from equilibrium to equilibrium, or in time.
fn follow_course(
    run: &mut LayerRun<'_>,
    course: &mut dyn Course,
    (loads, keys): (&[f64], &[f64]),
    observer: &mut dyn Observer,
) -> Result<Ending, StepperError> {
    match run.modelling.dynamics {
        None => run.follow(course, loads, observer),
        Some(dynamics) => {
            run.layer.set_in_motion(dynamics);
            run.follow_in_time(course, (loads, keys), observer)
        }
    }
}

/// A key at which nothing wrinkles.
fn flat_key(load: f64) -> KeyResult {
    KeyResult {
        load,
        layers: Vec::new(),
        artist_positions: None,
    }
}

/// The lowest layer's way: along the weights, or along the strain of one key.
struct DriverCourse<'r, 'a> {
    stack: &'r mut StackRun<'a>,
    lowest: usize,
    key: Option<f64>,
    wants_frames: bool,
}

impl DriverCourse<'_, '_> {
    fn place(&self, load: f64) -> Place {
        match self.key {
            None => Place {
                weight: load,
                share: 1.0,
            },
            Some(weight) => Place {
                weight,
                share: load,
            },
        }
    }
}

impl Course for DriverCourse<'_, '_> {
    fn below(&self, skin: &SkinMesh, load: f64) -> (BelowSurface, f64) {
        let place = self.place(load);
        let control = self.stack.control(place.weight);
        let seat = self.stack.plan.stacking.seats[self.lowest];
        (
            surface_below(&self.stack.plan.driver, skin, seat, &control, &[]),
            place.share,
        )
    }

    fn shown(&self, load: f64) -> f64 {
        let place = self.place(load);
        place.weight * place.share
    }

    fn is_result(&self, load: f64) -> bool {
        self.wants_frames || self.stack.is_key(self.place(load))
    }

    fn kept(
        &mut self,
        run: &LayerRun<'_>,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let place = self.place(load);
        self.stack.frame(self.lowest, run, place, observer)
    }
}
