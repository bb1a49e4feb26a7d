//! A plan face by face, as pictures show it.

use crate::plan::planned_layers;
use crate::plan::planning_surface::{PlannedFace, PlanningSurface};
use crate::plan::pose_plan::PlannedLayer;
use crate::{Plan, StepperError};

/// The surface that a plan was made on, to look at it face by face.
pub struct PlannedSurface<'a> {
    plan: &'a Plan,
    surface: PlanningSurface<'a>,
    layers: Vec<PlannedLayer<'a>>,
}

impl Plan {
    /// The surface that the plan was made on, measured anew; `None` on a soft body and of a sheet, whose strain is known
    /// only when it is simulated.
    ///
    /// # Errors
    /// As [`plan`](crate::plan), which has found none.
    pub fn surface(&self) -> Result<Option<PlannedSurface<'_>>, StepperError> {
        if self.body.is_some() || self.sheet.is_some() {
            return Ok(None);
        }
        // The size of maps is not asked for here.
        let surface = PlanningSurface::new(&self.driver, &self.stacking, &self.modelling, 1)?;
        Ok(Some(PlannedSurface {
            layers: planned_layers(&surface, &self.stacking, &self.modelling)?,
            plan: self,
            surface,
        }))
    }
}

impl PlannedSurface<'_> {
    /// What pose number `pose` asks of layer number `layer` on every face; empty for a layer that moves
    /// together with the lowest one and has no mesh of its own.
    ///
    /// # Panics
    /// When there is no pose of that number.
    pub fn faces(&self, pose: usize, layer: usize) -> Vec<PlannedFace> {
        let (spec, planned) = (&self.plan.specs[pose], &self.plan.poses[pose]);
        self.layers.get(layer).map_or_else(Vec::new, |own| {
            let path = (spec, planned.path);
            self.surface
                .planned_faces(own, path, &planned.layers[layer])
        })
    }
}
