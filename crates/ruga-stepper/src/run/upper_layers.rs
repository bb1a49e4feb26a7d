//! Layers that lie on others, solved on what those have become.

use std::rc::Rc;

use nalgebra::Vector3;

use crate::error::Halt;
use crate::run::layer::Layer;
use crate::run::layer_run::{Ending, LayerRun, Loading};
use crate::run::layer_setup::OutputEdges;
use crate::run::stack_run::{LoadPoint, StackRun};
use crate::skin::cover::Covers;
use crate::support::Support;
use crate::support::motion::Inertia;
use crate::support::support_surface::{
    LowerLayer, SupportOf, SupportSurface, as_shown, posed_below, support_surface,
};
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
        let mut solved: Vec<(LayerRun<'a>, Ending)> = Vec::new();
        // Where every layer's vertices are as maps show them, the lowest layer's first.
        let mut shown = vec![run.layer.shown_positions(run.layer.support())];
        for index in lowest + 1..self.plan.stacking.specs.len() {
            if self.plan.poses[self.pose].layers[index].region.is_empty() {
                continue;
            }
            let runs = std::iter::once(run).chain(solved.iter().map(|(run, _)| run));
            let lower = runs.zip(&shown);
            let lower: Vec<LowerLayer<'_>> = lower
                .map(|(run, shown)| self.lower(run, shown, &covers))
                .collect();
            let made = self.upper_layer(index, &lower, point, support, observer);
            let Some((mut upper, ending)) = Halt::unless_interrupted(made)? else {
                return Ok(None);
            };
            let last = self.spec().keys.iter().copied().fold(0.0, f64::max);
            // What stays smooth at an earlier key may wrinkle by the last one.
            if ending == Ending::Reached && point.weight_fraction >= last {
                upper.warn_unwrinkled(&self.plan.driver);
            }
            upper.measure();
            self.tell(&upper, ending);
            if ending == Ending::Interrupted {
                return Ok(None);
            }
            if !self.make_output(&mut upper, observer)? {
                return Ok(None);
            }
            observer.phase(index, Phase::Sampling);
            surfaces.extend(self.snapshot(&upper, support, &lower, observer));
            let attachment = self.plan.stacking.attachments[index];
            let skin = upper.layer.skin();
            // Maps show a layer on those below as maps show them, which may be flatter than they
            // are.
            let on = (self.plan.driver.as_ref(), support);
            let surface = posed_below(on, skin, attachment, &as_shown(&lower));
            shown.push(upper.layer.shown_positions(&surface));
            self.result.layers[index] = upper.report.clone();
            solved.push((upper, ending));
        }
        // From a state that is none, nothing goes on.
        for (run, _) in solved.into_iter().filter(|(_, e)| *e == Ending::Reached) {
            let index = run.index;
            self.upper[index] = Some(run);
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
            support: support_of(run.layer.skin()),
            weight: point.weight_fraction,
        };
        run.reach_all(None, &mut loading, &[1.0], observer)
    }

    fn lower<'r>(
        &self,
        run: &'r LayerRun<'_>,
        shown: &'r [Vector3<f64>],
        covers: &'r Covers,
    ) -> LowerLayer<'r> {
        LowerLayer {
            skin: run.layer.skin(),
            positions: run.layer.positions(),
            shown,
            offset: self.plan.stacking.attachments[run.index].offset,
            covers,
        }
    }

    /// The layer, and one that moves together with it, as others see them.
    pub(crate) fn snapshot(
        &self,
        run: &LayerRun<'_>,
        support: &dyn Support,
        lower: &[LowerLayer<'_>],
        observer: &dyn Observer,
    ) -> Vec<LayerSurface> {
        let (driver, layer) = (&self.plan.driver, &run.layer);
        let attachment = self.plan.stacking.attachments[run.index];
        let region = &layer.region().skin;
        let on = (driver.as_ref(), support);
        let on_region = layer.on_region();
        let surface = posed_below(on, region, attachment, lower);
        // Maps show driver or body as they are.
        let shown =
            (!lower.is_empty()).then(|| posed_below(on, region, attachment, &as_shown(lower)));
        let below = (&surface, shown.as_ref().unwrap_or(&surface));
        let mut surfaces = layer.snapshots(on, on_region, below, attachment.offset);
        if observer.wants_face_states() {
            for (surface, states) in surfaces.iter_mut().zip(layer.face_states()) {
                surface.face_states = Some(states);
            }
        }
        surfaces
    }
}

/// Loading of an upper layer, whose one load is what it lies on.
struct CarriedLoading {
    support: SupportSurface,
    weight: f64,
}

impl Loading for CarriedLoading {
    fn place(&self, layer: &mut Layer, load: f64, _: Option<&Inertia>) -> Result<(), StepperError> {
        layer.set_support(self.support.clone(), load)
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
