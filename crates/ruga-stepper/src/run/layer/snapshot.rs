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
        let positions = self.on_region(&real.positions, self.deviations());
        let weights = self.region_weights(real);
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
        let positions = self.on_region(&above.positions, self.upper_deviations());
        let relief = shown_positions(&positions, &above, &above, &self.region_weights(&above));
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

    /// Weights of the relief at the vertices of the output mesh over `surface`, with the present strain.
    fn region_weights(&self, surface: &PosedSurface) -> Vec<f64> {
        let output = self.shown();
        let demands = match &output.interpolation {
            None => self.demands(),
            Some(interpolation) => {
                let values = self.demands().into_iter();
                let values = values.map(|d| Vector3::new(d.strain_ratio, d.wavelength, d.turn));
                let values = interpolation.apply(&values.collect::<Vec<_>>()).into_iter();
                let demand = |value: Vector3<f64>| VertexDemand {
                    strain_ratio: value.x,
                    wavelength: value.y,
                    turn: value.z,
                };
                values.map(demand).collect()
            }
        };
        shown_weights(&output.weights, &output.region.skin, (&demands, surface))
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
        let demands = pairs.map(|(ratio, local)| VertexDemand::new(ratio, &local.wrinkling));
        let mut demands: Vec<_> = demands.collect();
        self.let_turn_near_slits(&mut demands);
        demands
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
        let deviations = match self.interpolation() {
            None => deviations,
            Some(interpolation) => interpolation.apply(&deviations),
        };
        let pairs = places.iter().zip(&deviations);
        pairs.map(|(place, deviation)| place + deviation).collect()
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
