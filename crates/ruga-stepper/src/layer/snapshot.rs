//! A layer as others see it.

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};

use super::Layer;
use crate::local_skin::uv;
use crate::{ComputedMesh, LayerSurface};

impl Layer {
    /// The layer as others see it: over `region_below`, which is what lies below the region's own
    /// mesh, and the driver's `control` points.
    pub(crate) fn snapshot(
        &self,
        driver: &Driver,
        control: &[Vector3<f64>],
        region_below: &PosedSurface,
        offset: f64,
    ) -> LayerSurface {
        let own = &self.positions[..self.vertex_count()];
        let computed = self.computed(driver, own);
        let below = self.region.skin.points.pose(control);
        LayerSurface {
            name: self.spec.name.clone(),
            positions: self.on_region(&region_below.positions, self.deviations()),
            driver_positions: below.positions,
            driver_normals: below.normals,
            offset,
            faces: self.region.skin.corner_indices(),
            uvs: self.region.shown_uvs().to_vec(),
            artist: self.region.artist(),
            computed,
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
        let above = self
            .energy
            .laid_on(&region_below.positions, &region_below.normals);
        let above = &above[region_below.positions.len()..];
        Some(LayerSurface {
            name: upper.name.clone(),
            positions: self.on_region(above, self.upper_deviations()),
            offset: own.offset + upper.lever,
            computed: self.computed(driver, &self.positions[self.vertex_count()..]),
            ..own.clone()
        })
    }

    fn computed(&self, driver: &Driver, positions: &[Vector3<f64>]) -> ComputedMesh {
        let points = self.skin.points.points().iter();
        ComputedMesh {
            positions: positions.to_vec(),
            faces: self.skin.corner_indices(),
            uvs: points.map(|point| uv(driver, point)).collect(),
        }
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
