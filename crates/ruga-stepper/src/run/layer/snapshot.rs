//! A layer as others see it.

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};

use super::Layer;
use crate::skin::relief::shown_positions;
use crate::support::Support;
use crate::{ComputedMesh, LayerSurface};

impl Layer {
    /// The layer as others see it: over `real`, which is what lies below the region's own mesh, or as
    /// maps show that, over `shown`, and the `support` of all layers.
    pub(crate) fn snapshot(
        &self,
        (driver, support): (&Driver, &dyn Support),
        (real, shown): (&PosedSurface, &PosedSurface),
        offset: f64,
    ) -> LayerSurface {
        let own = &self.positions[..self.vertex_count()];
        let computed = ComputedMesh::new(driver, &self.skin, own);
        let surface = support.pose(&self.region.skin);
        // The support surface is known on the output mesh itself. Only the deviation from it is
        // carried over from the layer's coarser mesh, so that smooth parts of the region stay
        // exact.
        let positions = self.on_region(&real.positions, self.deviations());
        LayerSurface {
            name: self.spec.name.clone(),
            relief: shown_positions(&positions, real, shown, &self.weights.region),
            positions,
            driver_positions: surface.positions,
            driver_normals: surface.normals,
            offset,
            faces: self.region.skin.corner_indices(),
            uvs: self.region.shown_uvs().to_vec(),
            artist: self.region.artist(),
            computed,
            face_states: None,
        }
    }

    /// The layer that moves together with this one, of which `own` is the [`Self::snapshot`].
    pub(crate) fn upper_snapshot(
        &self,
        driver: &Driver,
        own: &LayerSurface,
        region_below: &PosedSurface,
    ) -> Option<LayerSurface> {
        let upper = self.upper.as_ref()?;
        let above = upper.above(&region_below.positions, &region_below.normals);
        let above = PosedSurface {
            positions: above.collect(),
            ..region_below.clone()
        };
        let positions = self.on_region(&above.positions, self.upper_deviations());
        Some(LayerSurface {
            name: upper.name.clone(),
            relief: shown_positions(&positions, &above, &above, &self.weights.region),
            positions,
            offset: own.offset + upper.offset,
            computed: ComputedMesh::new(driver, &self.skin, &self.positions[self.vertex_count()..]),
            ..own.clone()
        })
    }

    /// Positions of the layer's own vertices as maps show them, over the support surface as maps
    /// show that.
    pub(crate) fn shown_positions(&self, shown: &PosedSurface) -> Vec<Vector3<f64>> {
        let own = &self.positions[..self.vertex_count()];
        shown_positions(own, &self.support.posed, shown, &self.weights.computed)
    }

    /// Support surface of the layer's own mesh.
    pub(crate) fn support(&self) -> &PosedSurface {
        &self.support.posed
    }

    /// Deviations at the layer's vertices, added to places of the region's.
    fn on_region(
        &self,
        places: &[Vector3<f64>],
        deviations: Vec<Vector3<f64>>,
    ) -> Vec<Vector3<f64>> {
        let deviations = match &self.interpolation {
            None => deviations,
            Some(interpolation) => interpolation.apply(&deviations),
        };
        let pairs = places.iter().zip(&deviations);
        pairs.map(|(place, deviation)| place + deviation).collect()
    }
}
