//! Layers that lie on others, solved on what those have become.

use std::borrow::Cow;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::error::Halt;
use crate::run::layer::{Layer, LayerView, OnOutput, Shape};
use crate::run::layer_run::{Ending, LayerRun, Loading};
use crate::run::layer_setup::OutputEdges;
use crate::run::stack_run::{LoadPoint, StackRun};
use crate::skin::cover::Covers;
use crate::skin::skin_mesh::SkinMesh;
use crate::support::Support;
use crate::support::motion::Inertia;
use crate::support::support_surface::{
    LowerLayer, SupportOf, SupportSurface, as_shown, support_surface,
};
use crate::support::surface_below::SurfaceBelow;
use crate::{LayerSurface, Observer, Phase, StepperError};

impl<'a> StackRun<'a> {
    /// Solves the layers above `lowest` one on the other; `None` when the observer ends the work.
    pub(crate) fn upper_layers(
        &mut self,
        lowest: usize,
        run: &LayerRun<'_>,
        point: LoadPoint,
        support: &dyn Support,
        observer: &mut dyn Observer,
    ) -> Result<Option<Vec<LayerSurface>>, StepperError> {
        let covers = Rc::clone(&self.covers);
        let mut surfaces = Vec::new();
        let mut solved: Vec<SolvedLayer<'a>> = Vec::new();
        // Where every layer's vertices are as maps show them, the lowest layer's first.
        let mut shown = vec![self.shown_positions(run.index, &run.layer.view(), support, &[])];
        let last = self.spec().keys.iter().copied().fold(0.0, f64::max);
        let is_last = point.weight_fraction >= last;
        for index in lowest + 1..self.plan.stacking.specs.len() {
            if self.plan.poses[self.pose].layers[index].region.is_empty() {
                continue;
            }
            let on_lowest = (run.index, run.layer.skin(), run.layer.positions());
            let runs = std::iter::once(on_lowest).chain(solved.iter().map(SolvedLayer::shape));
            let lower = runs.zip(&shown);
            let lower: Vec<LowerLayer<'_>> = lower
                .map(|(shape, shown)| self.lower(shape, shown, &covers))
                .collect();
            let made = self.upper_layer(index, &lower, point, support, observer);
            let Some((mut upper, ending)) = Halt::unless_interrupted(made)? else {
                return Ok(None);
            };
            // What stays smooth at an earlier key may wrinkle by the last one.
            if ending == Ending::Reached && is_last {
                upper.warn_unwrinkled(&self.plan.driver);
            }
            upper.measure();
            self.tell(&upper, ending);
            if ending == Ending::Interrupted {
                return Ok(None);
            }
            // From a state that is none, nothing goes on. An output mesh takes as much memory as what solves a layer.
            let is_over = ending != Ending::Reached || (is_last && !observer.wants_frames());
            let report = upper.report.clone();
            // States of faces are found from what solved the layer.
            let shown_layer = match is_over && !observer.wants_face_states() {
                true => self.show_last(upper, support, &lower, observer)?,
                false => self.show_kept((upper, ending), support, &lower, observer)?,
            };
            let Some((upper, of_upper, own)) = shown_layer else {
                return Ok(None);
            };
            self.result.layers[index] = report;
            surfaces.extend(of_upper);
            shown.push(own);
            solved.push(upper);
        }
        for solved in solved {
            if let SolvedLayer::Kept(run, Ending::Reached) = solved {
                let index = run.index;
                self.upper[index] = Some(*run);
            }
        }
        Ok(Some(surfaces))
    }

    /// Solves one layer on the `lower` ones, bottom first: from its last shape if there is one from which the
    /// equilibrium can be reached, else from none.
    fn upper_layer(
        &mut self,
        index: usize,
        lower: &[LowerLayer<'_>],
        point: LoadPoint,
        support: &dyn Support,
        observer: &mut dyn Observer,
    ) -> Result<(LayerRun<'a>, Ending), Halt> {
        let attachment = self.plan.stacking.attachments[index];
        let last = self.upper[index].take();
        let driver = &self.plan.driver;
        let growth = self.growth(index);
        let support_of: SupportOf<'_> = Box::new(move |skin| {
            let surface = support_surface((driver, support), skin, attachment, lower);
            surface.grown(growth.on_skin(driver, skin, point.weight_fraction))
        });
        let mut history = None;
        // All frames show one mesh, whatever wrinkles in them.
        let output = match observer.wants_frames() {
            true => OutputEdges::AsPlanned,
            false => OutputEdges::AsFitted,
        };
        // From its last shape a layer takes some thirty factorisations, from none sixty.
        if let Some(last) = last {
            let mut run = self.refitted(last, &support_of, output, observer)?;
            match self.reach(&mut run, &support_of, point, observer)? {
                Ending::GaveUp => history = Some(run),
                ending => return Ok((run, ending)),
            }
        }
        let supports = std::slice::from_ref(&support_of);
        let mut run = self.build(index, supports, output, observer)?;
        if let Some(history) = history {
            run.take_history(history);
        }
        let ending = self.reach(&mut run, &support_of, point, observer)?;
        Ok((run, ending))
    }

    /// Takes an upper layer to where `support_of` it is, from its present shape.
    fn reach(
        &self,
        run: &mut LayerRun<'a>,
        support_of: &SupportOf<'_>,
        point: LoadPoint,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let mut loading = CarriedLoading {
            support: support_of(run.layer.skin()).into(),
            weight: point.weight_fraction,
        };
        run.reach_all(None, &mut loading, &[1.0], observer)
    }

    fn lower<'r>(
        &self,
        (index, skin, positions): (usize, &'r SkinMesh, &'r [Vector3<f64>]),
        shown: &'r [Vector3<f64>],
        covers: &'r Covers,
    ) -> LowerLayer<'r> {
        LowerLayer {
            skin,
            positions,
            shown,
            offset: self.plan.stacking.attachments[index].offset,
            covers,
        }
    }

    /// Shows an upper layer that is solved no further, and gives up what solved it before its output mesh is made;
    /// `None` when the observer ends the work.
    fn show_last(
        &self,
        upper: LayerRun<'a>,
        support: &dyn Support,
        lower: &[LowerLayer<'_>],
        observer: &mut dyn Observer,
    ) -> Result<Option<ShownLayer<'a>>, StepperError> {
        let index = upper.index;
        let (view, output) = upper.into_view();
        let Some(output) = self.last_output((index, output), &view, observer)? else {
            return Ok(None);
        };
        observer.phase(index, Phase::Sampling);
        let surfaces = self.snapshots(index, (&view, output), support, lower);
        let shown = self.shown_positions(index, &view, support, lower);
        let (skin, positions) = view.into_shape();
        let left = SolvedLayer::Over {
            index,
            skin: Box::new(skin),
            positions,
        };
        Ok(Some((left, surfaces, shown)))
    }

    /// Shows an upper layer; `None` when the observer ends the work.
    fn show_kept(
        &self,
        (mut upper, ending): (LayerRun<'a>, Ending),
        support: &dyn Support,
        lower: &[LowerLayer<'_>],
        observer: &mut dyn Observer,
    ) -> Result<Option<ShownLayer<'a>>, StepperError> {
        if !self.make_output(&mut upper, observer)? {
            return Ok(None);
        }
        observer.phase(upper.index, Phase::Sampling);
        let surfaces = self.snapshots_of(&upper, support, lower, observer);
        let shown = self.shown_positions(upper.index, &upper.layer.view(), support, lower);
        let kept = SolvedLayer::Kept(Box::new(upper), ending);
        Ok(Some((kept, surfaces, shown)))
    }

    /// Where maps show the vertices of the mesh that layer number `index` was computed on: on the layers below as maps
    /// show these, which may be flatter than they are. Nothing where no layer lies on it.
    fn shown_positions(
        &self,
        index: usize,
        view: &LayerView<'_>,
        support: &dyn Support,
        lower: &[LowerLayer<'_>],
    ) -> Vec<Vector3<f64>> {
        let mut above = self.plan.poses[self.pose].layers[index + 1..].iter();
        if above.all(|layer| layer.region.is_empty()) {
            return Vec::new();
        }
        // Driver and body are shown as they are.
        if lower.is_empty() {
            return view.shown_positions(view.support());
        }
        let on = (&*self.plan.driver, support);
        let attachment = self.plan.stacking.attachments[index];
        let surface = SurfaceBelow::new(on, view.skin(), attachment, &as_shown(lower));
        view.shown_positions(&surface.lifted())
    }

    /// A layer as results have it, and one that moves together with it, with the states of their faces for an observer
    /// who wants them. Its output mesh has been made.
    pub(crate) fn snapshots_of(
        &self,
        run: &LayerRun<'_>,
        support: &dyn Support,
        lower: &[LowerLayer<'_>],
        observer: &dyn Observer,
    ) -> Vec<LayerSurface> {
        let view = run.layer.view();
        let on_output = run.layer.on_output(&view);
        let mut surfaces = self.snapshots(run.index, (&view, on_output), support, lower);
        if observer.wants_face_states() {
            for (surface, states) in surfaces.iter_mut().zip(run.layer.face_states()) {
                surface.face_states = Some(states);
            }
        }
        surfaces
    }

    /// The layer number `index` as results have it, and one that moves together with it.
    fn snapshots(
        &self,
        index: usize,
        (layer, (on_output, shape)): (&LayerView<'_>, (OnOutput<'_>, Shape)),
        support: &dyn Support,
        lower: &[LowerLayer<'_>],
    ) -> Vec<LayerSurface> {
        let driver = self.plan.driver.as_ref();
        let attachment = self.plan.stacking.attachments[index];
        let below = |lower: &[LowerLayer<'_>]| {
            SurfaceBelow::new((driver, support), &on_output.mesh.skin, attachment, lower)
        };
        let real = below(lower);
        // Maps show driver or body as they are.
        let shown = (!lower.is_empty()).then(|| below(&as_shown(lower)));
        let values = layer.values((&on_output, shape), (&real, shown.as_ref()));
        drop((real, shown));
        // A mesh that nothing else will be shown on.
        if let Cow::Owned(mesh) = &on_output.mesh {
            self.covers.forget(&mesh.skin);
        }
        layer.surfaces(driver, (on_output, values), attachment.offset)
    }
}

/// An upper layer, its results, and where maps show the vertices of the mesh that it was computed on.
type ShownLayer<'a> = (SolvedLayer<'a>, Vec<LayerSurface>, Vec<Vector3<f64>>);

/// An upper layer that was solved, for those above to lie on.
enum SolvedLayer<'a> {
    /// All of it: the next frame goes on from it where this one was reached.
    Kept(Box<LayerRun<'a>>, Ending),
    /// The mesh and the positions (m) of layer number `index`, which is solved no further.
    Over {
        index: usize,
        skin: Box<SkinMesh>,
        positions: Vec<Vector3<f64>>,
    },
}

impl SolvedLayer<'_> {
    /// Its number, the mesh it was solved on, and where that is.
    fn shape(&self) -> (usize, &SkinMesh, &[Vector3<f64>]) {
        match self {
            Self::Kept(run, _) => (run.index, run.layer.skin(), run.layer.positions()),
            Self::Over {
                index,
                skin,
                positions,
            } => (*index, skin, positions),
        }
    }
}

/// Loading of an upper layer, whose one load is what it lies on.
struct CarriedLoading {
    support: Arc<SupportSurface>,
    weight: f64,
}

impl Loading for CarriedLoading {
    fn place(&self, layer: &mut Layer, load: f64, _: Option<&Inertia>) -> Result<(), StepperError> {
        layer.set_support(Arc::clone(&self.support), load)
    }

    fn pose_fraction(&self, load: f64) -> f64 {
        self.weight * load
    }

    fn is_result(&self, load: f64) -> bool {
        load == 1.0
    }

    fn rests_at(&self, _: f64) -> bool {
        false
    }

    fn kept(
        &mut self,
        _: &mut LayerRun<'_>,
        _: f64,
        _: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        Ok(true)
    }
}
