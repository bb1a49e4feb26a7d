//! A layer as others see it.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};
use ruga_mesh::{FaceId, vertex_means};

use super::Layer;
use crate::skin::quiet::{VertexDemand, wrinkled_shares};
use crate::skin::relief::{ReliefWeights, shown_positions};
use crate::skin::skin_mesh::SkinMesh;
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
        let region = self.region();
        let surface = support.pose(&region.skin);
        // The support surface is known on the output mesh itself. Only the deviation from it is
        // carried over from the layer's coarser mesh, so that smooth parts of the region stay
        // exact.
        let (positions, weights) = self.on_region(real, self.deviations());
        let relief = shown_positions(&positions, real, shown, &weights);
        LayerSurface {
            name: self.spec.name.clone(),
            relief: region.on_both_sides(relief),
            positions: region.on_both_sides(positions),
            driver_positions: region.on_both_sides(surface.positions),
            driver_normals: region.on_both_sides(surface.normals),
            offset,
            faces: Arc::clone(region.shown_faces()),
            uvs: Arc::clone(region.shown_uvs()),
            artist: Arc::clone(region.artist()),
            computed,
            face_states: None,
            burnt: None,
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
        let (positions, weights) = self.on_region(&above, self.upper_deviations());
        let relief = shown_positions(&positions, &above, &above, &weights);
        Some(LayerSurface {
            name: upper.name.clone(),
            relief: self.region().on_both_sides(relief),
            positions: self.region().on_both_sides(positions),
            offset: own.offset + upper.offset,
            computed: ComputedMesh::new(driver, &self.skin, &self.positions[self.vertex_count()..]),
            ..own.clone()
        })
    }

    /// Positions of the layer's own vertices as maps show them, over the support surface as maps
    /// show that.
    pub(crate) fn shown_positions(&self, shown: &PosedSurface) -> Vec<Vector3<f64>> {
        let own = &self.positions[..self.vertex_count()];
        let weights = shown_weights(
            &self.weights,
            &self.skin,
            (&self.demands(), &self.support.posed),
        );
        shown_positions(own, &self.support.posed, shown, &weights)
    }

    /// What the support surface asks of the layer, or of the softer of two that move together, at the
    /// vertices of its own mesh: the mean over the faces there.
    fn demands(&self) -> Vec<VertexDemand> {
        let ratios = self.strain_ratios();
        let upper = self.upper.as_ref();
        let upper = upper.map_or(f64::INFINITY, |upper| upper.critical_strain());
        let of_face = |face: FaceId| {
            let critical = self.properties.faces[face].wrinkling.critical_strain;
            ratios.of_face(face) * critical / critical.min(upper)
        };
        let mut means = vertex_means(&self.skin.mesh, of_face).into_vec();
        self.raise_near_creases(&mut means, 1.0);
        let pairs = means.into_iter().zip(&self.properties.vertices);
        pairs
            .map(|(ratio, local)| VertexDemand::new(ratio, &local.wrinkling))
            .collect()
    }

    /// Support surface of the layer's own mesh.
    pub(crate) fn support(&self) -> &PosedSurface {
        &self.support.posed
    }

    /// Positions on the output mesh (m) for `deviations` (m) at the layer's vertices from `surface`, and weights of the
    /// relief there with the present strain.
    fn on_region(
        &self,
        surface: &PosedSurface,
        deviations: Vec<Vector3<f64>>,
    ) -> (Vec<Vector3<f64>>, Vec<f64>) {
        let shown = self.shown();
        let demands = self.demands();
        let (deviations, demands) = match &shown.interpolation {
            None => (deviations, demands),
            Some(interpolation) => {
                let values = demands.iter();
                let values = values.map(|d| Vector3::new(d.strain_ratio, d.wavelength, d.turn));
                let values: Vec<_> = values.collect();
                let [deviations, values] = interpolation.apply_each([&deviations, &values]);
                let demand = |value: Vector3<f64>| VertexDemand {
                    strain_ratio: value.x,
                    wavelength: value.y,
                    turn: value.z,
                };
                (deviations, values.into_iter().map(demand).collect())
            }
        };
        let weights = shown_weights(&shown.weights, &shown.region.skin, (&demands, surface));
        let pairs = surface.positions.iter().zip(&deviations);
        let positions = pairs.map(|(place, deviation)| place + deviation).collect();
        (positions, weights)
    }
}

/// Weights of the relief at the vertices of a mesh, with what the surface below asks for there.
fn shown_weights(
    own: &ReliefWeights,
    skin: &SkinMesh,
    (demands, surface): (&[VertexDemand], &PosedSurface),
) -> Vec<f64> {
    let places = (skin.rest.positions.as_slice(), surface.normals.as_slice());
    let shares = wrinkled_shares(&skin.mesh, places, demands, &own.is_cut);
    let pairs = own.weights.iter().zip(shares);
    pairs.map(|(weight, share)| weight * share).collect()
}
