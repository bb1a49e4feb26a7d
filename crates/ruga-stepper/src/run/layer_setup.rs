//! Layers as a pose needs them: their region, their mesh, their bending.

use std::sync::Arc;

use ruga_crease::TracedLine;

use crate::error::Halt;
use crate::preparing::Preparing;
use crate::run::adaptivity::{Fitting, SizingRequest};
use crate::run::layer::{
    Layer, LayerOptions, LayerView, OnOutput, Output, OutputMesh, Shape, Unmade,
};
use crate::run::layer_run::LayerRun;
use crate::run::low_pass_rows::RowCentre;
use crate::run::stack_run::StackRun;
use crate::skin::piece::Piece;
use crate::skin::refined::{Refined, refined};
use crate::skin::skin_mesh::{Adapted, RegionMesh, sharp_map};
use crate::support::support_surface::SupportOf;
use crate::{LayerSpec, Observer, Phase, StepperError};

/// Edges of a layer's output mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputEdges {
    /// Short across the wrinkles that the layer's own mesh is fitted to.
    AsFitted,
    /// As short as planned, in all directions.
    AsPlanned,
}

/// Factor on planned output edges for the mesh that a layer on others is fitted to. What strains such a layer is mostly
/// the wrinkles of those below, longer than its own. The lowest one is strained by a pose, whose borders longer
/// edges would blur: of skin squeezed in a narrow band its mesh would have a third more vertices.
const ON_WAVES: f64 = 2.0;

/// Edges longer than asked for by less than this factor are not worth a word.
const WORTH_TELLING: f64 = 1.1;

/// The layer without the lines of creases that do not fold, which keep their numbers: a mesh with edges along
/// them would be finer for nothing.
fn with_folding_lines(spec: &LayerSpec, folds: &[bool]) -> LayerSpec {
    let mut spec = spec.clone();
    for (crease, _) in spec.creases.iter_mut().zip(folds).filter(|(_, on)| !**on) {
        crease.line = TracedLine::default();
    }
    spec
}

impl<'a> StackRun<'a> {
    /// Builds layer number `index`, its mesh fitted to each surface of `support`, its
    /// bending corrected on the last; where nothing is known, fine everywhere and not corrected.
    pub(crate) fn build(
        &self,
        index: usize,
        support: &[SupportOf<'_>],
        output: OutputEdges,
        observer: &mut dyn Observer,
    ) -> Result<LayerRun<'a>, Halt> {
        let mut preparing = Preparing::new(observer, index, Phase::Sampling);
        let meshes = self.meshes(index, support, output, &mut preparing)?;
        self.build_on(index, meshes, None, support.last(), &mut preparing)
    }

    /// Output mesh of layer number `index`, and the mesh that it is solved on, fitted to each surface of `support`.
    fn meshes(
        &self,
        index: usize,
        support: &[SupportOf<'_>],
        output: OutputEdges,
        preparing: &mut Preparing<'_>,
    ) -> Result<(OutputMesh, Option<Adapted>), Halt> {
        let is_fitted = !support.is_empty() && self.is_output_fitted(index, output);
        let (region, from) = match is_fitted {
            true => self.region_with_edges(index, self.fitting_edges(index), preparing)?,
            false => self.planned_region(index, preparing)?,
        };
        preparing.enter(Phase::Remeshing)?;
        let mut surfaces = Vec::with_capacity(support.len());
        for support in support {
            surfaces.push(support(&region.skin));
            preparing.step()?;
        }
        // There is no surface where a body was not run ahead, or where that run did not arrive.
        let fitting = match surfaces.is_empty() {
            true => Fitting::Everywhere,
            false => Fitting::Surfaces(&surfaces),
        };
        let sizing = self.sizing(index, &region, fitting, preparing)?;
        preparing.step()?;
        let adapted = self.fitted(index, &region, sizing, preparing)?;
        let made = |region| OutputMesh::Made(Box::new(region));
        if !is_fitted {
            return Ok((made(region), adapted));
        }
        let fitted = adapted.as_ref();
        let Some(fitted) = fitted.filter(|adapted| adapted.skin.has_inner_vertices()) else {
            // A layer that has no inner vertex on its fitted mesh is solved on the output mesh.
            return Ok((made(self.planned_region(index, preparing)?.0), adapted));
        };
        let sizing = (&fitted.sizing, fitted.coarseness);
        let measures = region.output_measures(&from, sizing);
        let unmade = Unmade {
            whole: from.whole,
            measures,
        };
        Ok((OutputMesh::Later(Arc::new(unmade)), adapted))
    }

    /// Makes the output mesh of a layer that has none yet; false when the observer ends the work.
    pub(crate) fn make_output(
        &self,
        run: &mut LayerRun<'_>,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        let Some(unmade) = run.layer.unmade_output() else {
            return Ok(true);
        };
        let often = observer.wants_frames();
        let preparing = &mut Preparing::new(observer, run.index, Phase::Sampling);
        let made = self.made_output(run.index, &unmade, preparing);
        let made = made.map(|region| (region, unmade));
        let driver = &self.plan.driver;
        let shown = made.and_then(|made| run.layer.show_on(driver, made, often, preparing));
        Ok(Halt::unless_interrupted(shown)?.is_some())
    }

    /// The `view` of a layer on its `output` mesh, where nothing else of it will be shown; `None` when the observer
    /// ends the work.
    pub(crate) fn last_output(
        &self,
        (index, output): (usize, Output),
        view: &LayerView<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Option<(OnOutput<'static>, Shape)>, StepperError> {
        let preparing = &mut Preparing::new(observer, index, Phase::Sampling);
        let shown = match output {
            Output::Made(shown) => Ok(*shown),
            Output::Later(unmade) => {
                let made = self.made_output(index, &unmade, preparing);
                let made = made.map(|region| (region, unmade));
                made.and_then(|made| view.shown_on(&self.plan.driver, made, preparing))
            }
        };
        Ok(Halt::unless_interrupted(shown)?.map(|shown| shown.last_of(view)))
    }

    fn made_output(
        &self,
        index: usize,
        unmade: &Unmade,
        preparing: &mut Preparing<'_>,
    ) -> Result<RegionMesh, Halt> {
        let driver = &self.plan.driver;
        let (whole, measures) = (unmade.whole.clone(), &unmade.measures);
        let (piece, _) =
            preparing.while_wanted(|goes_on| refined(driver, whole, measures, goes_on))?;
        self.region(index, piece, preparing)
    }

    /// Whether the output mesh of layer number `index` has long edges along its wrinkles.
    fn is_output_fitted(&self, index: usize, output: OutputEdges) -> bool {
        let spec = &self.plan.stacking.specs[index];
        let folds = &self.plan.poses[self.pose].layers[index].creases;
        // Boundaries and folds are curves, which long edges would cut short.
        output == OutputEdges::AsFitted
            && self.plan.modelling.remesh.is_some()
            && sharp_map(spec).is_none()
            && !folds.contains(&true)
    }

    /// Output mesh of layer number `index` that is as fine as planned, and the piece that it was refined from.
    pub(crate) fn planned_region(
        &self,
        index: usize,
        preparing: &mut Preparing<'_>,
    ) -> Result<(RegionMesh, Refined), Halt> {
        self.region_with_edges(index, 1.0, preparing)
    }

    /// Edges of the mesh that layer number `index` is fitted to, over those of its planned output mesh.
    fn fitting_edges(&self, index: usize) -> f64 {
        let layers = &self.plan.poses[self.pose].layers;
        let lowest = layers.iter().position(|layer| !layer.region.is_empty());
        match lowest == Some(index) {
            true => 1.0,
            false => ON_WAVES,
        }
    }

    /// Mesh of the region of layer number `index` with edges up to `coarseness` times as long as those planned for
    /// its output mesh, and the piece that it was refined from.
    fn region_with_edges(
        &self,
        index: usize,
        coarseness: f64,
        preparing: &mut Preparing<'_>,
    ) -> Result<(RegionMesh, Refined), Halt> {
        let plan = self.plan;
        let (layer, is_half) = (&plan.poses[self.pose].layers[index], self.spec().half);
        let (fine, from) = preparing
            .while_wanted(|goes_on| plan.layer_pieces((layer, is_half, coarseness), goes_on))?;
        Ok((self.region(index, fine, preparing)?, from))
    }

    /// Builds layer number `index` on a mesh that is fine enough for its large shape alone.
    pub(crate) fn build_coarse(
        &self,
        index: usize,
        observer: &mut dyn Observer,
    ) -> Result<LayerRun<'a>, Halt> {
        let mut preparing = Preparing::new(observer, index, Phase::Sampling);
        let (region, _) = self.planned_region(index, &mut preparing)?;
        preparing.enter(Phase::Remeshing)?;
        let sizing = self.sizing(index, &region, Fitting::LargeShape, &mut preparing)?;
        let adapted = self.fitted(index, &region, sizing, &mut preparing)?;
        // Its bending is not corrected: such a mesh has no waves to measure.
        let region = OutputMesh::Made(Box::new(region));
        self.build_on(index, (region, adapted), None, None, &mut preparing)
    }

    /// Output mesh of layer number `index` on a piece of the surface.
    fn region(
        &self,
        index: usize,
        piece: Piece,
        preparing: &mut Preparing<'_>,
    ) -> Result<RegionMesh, Halt> {
        let plan = self.plan;
        let layer = &plan.poses[self.pose].layers[index];
        let offset = plan.stacking.attachments[index].offset;
        let on = (piece, plan.modelling.smoothing, offset);
        let spec = with_folding_lines(&plan.stacking.specs[index], &layer.creases);
        let region = RegionMesh::new(&plan.driver, &spec, on, &mut || preparing.goes_on())?;
        Ok(match self.spec().half {
            true => region.halved(&plan.driver),
            false => region,
        })
    }

    /// Sizing that layer number `index` asks for on its region.
    fn sizing(
        &self,
        index: usize,
        region: &RegionMesh,
        fitting: Fitting<'_>,
        preparing: &mut Preparing<'_>,
    ) -> Result<Option<SizingRequest>, Halt> {
        let plan = self.plan;
        let layer = (&plan.stacking.specs[index], &plan.stacking.simulated[index]);
        let how = (
            &plan.modelling,
            plan.modelling.points_of(index, plan.meshes()),
        );
        SizingRequest::new(&plan.driver, layer, region, fitting, how, preparing)
    }

    /// A mesh for layer number `index` on `region`, as fine as `sizing` asks for.
    pub(crate) fn fitted(
        &self,
        index: usize,
        region: &RegionMesh,
        sizing: Option<SizingRequest>,
        preparing: &mut Preparing<'_>,
    ) -> Result<Option<Adapted>, Halt> {
        let (driver, spec) = (&self.plan.driver, &self.plan.stacking.specs[index]);
        let adapted = sizing.map(|sizing| sizing.fitted(driver, spec, region, preparing));
        adapted.transpose()
    }

    /// Builds layer number `index` on a mesh of `region`, its averaging
    /// constraints around given `centres`, its bending corrected for `support`.
    pub(crate) fn build_on(
        &self,
        index: usize,
        (output, adapted): (OutputMesh, Option<Adapted>),
        centres: Option<Vec<RowCentre>>,
        support: Option<&SupportOf<'_>>,
        preparing: &mut Preparing<'_>,
    ) -> Result<LayerRun<'a>, Halt> {
        let plan = self.plan;
        let (driver, modelling) = (&plan.driver, &plan.modelling);
        let spec = &plan.stacking.specs[index];
        let wrinkling = &plan.stacking.simulated[index];
        let coarseness = adapted.as_ref().map_or(1.0, |adapted| adapted.coarseness);
        let adapted = adapted.map(|adapted| adapted.skin);
        preparing.enter(Phase::Constraints)?;
        let options = LayerOptions {
            tangential: plan.stacking.attachments[index].tangential,
            upper: plan.stacking.joint.clone(),
            bending: modelling.bending,
            centres,
            sample: modelling.sample,
            interior: match index == 0 {
                true => plan.body.clone(),
                false => None,
            },
        };
        let mut layer = Layer::new(
            driver,
            spec,
            wrinkling,
            options,
            (output, adapted),
            modelling.seed,
            preparing,
        )?;
        preparing.step()?;
        let mut is_measured = true;
        if let Some(support) = support {
            let surface = support(layer.skin());
            preparing.step()?;
            is_measured = layer.calibrate_bending(surface)?;
            preparing.step()?;
        }
        let planned = &plan.poses[self.pose].layers[index];
        let points = modelling.points_of(index, plan.meshes());
        let mut run = LayerRun::new(index, layer, planned, (modelling, points));
        let name = |line: usize| format!("crease '{}'", spec.creases[line].name);
        // Only meshes that are made at once have creases.
        let shared = match run.layer.unmade_output() {
            None => &run.layer.region().shared[..],
            Some(_) => &[],
        };
        let shared: Vec<String> = shared.iter().map(|warning| warning.told(&name)).collect();
        run.warnings.extend(shared);
        preparing.step()?;
        if coarseness > WORTH_TELLING {
            run.warnings.push(format!(
                "the vertex budget of {} leaves {:.1} points per wavelength of {} asked for; raise `driver.vertex_budget`, or simulate less skin with a mask",
                modelling.vertex_budget,
                points / coarseness,
                points
            ));
        }
        if !is_measured {
            run.warnings.push(
                "how stiffly its mesh bends could not be measured; wavelengths may be off by some per cent, less with a finer `--quality`".to_owned(),
            );
        }
        Ok(run)
    }

    /// The layer on a mesh that resolves what `support` now asks for: its own, or where too much has
    /// changed a new one to which its shape is carried over.
    pub(crate) fn refitted(
        &self,
        mut run: LayerRun<'a>,
        support: &SupportOf<'_>,
        output: OutputEdges,
        observer: &mut dyn Observer,
    ) -> Result<LayerRun<'a>, Halt> {
        let index = run.index;
        let mut preparing = Preparing::new(observer, index, Phase::Remeshing);
        let region = run.layer.region();
        let surface = support(&region.skin);
        preparing.step()?;
        let sizing = self.sizing(index, region, Fitting::Surfaces(&[surface]), &mut preparing)?;
        preparing.step()?;
        if sizing
            .as_ref()
            .map_or(Ok(true), |sizing| sizing.are_met_by(&run.layer))?
        {
            return Ok(run);
        }
        let ratios = run.layer.strain_ratios().all();
        // Deviations can be carried over only between meshes that lie on the same surface.
        run.layer.set_support(support(run.layer.skin()), 1.0)?;
        // The same places are averaged on every mesh. Centres chosen anew would hold the layer
        // elsewhere, and its shape would jump.
        let centres = Some(run.layer.row_centres().to_vec());
        let wanted = match self.is_output_fitted(index, output) {
            true => {
                drop(sizing);
                let supports = std::slice::from_ref(support);
                self.meshes(index, supports, output, &mut preparing)?
            }
            // What is as fine as planned stays as it is.
            false => {
                let region = run.layer.region();
                let adapted = self.fitted(index, region, sizing, &mut preparing)?;
                (run.layer.output_mesh(), adapted)
            }
        };
        let mut fitted = self.build_on(index, wanted, centres, Some(support), &mut preparing)?;
        preparing.enter(Phase::Remeshing)?;
        fitted
            .layer
            .set_support(support(fitted.layer.skin()), 1.0)?;
        let is_taken = fitted
            .layer
            .take_shape(&run.layer, &ratios, &mut || preparing.goes_on())?;
        if !is_taken {
            return Err(Halt::Interrupted);
        }
        fitted.take_history(run);
        Ok(fitted)
    }
}
