//! One pose from rest to its keys, layer by layer.

use std::rc::Rc;

use nalgebra::Vector3;

use crate::error::Halt;
use crate::growth::PoseGrowth;
use crate::run::layer::Layer;
use crate::run::layer_run::{Ending, LayerRun, Loading, loads_up_to};
use crate::run::layer_setup::OutputEdges;
use crate::skin::cover::Covers;
use crate::support::motion::Inertia;
use crate::support::support_surface::{SupportOf, support_surface};
use crate::support::{Embeddings, Interior, Moves, PosedBody, PosedDriver, Solid, Support};
use crate::{
    Frame, KeyResult, LayerReport, LoadPath, Observer, Phase, Plan, PoseResult, PoseSpec,
    StepperError,
};

impl Plan {
    /// Simulates pose number `pose`, from rest to its keys.
    ///
    /// On a driver, the lowest layer that can wrinkle goes from key to key; the strain that every face
    /// feels grows through its own critical strain, so that wavelengths are chosen at the onset. For an
    /// observer who wants frames it follows the driver from rest to full weight instead, or at each key
    /// the growth of its strain ([`LoadPath`]), and a load at which it first buckles is approached by
    /// bisection. On its equilibrium the next layer is
    /// solved, from key to key as well, and so on up (Li 2014): from one result to the next it
    /// goes on from its last shape, on a mesh that is fitted anew when the old one no longer serves.
    ///
    /// On a soft body, layer and body are one minimum of all energies. A first run on a coarse mesh, part of
    /// the preparation, finds where the layer will be compressed, and so where its mesh has to be fine. Handles and obstacles go their
    /// ways and blend shapes draw the surface with growing weights; weight acts in full from the first
    /// load on, and [`KeyResult::artist_positions`] say where the artist's mesh has gone. With
    /// [`Modelling::dynamics`](crate::Modelling::dynamics) every load is one step in time instead,
    /// whole where the solver finds its end, or else in shorter ones, and nothing waits at keys for
    /// rest.
    ///
    /// A free sheet goes from load to load: from equilibrium to equilibrium, or in time. A step that has no end is
    /// divided.
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
        if let Some(sheet) = &self.sheet {
            return self.simulate_sheet(sheet, pose, observer);
        }
        let mut run = StackRun::new(self, pose)?;
        run.follow(observer)?;
        Ok(run.result)
    }

    /// Reports of the layers of pose number `pose` before they are simulated.
    pub(crate) fn reports(&self, pose: usize) -> Vec<LayerReport> {
        let layers = self.poses[pose].layers.iter();
        layers.map(LayerReport::planned).collect()
    }
}

/// A fraction of the pose's weights, and a fraction of the strain there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoadPoint {
    pub(crate) weight_fraction: f64,
    pub(crate) strain_fraction: f64,
}

/// The layers of one pose.
pub(crate) struct StackRun<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) pose: usize,
    pub(crate) result: PoseResult,
    /// The layers above the lowest one, as they were left by the last frame that had them; none after the last key
    /// where neither frames nor states of faces are wanted.
    pub(crate) upper: Vec<Option<LayerRun<'a>>>,
    /// Projections of their meshes onto those below.
    pub(crate) covers: Rc<Covers>,
    /// Places of meshes in a body.
    embeddings: Rc<Embeddings>,
    /// Motions of handles and obstacles of a body.
    moves: Option<Moves<'a>>,
}

impl<'a> StackRun<'a> {
    /// The layers of pose number `pose` at rest, none of them built.
    pub(crate) fn new(plan: &'a Plan, pose: usize) -> Result<Self, StepperError> {
        let interior = plan.body.as_ref();
        let moves = interior.map(|interior| Moves::of_body(&interior.body, &plan.specs[pose]));
        Ok(Self {
            plan,
            pose,
            result: PoseResult {
                layers: plan.reports(pose),
                converged: true,
                ..PoseResult::default()
            },
            upper: plan.stacking.specs.iter().map(|_| None).collect(),
            covers: Rc::default(),
            embeddings: Rc::default(),
            moves: moves.transpose()?,
        })
    }

    /// The pose as it was asked for.
    pub(crate) fn spec(&self) -> &'a PoseSpec {
        &self.plan.specs[self.pose]
    }

    fn follow(&mut self, observer: &mut dyn Observer) -> Result<(), StepperError> {
        let layers = &self.plan.poses[self.pose].layers;
        let Some(lowest) = layers.iter().position(|layer| !layer.region.is_empty()) else {
            let keys = self.spec().keys.iter();
            self.result.keys = keys.map(|&load| flat_key(load)).collect();
            return Ok(());
        };
        let made = self.build_lowest(lowest, observer);
        let Some(mut run) = Halt::unless_interrupted(made)? else {
            self.result.converged = false;
            self.result.interrupted = true;
            return Ok(());
        };
        let ending = match self.plan.poses[self.pose].path {
            LoadPath::Weight => self.follow_loading(lowest, &mut run, None, observer)?,
            LoadPath::Strain => self.follow_strain(lowest, &mut run, observer)?,
        };
        // Of a state that was given up, smooth places say nothing.
        if ending == Ending::Reached {
            run.warn_unwrinkled(&self.plan.driver);
        }
        run.warn_of_loading();
        run.measure();
        self.tell(&run, ending);
        if let Some(upper) = run.layer.upper() {
            let planned = &self.result.layers[upper.index];
            self.result.layers[upper.index] = run.upper_report(upper, planned);
        }
        self.result.layers[lowest] = run.report;
        Ok(())
    }

    /// Builds the lowest layer for what it will lie on at the pose's keys.
    fn build_lowest(
        &self,
        lowest: usize,
        observer: &mut dyn Observer,
    ) -> Result<LayerRun<'a>, Halt> {
        let keys = self.spec().keys.iter();
        let (supports, before) = match &self.plan.body {
            None => {
                let posed = keys.map(|&key| (key, self.posed_driver(key)));
                (posed.collect(), None)
            }
            Some(interior) => {
                // A driver says at every key where it compresses the skin. A body has to be
                // simulated for that.
                let (places, before) = match self.can_run_ahead(lowest) {
                    true => {
                        let (places, report) = self.run_ahead(lowest, observer)?;
                        (places, Some(report))
                    }
                    false => (Vec::new(), None),
                };
                let posed = keys.zip(places);
                let posed = posed.map(|(&key, q)| (key, self.posed_body(interior, q)));
                (posed.collect::<Vec<_>>(), before)
            }
        };
        let surfaces = self.surfaces(lowest, &supports);
        // How a body turns between the keys is not known.
        let output = match &self.plan.body {
            None => OutputEdges::AsFitted,
            Some(_) => OutputEdges::AsPlanned,
        };
        let mut run = self.build(lowest, &surfaces, output, observer)?;
        if let Some(before) = before {
            run.report.newton_iterations += before.newton_iterations;
            run.report.factorizations += before.factorizations;
            if surfaces.is_empty() {
                run.warn(
                    "a first run on a coarse mesh, which finds where wrinkles come, did not reach the last key: the mesh is as fine everywhere as wrinkles need, slower but no less exact, and its bending is not corrected; take more `steps` if that is too slow".to_owned(),
                );
            }
        }
        Ok(run)
    }

    /// The surfaces of `supports`, each at a fraction of the pose, below the lowest layer.
    fn surfaces<'s>(
        &'s self,
        lowest: usize,
        supports: &'s [(f64, Box<dyn Support + 'a>)],
    ) -> Vec<SupportOf<'s>> {
        let (driver, attachment) = (&self.plan.driver, self.plan.stacking.attachments[lowest]);
        let growth = self.growth(lowest);
        let surface = |(weight, support): &'s (f64, Box<dyn Support + 'a>)| -> SupportOf<'s> {
            let on = (driver.as_ref(), &**support);
            let growth = growth.clone();
            Box::new(move |skin| {
                let surface = support_surface(on, skin, attachment, &[]);
                surface.grown(growth.on_skin(driver, skin, *weight))
            })
        };
        supports.iter().map(surface).collect()
    }

    /// What the pose lets layer number `index` grow.
    pub(crate) fn growth(&self, index: usize) -> PoseGrowth<'a> {
        PoseGrowth::new(&self.plan.stacking.specs[index], self.spec())
    }

    fn posed_driver(&self, weight: f64) -> Box<dyn Support + 'a> {
        let weights = self.spec().weights.scaled(weight);
        let control = self.plan.driver.pose(&weights);
        Box::new(PosedDriver { control })
    }

    fn posed_body(&self, interior: &'a Interior, q: Vec<Vector3<f64>>) -> Box<dyn Support + 'a> {
        Box::new(PosedBody {
            interior,
            rest: self.plan.driver.rest(),
            q,
            embeddings: Rc::clone(&self.embeddings),
        })
    }

    /// Support of all layers, at a fraction of the pose that `lowest` is at.
    fn support(&self, lowest: &Layer, weight: f64) -> Box<dyn Support + 'a> {
        match (&self.plan.body, lowest.solid()) {
            (Some(interior), Some(solid)) => self.posed_body(interior, solid.state.q.clone()),
            _ => self.posed_driver(weight),
        }
    }

    /// Loads of the pose, or of the growth of its strain at one key.
    pub(crate) fn loads(&self, key: Option<f64>) -> Vec<f64> {
        let spec = self.spec();
        if key.is_some() {
            return loads_up_to(1.0, spec.steps, [1.0]);
        }
        // Beyond the last key nothing was planned for.
        let last = spec.keys.iter().copied().fold(0.0, f64::max);
        let moves = self.moves.iter();
        // Between keyframes motions are linear. A step across one would cut the corner.
        let keyframes = moves.flat_map(Moves::keyframes).filter(|&at| at < last);
        loads_up_to(last, spec.steps, spec.keys.iter().copied().chain(keyframes))
    }

    fn follow_strain(
        &mut self,
        lowest: usize,
        run: &mut LayerRun<'a>,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let at_rest = run.layer.state();
        let mut worst = Ending::Reached;
        for key in self.spec().keys.clone() {
            // The strain grows from none at every key, where the pattern of another key would be in
            // the way.
            run.layer.restore(&at_rest)?;
            match self.follow_loading(lowest, run, Some(key), observer)? {
                Ending::Reached => {}
                Ending::GaveUp => worst = Ending::GaveUp,
                Ending::Interrupted => return Ok(Ending::Interrupted),
            }
        }
        Ok(worst)
    }

    fn follow_loading(
        &mut self,
        lowest: usize,
        run: &mut LayerRun<'a>,
        key: Option<f64>,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let (loads, steps) = (self.loads(key), self.spec().steps);
        let is_plain = self.moves.is_none() && self.plan.modelling.dynamics.is_none();
        let keys = match key {
            Some(_) => vec![1.0],
            None => self.spec().keys.clone(),
        };
        let wants_frames = observer.wants_frames();
        // Nothing that moves has to be where it is between keys.
        let is_direct = is_plain && !wants_frames;
        let coarse = match is_direct {
            true => {
                // Only the one key where each has a sequence of its own.
                let wanted = key.map_or_else(|| self.spec().keys.clone(), |key| vec![key]);
                let posed = wanted.iter().map(|&key| (key, self.posed_driver(key)));
                let supports: Vec<_> = posed.collect();
                let surfaces = self.surfaces(lowest, &supports);
                match self.coarser(run, &surfaces, observer) {
                    Ok(coarse) => coarse,
                    Err(Halt::Interrupted) => return Ok(Ending::Interrupted),
                    // The fine mesh can do without.
                    Err(Halt::Failed(_)) => None,
                }
            }
            false => None,
        };
        let mut loading = PoseLoading {
            stack: self,
            lowest,
            key,
            wants_frames,
        };
        if is_direct {
            return run.reach_all(coarse, &mut loading, &keys, observer);
        }
        run.follow(&mut loading, (&loads, steps), observer)
    }

    /// Takes over what a layer's run has to say.
    pub(crate) fn tell(&mut self, run: &LayerRun<'_>, ending: Ending) {
        self.result.converged &= ending == Ending::Reached && !run.is_rough;
        self.result.interrupted |= ending == Ending::Interrupted;
        for warning in &run.warnings {
            let (pose, layer) = (&self.plan.specs[self.pose].name, &run.layer.spec.name);
            self.result.warn(pose, layer, warning);
        }
    }

    /// Puts what lies below the lowest layer there.
    pub(crate) fn place(
        &self,
        lowest: usize,
        layer: &mut Layer,
        point: LoadPoint,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
        let load = point.weight_fraction * point.strain_fraction;
        layer.draw_creases(&self.spec().weights, (load, point.strain_fraction))?;
        let driver = self.plan.driver.as_ref();
        let growth = self.growth(lowest);
        let growth = growth.on_skin(driver, layer.skin(), point.weight_fraction);
        if let Some(moves) = &self.moves {
            layer.grow(growth);
            return layer.place_solid(
                (moves, &self.spec().weights),
                point.weight_fraction,
                inertia,
            );
        }
        let attachment = self.plan.stacking.attachments[lowest];
        let support = self.posed_driver(point.weight_fraction);
        let on = (driver, support.as_ref());
        let surface = support_surface(on, layer.skin(), attachment, &[]);
        layer.set_support(surface.grown(growth), point.strain_fraction)
    }

    fn is_key(&self, point: LoadPoint) -> bool {
        point.strain_fraction == 1.0 && self.spec().has_key(point.weight_fraction)
    }

    /// Hands out what was reached at `place` by layer `lowest`, after solving the layers above.
    /// False when the observer ends the work.
    fn frame(
        &mut self,
        lowest: usize,
        run: &mut LayerRun<'_>,
        point: LoadPoint,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let is_key = self.is_key(point);
        if !is_key && !observer.wants_frames() {
            self.result.frames += 1;
            return Ok(true);
        }
        if !self.make_output(run, observer)? {
            return Ok(false);
        }
        observer.phase(lowest, Phase::Sampling);
        let support = self.support(&run.layer, point.weight_fraction);
        let mut layers = self.snapshots_of(run, support.as_ref(), &[], observer);
        if !observer.wants_frames() {
            run.layer.forget_output();
        }
        let run = &*run;
        // Before that the lowest layer has the key's place but not its wrinkles, which upper layers
        // lie on.
        if point.strain_fraction == 1.0 {
            let upper = self.upper_layers(lowest, run, point, support.as_ref(), observer)?;
            let Some(upper) = upper else { return Ok(false) };
            layers.extend(upper);
        }
        let artist_positions = run.layer.solid().map(Solid::artist_positions);
        observer.frame(&Frame {
            index: self.result.frames,
            load: point.weight_fraction * point.strain_fraction,
            layers: &layers,
            artist_positions: artist_positions.as_deref(),
        });
        self.result.frames += 1;
        if is_key {
            // A key that was reached on a way that failed later stands here already.
            let load = point.weight_fraction;
            self.result.keys.retain(|key| key.load != load);
            if let Some(last) = self.result.keys.last() {
                for (surface, before) in layers.iter_mut().zip(&last.layers) {
                    surface.share_lists(before);
                }
            }
            self.result.keys.push(KeyResult {
                load: point.weight_fraction,
                layers,
                artist_positions,
            });
        }
        Ok(true)
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

/// Loading of the lowest layer: the weights and motions of the pose, or the growing strain of one key.
struct PoseLoading<'r, 'a> {
    stack: &'r mut StackRun<'a>,
    lowest: usize,
    key: Option<f64>,
    wants_frames: bool,
}

impl PoseLoading<'_, '_> {
    fn point(&self, load: f64) -> LoadPoint {
        match self.key {
            None => LoadPoint {
                weight_fraction: load,
                strain_fraction: 1.0,
            },
            Some(weight_fraction) => LoadPoint {
                weight_fraction,
                strain_fraction: load,
            },
        }
    }
}

impl Loading for PoseLoading<'_, '_> {
    fn place(
        &self,
        layer: &mut Layer,
        load: f64,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
        let point = self.point(load);
        self.stack.place(self.lowest, layer, point, inertia)
    }

    fn pose_fraction(&self, load: f64) -> f64 {
        let point = self.point(load);
        point.weight_fraction * point.strain_fraction
    }

    fn is_result(&self, load: f64) -> bool {
        // Frames are handed out like keys, and have to be as exact.
        self.wants_frames || self.stack.is_key(self.point(load))
    }

    fn rests_at(&self, load: f64) -> bool {
        // A body's time is the load: no key waits.
        self.stack.moves.is_none() && self.stack.is_key(self.point(load))
    }

    fn kept(
        &mut self,
        run: &mut LayerRun<'_>,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let point = self.point(load);
        self.stack.frame(self.lowest, run, point, observer)
    }
}
