//! One pose from rest to its keys, layer by layer.

use nalgebra::Vector3;
use ruga_blend::{BaseSurface, Driver};
use ruga_mesh::FaceId;

use crate::adaptivity::adapted;
use crate::below::{BelowSurface, LowerLayer, surface_below};
use crate::layer::Layer;
use crate::layer_run::{Course, Ending, LayerRun};
use crate::plan::LayerPlan;
use crate::skin_mesh::{RegionMesh, SkinMesh};
use crate::{
    Frame, KeyResult, LayerReport, LayerSurface, LoadPath, Modelling, Observer, Phase, Plan,
    PoseResult, PoseSpec, StepperError,
};

/// Simulates pose number `pose` of the plan.
///
/// The lowest layer that can wrinkle follows the driver from rest to full weight, or at each key
/// the growth of its strain ([`LoadPath`]); a load at which it first buckles is approached by
/// bisection, so that the wavelength is chosen at the onset. On its equilibrium the next layer is
/// solved, its strain growing from none, and so on up (Li 2014). Not converging is reported, not
/// an error; the results reached until then are kept.
///
/// # Errors
/// What shell, constraints, remeshing or solver refuse.
pub fn simulate(
    driver: &Driver,
    plan: &Plan,
    pose: usize,
    spec: &PoseSpec,
    modelling: &Modelling,
    observer: &mut dyn Observer,
) -> Result<PoseResult, StepperError> {
    let reports = plan.poses[pose].layers.iter().map(|layer| LayerReport {
        name: layer.name.clone(),
        wavelength_predicted: layer.wavelength,
        critical_strain_predicted: layer.critical_strain,
        ..LayerReport::default()
    });
    let mut run = StackRun {
        driver,
        plan,
        pose,
        spec,
        modelling,
        result: PoseResult {
            layers: reports.collect(),
            converged: true,
            ..PoseResult::default()
        },
    };
    run.follow(observer)?;
    Ok(run.result)
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

/// Edges longer than asked for by less than this factor are not worth a word.
const WORTH_TELLING: f64 = 1.1;

/// A fraction of the pose's weights, and a share of the strain there.
#[derive(Clone, Copy, Debug)]
struct Place {
    weight: f64,
    share: f64,
}

/// The layers of one pose.
struct StackRun<'a> {
    driver: &'a Driver,
    plan: &'a Plan,
    pose: usize,
    spec: &'a PoseSpec,
    modelling: &'a Modelling,
    result: PoseResult,
}

impl StackRun<'_> {
    fn follow(&mut self, observer: &mut dyn Observer) -> Result<(), StepperError> {
        let layers = &self.plan.poses[self.pose].layers;
        let Some(lowest) = layers.iter().position(|layer| !layer.region.is_empty()) else {
            self.result.keys = self.spec.keys.iter().map(|&load| flat_key(load)).collect();
            return Ok(());
        };
        let keys: Vec<_> = self
            .spec
            .keys
            .iter()
            .map(|&key| self.control(key))
            .collect();
        let below = |skin: &SkinMesh| -> Vec<BelowSurface> {
            let seat = self.plan.seats[lowest];
            let keys = keys.iter();
            keys.map(|control| surface_below(self.driver, skin, seat, control, None))
                .collect()
        };
        let mut run = self.build(lowest, &below, observer)?;
        let ending = match self.plan.poses[self.pose].path {
            LoadPath::Weight => self.follow_weight(lowest, &mut run, observer)?,
            LoadPath::Strain => self.follow_strain(lowest, &mut run, observer)?,
        };
        self.tell(&run, ending);
        run.measure();
        self.result.layers[lowest] = run.report;
        Ok(())
    }

    fn follow_weight(
        &mut self,
        lowest: usize,
        run: &mut LayerRun,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let modelling = self.modelling;
        // Beyond the last key nothing was planned for.
        let last = self.spec.keys.iter().copied().fold(0.0, f64::max);
        let loads = loads_up_to(last, self.spec.steps, self.spec.keys.iter().copied());
        let mut course = DriverCourse {
            stack: self,
            lowest,
            key: None,
        };
        run.follow(&mut course, &loads, modelling, observer)
    }

    fn follow_strain(
        &mut self,
        lowest: usize,
        run: &mut LayerRun,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let modelling = self.modelling;
        let at_rest = run.layer.state();
        let loads = loads_up_to(1.0, self.spec.steps, [1.0]);
        let mut worst = Ending::Reached;
        for key in self.spec.keys.clone() {
            run.layer.restore(&at_rest)?;
            let mut course = DriverCourse {
                stack: self,
                lowest,
                key: Some(key),
            };
            match run.follow(&mut course, &loads, modelling, observer)? {
                Ending::Reached => {}
                Ending::GaveUp => worst = Ending::GaveUp,
                Ending::Interrupted => return Ok(Ending::Interrupted),
            }
        }
        Ok(worst)
    }

    /// Where the driver's vertices are at a fraction of the pose.
    fn control(&self, weight: f64) -> Vec<Vector3<f64>> {
        self.driver.pose(&self.spec.weights.scaled(weight))
    }

    /// Builds layer number `index`, its mesh fitted to each of what may lie `below`, its hinges
    /// corrected on the last.
    fn build(
        &self,
        index: usize,
        below: &dyn Fn(&SkinMesh) -> Vec<BelowSurface>,
        observer: &mut dyn Observer,
    ) -> Result<LayerRun, StepperError> {
        let (driver, plan, modelling) = (self.driver, self.plan, self.modelling);
        let (spec, seat) = (&plan.specs[index], plan.seats[index]);
        let wrinkling = &plan.wrinkling[index];
        observer.phase(Phase::Sampling);
        let surface = layer_surface(
            driver,
            plan,
            &plan.poses[self.pose].layers[index],
            modelling,
        );
        let region = RegionMesh::new(driver, &surface, modelling.smoothing, seat.offset);
        observer.phase(Phase::Remeshing);
        let surfaces = below(&region.skin);
        let adapted = adapted(driver, spec, wrinkling, &region, &surfaces, modelling)?;
        let coarseness = adapted.as_ref().map_or(1.0, |adapted| adapted.coarseness);
        let adapted = adapted.map(|adapted| adapted.skin);
        observer.phase(Phase::Constraints);
        let mut layer = Layer::new(
            driver,
            spec,
            wrinkling,
            seat.tie,
            region,
            adapted,
            modelling.seed,
        )?;
        let mut is_measured = true;
        if let Some(last) = below(layer.skin()).pop() {
            is_measured = layer.calibrate_bending(last)?;
        }
        let mut run = LayerRun::new(layer);
        if coarseness > WORTH_TELLING {
            run.warnings.push(format!(
                "the vertex budget of {} leaves {:.1} points per wavelength of {} asked for",
                modelling.vertex_budget,
                modelling.points_per_wavelength / coarseness,
                modelling.points_per_wavelength
            ));
        }
        if !is_measured {
            run.warnings.push(
                "the bending modulus of its mesh could not be measured; wavelengths may be some per cent short".to_owned(),
            );
        }
        Ok(run)
    }

    /// Takes over what a layer's run has to say.
    fn tell(&mut self, run: &LayerRun, ending: Ending) {
        self.result.converged &= ending == Ending::Reached;
        self.result.interrupted |= ending == Ending::Interrupted;
        for warning in &run.warnings {
            let layer = &run.layer.spec.name;
            let text = format!("pose '{}', layer '{layer}': {warning}", self.spec.name);
            if !self.result.warnings.contains(&text) {
                self.result.warnings.push(text);
            }
        }
    }

    /// Hands out what was reached at `place` by layer `lowest`, after solving the layers above.
    /// False when the observer ends the work.
    fn frame(
        &mut self,
        lowest: usize,
        run: &LayerRun,
        place: Place,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let control = self.control(place.weight);
        let mut layers = vec![self.snapshot(lowest, run, &control, None)];
        let is_key = |key: &f64| (key - place.weight).abs() < 1e-9;
        let is_key = place.share == 1.0 && self.spec.keys.iter().any(is_key);
        if is_key || (place.share == 1.0 && observer.wants_frames()) {
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
            });
        }
        Ok(true)
    }

    /// Solves the layers above `lowest` one on the other; `None` when the observer ends the work.
    fn upper_layers(
        &mut self,
        lowest: usize,
        run: &LayerRun,
        place: Place,
        control: &[Vector3<f64>],
        observer: &mut dyn Observer,
    ) -> Result<Option<Vec<LayerSurface>>, StepperError> {
        let mut surfaces = Vec::new();
        let mut below: Option<(usize, LayerRun)> = None;
        for index in lowest + 1..self.plan.specs.len() {
            if self.plan.poses[self.pose].layers[index].region.is_empty() {
                continue;
            }
            let lower = match &below {
                Some((index, run)) => self.lower(*index, run),
                None => self.lower(lowest, run),
            };
            let seat = self.plan.seats[index];
            let surface = |skin: &SkinMesh| {
                vec![surface_below(
                    self.driver,
                    skin,
                    seat,
                    control,
                    Some(&lower),
                )]
            };
            let mut upper = self.build(index, &surface, observer)?;
            let mut course = CarriedCourse {
                below: surface_below(self.driver, upper.layer.skin(), seat, control, Some(&lower)),
                weight: place.weight,
            };
            let loads = loads_up_to(1.0, self.spec.steps, [1.0]);
            let ending = upper.follow(&mut course, &loads, self.modelling, observer)?;
            surfaces.push(self.snapshot(index, &upper, control, Some(&lower)));
            self.tell(&upper, ending);
            if ending == Ending::Interrupted {
                return Ok(None);
            }
            upper.measure();
            self.add_report(index, &upper.report);
            below = Some((index, upper));
        }
        Ok(Some(surfaces))
    }

    fn lower<'r>(&self, index: usize, run: &'r LayerRun) -> LowerLayer<'r> {
        LowerLayer {
            skin: run.layer.skin(),
            positions: run.layer.positions(),
            offset: self.plan.seats[index].offset,
        }
    }

    /// The layer as others see it.
    fn snapshot(
        &self,
        index: usize,
        run: &LayerRun,
        control: &[Vector3<f64>],
        lower: Option<&LowerLayer<'_>>,
    ) -> LayerSurface {
        let seat = self.plan.seats[index];
        let region = &run.layer.region().skin;
        let below = surface_below(self.driver, region, seat, control, lower);
        run.layer.snapshot(control, &below.posed, seat.offset)
    }

    /// Takes over the report of a layer that is solved anew in every frame; work adds up.
    fn add_report(&mut self, index: usize, report: &LayerReport) {
        let before = &self.result.layers[index];
        self.result.layers[index] = LayerReport {
            newton_iterations: before.newton_iterations + report.newton_iterations,
            factorizations: before.factorizations + report.factorizations,
            ..report.clone()
        };
    }
}

/// A key at which nothing wrinkles.
fn flat_key(load: f64) -> KeyResult {
    KeyResult {
        load,
        layers: Vec::new(),
    }
}

/// The lowest layer's way: along the weights, or along the strain of one key.
struct DriverCourse<'r, 'a> {
    stack: &'r mut StackRun<'a>,
    lowest: usize,
    key: Option<f64>,
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
        let seat = self.stack.plan.seats[self.lowest];
        (
            surface_below(self.stack.driver, skin, seat, &control, None),
            place.share,
        )
    }

    fn shown(&self, load: f64) -> f64 {
        let place = self.place(load);
        place.weight * place.share
    }

    fn kept(
        &mut self,
        run: &LayerRun,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let place = self.place(load);
        self.stack.frame(self.lowest, run, place, observer)
    }
}

/// An upper layer's way: its strain grows on a surface that stays.
struct CarriedCourse {
    below: BelowSurface,
    weight: f64,
}

impl Course for CarriedCourse {
    fn below(&self, _: &SkinMesh, load: f64) -> (BelowSurface, f64) {
        (self.below.clone(), load)
    }

    fn shown(&self, load: f64) -> f64 {
        self.weight * load
    }

    fn kept(&mut self, _: &LayerRun, _: f64, _: &mut dyn Observer) -> Result<bool, StepperError> {
        Ok(true)
    }
}
