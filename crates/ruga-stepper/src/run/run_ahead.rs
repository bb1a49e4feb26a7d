//! A first run on a coarse mesh, which finds out where a body goes.

use nalgebra::Vector3;

use crate::error::Halt;
use crate::run::adaptivity::COARSEST;
use crate::run::layer::Layer;
use crate::run::layer_run::{Ending, LayerRun, Loading};
use crate::run::stack_run::{LoadPoint, StackRun};
use crate::support::motion::Inertia;
use crate::{LayerReport, Observer, Phase, Preparation, Progress, StepperError};

/// Positions of the nodes of a body at every key of a pose, m.
pub(super) type Places = Vec<Vec<Vector3<f64>>>;

impl<'a> StackRun<'a> {
    /// Whether a mesh for the large shape alone would be coarser than the layer's own.
    pub(super) fn can_run_ahead(&self, lowest: usize) -> bool {
        let points = self.plan.modelling.points_of(lowest, self.plan.meshes());
        points * COARSEST > 1.0
    }

    /// Positions of the nodes of a body at every key, found with a layer whose mesh is too coarse for
    /// wrinkles, and the work that it took; nothing where not all keys were reached.
    ///
    /// A driver says beforehand where skin will be compressed, a body does not.
    pub(super) fn run_ahead(
        &self,
        lowest: usize,
        observer: &mut dyn Observer,
    ) -> Result<(Places, LayerReport), Halt> {
        let mut run = self.build_coarse(lowest, observer)?;
        let mut loading = CoarseLoading {
            stack: self,
            lowest,
            places: Vec::new(),
        };
        let loads = self.loads(None);
        let mut ahead = Ahead {
            observer,
            layer: lowest,
            steps: 0,
        };
        match run.follow(&mut loading, (&loads, self.spec().steps), &mut ahead)? {
            Ending::Reached => Ok((loading.places, run.report)),
            // A mesh fitted to the keys that were reached would be too coarse at the others.
            Ending::GaveUp => Ok((Vec::new(), run.report)),
            Ending::Interrupted => Err(Halt::Interrupted),
        }
    }
}

/// The loading of a run that only finds out where a body goes.
struct CoarseLoading<'r, 'a> {
    stack: &'r StackRun<'a>,
    lowest: usize,
    /// Positions of its nodes at every key, m.
    places: Places,
}

impl Loading for CoarseLoading<'_, '_> {
    fn place(
        &self,
        layer: &mut Layer,
        load: f64,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
        let point = LoadPoint {
            weight_fraction: load,
            strain_fraction: 1.0,
        };
        self.stack.place(self.lowest, layer, point, inertia)
    }

    fn pose_fraction(&self, load: f64) -> f64 {
        load
    }

    fn is_result(&self, _: f64) -> bool {
        // A rough state says where skin will be compressed.
        false
    }

    fn rests_at(&self, _: f64) -> bool {
        false
    }

    fn kept(
        &mut self,
        run: &mut LayerRun<'_>,
        load: f64,
        _: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        if self.stack.spec().has_key(load) {
            self.places
                .extend(run.layer.solid().map(|solid| solid.state.q.clone()));
        }
        Ok(true)
    }
}

/// Passes a run on as steps of the preparation of a layer.
struct Ahead<'o> {
    observer: &'o mut dyn Observer,
    layer: usize,
    steps: usize,
}

impl Ahead<'_> {
    fn goes_on(&mut self) -> bool {
        self.steps += 1;
        self.observer.preparing(Preparation {
            layer: self.layer,
            phase: Phase::Remeshing,
            step: self.steps,
        })
    }
}

impl Observer for Ahead<'_> {
    fn phase(&mut self, layer: usize, _: Phase) {
        // Whatever it does, it serves the mesh.
        self.observer.phase(layer, Phase::Remeshing);
    }

    fn preparing(&mut self, _: Preparation) -> bool {
        self.goes_on()
    }

    fn progress(&mut self, _: Progress) -> bool {
        self.goes_on()
    }

    fn wants_frames(&self) -> bool {
        false
    }
}
