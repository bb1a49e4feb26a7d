//! The same layer on a coarser mesh, to find its pattern on.

use crate::error::Halt;
use crate::preparing::Preparing;
use crate::run::adaptivity::{Fitting, SizingRequest};
use crate::run::layer_run::LayerRun;
use crate::run::stack_run::StackRun;
use crate::support::support_surface::SupportOf;
use crate::{Observer, Phase};

/// Points per wavelength of the coarse mesh: with fewer, patterns are those of a coarse mesh on the fine
/// one, too. A film of 24 points then has twice the error in its normals.
const POINTS: f64 = 12.0;

/// Share of the points asked for, and of the vertices that a budget leaves of them, up to which a coarse mesh
/// is worth being used.
const WORTH_IT: f64 = 0.6;

impl<'a> StackRun<'a> {
    /// The layer of `run` at rest on a coarser mesh, fitted to its surface on each of `supports`; `None`
    /// where it is on a coarse one, or cannot be on another.
    pub(crate) fn coarser(
        &self,
        run: &LayerRun<'a>,
        supports: &[SupportOf<'_>],
        observer: &mut dyn Observer,
    ) -> Result<Option<LayerRun<'a>>, Halt> {
        let (plan, index) = (self.plan, run.index);
        let asked = plan.modelling.points_of(index, plan.meshes());
        let is_alone = run.layer.upper().is_none() && run.layer.solid().is_none();
        if !is_alone || !run.layer.is_fitted() || POINTS > WORTH_IT * asked {
            return Ok(None);
        }
        let mut preparing = Preparing::new(observer, index, Phase::Remeshing);
        // The output mesh may have long triangles, over which directions do not spread evenly.
        let (region, _) = self.planned_region(index, &mut preparing)?;
        let surfaces: Vec<_> = supports.iter().map(|of| of(&region.skin)).collect();
        preparing.step()?;
        let sizing = SizingRequest::new(
            &plan.driver,
            (&plan.stacking.specs[index], &plan.stacking.simulated[index]),
            &region,
            Fitting::Surfaces(&surfaces),
            (&plan.modelling, POINTS),
            &mut preparing,
        )?;
        // Centres of its own would hold it elsewhere than the finer mesh is held.
        let centres = Some(run.layer.row_centres().to_vec());
        let adapted = self.fitted(index, &region, sizing, &mut preparing)?;
        // Nothing of a mesh that is all border moves.
        let fitted = adapted.as_ref();
        if !fitted.is_some_and(|adapted| adapted.skin.has_inner_vertices()) {
            return Ok(None);
        }
        let wanted = (run.layer.output_mesh(), adapted);
        let mut coarse = self.build_on(index, wanted, centres, supports.last(), &mut preparing)?;
        coarse.is_coarse = true;
        let most = WORTH_IT * run.layer.vertex_count() as f64;
        Ok((coarse.layer.vertex_count() as f64 <= most).then_some(coarse))
    }
}
