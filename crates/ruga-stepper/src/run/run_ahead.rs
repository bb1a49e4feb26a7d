//! A first run on a coarse mesh, which finds out where a body goes.

use nalgebra::Vector3;

use crate::error::Halt;
use crate::run::adaptivity::COARSEST;
use crate::run::layer::Layer;
use crate::run::layer_run::{Course, Ending, LayerRun};
use crate::run::stack_run::{Place, StackRun};
use crate::support::motion::Inertia;
use crate::{LayerReport, Observer, Phase, Preparation, Progress, StepperError};

/// Where the nodes of a body are at every key of a pose, m.
pub(super) type Places = Vec<Vec<Vector3<f64>>>;

impl<'a> StackRun<'a> {
    /// Whether a mesh for the large shape alone would be coarser than the layer's own.
    pub(super) fn can_run_ahead(&self, lowest: usize) -> bool {
        let points = self.plan.modelling.points_of(lowest, self.plan.meshes());
        points * COARSEST > 1.0
    }

    /// Where the nodes of a body go at every key, found with a layer whose mesh is too coarse for
    /// wrinkles, and the work that it took; nothing where not all keys were reached.
    ///
    /// A driver says beforehand where skin will be compressed, a body does not.
    pub(super) fn run_ahead(
        &self,
        lowest: usize,
        observer: &mut dyn Observer,
    ) -> Result<(Places, LayerReport), Halt> {
        let mut run = self.build_coarse(lowest, observer)?;
        let mut course = AheadCourse {
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
        match run.follow(&mut course, (&loads, self.spec().steps), &mut ahead)? {
            Ending::Reached => Ok((course.places, run.report)),
            Ending::GaveUp => Ok((Vec::new(), run.report)),
            Ending::Interrupted => Err(Halt::Interrupted),
        }
    }
}

/// The course of a run that only finds out where a body goes.
struct AheadCourse<'r, 'a> {
    stack: &'r StackRun<'a>,
    lowest: usize,
    /// Where its nodes are at every key, m.
    places: Places,
}

impl Course for AheadCourse<'_, '_> {
    fn place(
        &self,
        layer: &mut Layer,
        load: f64,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
        let place = Place {
            weight: load,
            share: 1.0,
        };
        self.stack.place(self.lowest, layer, place, inertia)
    }

    fn shown(&self, load: f64) -> f64 {
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
        run: &LayerRun<'_>,
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
