//! A layer as others see it.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};
use ruga_mesh::{FaceId, vertex_means};

use super::Layer;
use crate::skin::interpolation::Values;
use crate::skin::quiet::{VertexDemand, wrinkled_shares};
use crate::skin::relief::{ReliefWeights, shown_positions};
use crate::skin::skin_mesh::SkinMesh;
use crate::skin::upper_shell::UpperShell;
use crate::support::Support;
use crate::{ComputedMesh, LayerSurface};

/// Distance (wavelengths) from the plane where one half of a symmetric pose ends within which the other half counts in
/// what is shown: more than discs and fades reach.
const BESIDE_PLANE: f64 = 2.0;

/// Deviations (m) and demands at the vertices of an output mesh.
pub(crate) type OnRegion = (Vec<Vector3<f64>>, Vec<VertexDemand>);

impl Layer {
    /// The layer as others see it, and one that moves together with it: with what is known `on_region`, over `real`,
    /// which is what lies below the region's own mesh, or as maps show that, over `shown`, and the `support` of all
    /// layers.
    pub(crate) fn snapshots(
        &self,
        (driver, support): (&Driver, &dyn Support),
        (deviations, demands): OnRegion,
        (real, shown): (&PosedSurface, &PosedSurface),
        offset: f64,
    ) -> Vec<LayerSurface> {
        let own = &self.positions[..self.vertex_count()];
        let computed = ComputedMesh::new(driver, &self.skin, own);
        let region = self.region();
        let surface = support.pose(&region.skin);
        // The support surface is known on the output mesh itself. Only the deviation from it is
        // carried over from the layer's coarser mesh, so that smooth parts of the region stay
        // exact.
        let positions = sums(&real.positions, &deviations);
        let weights = self.region_weights(&demands, real);
        let relief = shown_positions(&positions, real, shown, &weights);
        let own = LayerSurface {
            name: self.spec.name.clone(),
            relief: region.on_both_sides(relief),
            positions: region.on_both_sides(positions),
            driver_positions: region.on_both_sides(surface.positions),
            driver_normals: region.on_both_sides(surface.normals),
            offset,
            faces: Arc::clone(region.shown_faces()),
            uvs: Arc::clone(region.shown_uvs()),
            artist: Arc::clone(region.artist()),
            on_plane: region.skin.on_plane.as_slice().into(),
            computed,
            face_states: None,
            burnt: None,
        };
        let upper = self.upper.as_ref();
        let upper = upper.map(|upper| self.upper_snapshot(driver, upper, (&own, real), &demands));
        std::iter::once(own).chain(upper).collect()
    }

    /// The layer `upper` that moves together with this one, of which `own` is the snapshot.
    fn upper_snapshot(
        &self,
        driver: &Driver,
        upper: &UpperShell,
        (own, region_below): (&LayerSurface, &PosedSurface),
        demands: &[VertexDemand],
    ) -> LayerSurface {
        let above = upper.above(&region_below.positions, &region_below.normals);
        let above = PosedSurface {
            positions: above.collect(),
            ..region_below.clone()
        };
        let deviations = self.upper_deviations();
        let deviations = match self.interpolation() {
            None => deviations,
            Some(interpolation) => {
                let [deviations] = interpolation.apply([Values::Vectors(&deviations)]);
                deviations
            }
        };
        let positions = sums(&above.positions, &deviations);
        let weights = self.region_weights(demands, &above);
        let relief = shown_positions(&positions, &above, &above, &weights);
        LayerSurface {
            name: upper.name.clone(),
            relief: self.region().on_both_sides(relief),
            positions: self.region().on_both_sides(positions),
            offset: own.offset + upper.offset,
            computed: ComputedMesh::new(driver, &self.skin, &self.positions[self.vertex_count()..]),
            ..own.clone()
        }
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
    fn region_weights(&self, demands: &[VertexDemand], surface: &PosedSurface) -> Vec<f64> {
        let output = self.shown();
        shown_weights(&output.weights, &output.region.skin, (demands, surface))
    }

    /// What is known of the layer at the vertices of the output mesh.
    pub(crate) fn on_region(&self) -> OnRegion {
        let (deviations, demands) = (self.deviations(), self.demands());
        let Some(interpolation) = self.interpolation() else {
            return (deviations, demands);
        };
        let values = demands.iter();
        let values = values.map(|d| Vector3::new(d.strain_ratio, d.wavelength, d.turn));
        let values: Vec<_> = values.collect();
        // Both at once: most of the work on a place serves all that is known there.
        let both = [Values::Vectors(&deviations), Values::Numbers(&values)];
        let [deviations, values] = interpolation.apply(both);
        let demand = |value: Vector3<f64>| VertexDemand {
            strain_ratio: value.x,
            wavelength: value.y,
            turn: value.z,
        };
        (deviations, values.into_iter().map(demand).collect())
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
}

/// Deviations added to places.
fn sums(places: &[Vector3<f64>], deviations: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let pairs = places.iter().zip(deviations);
    pairs.map(|(place, deviation)| place + deviation).collect()
}

/// Weights of the relief at the vertices of a mesh, with what the surface below asks for there.
fn shown_weights(
    own: &ReliefWeights,
    skin: &SkinMesh,
    (demands, surface): (&[VertexDemand], &PosedSurface),
) -> Vec<f64> {
    let longest = demands.iter().map(|d| d.wavelength).fold(0.0, f64::max);
    let shares = match skin.mirrored_within(BESIDE_PLANE * longest) {
        None => {
            let places = (skin.rest.positions.as_slice(), surface.normals.as_slice());
            wrinkled_shares(&skin.mesh, places, demands, &own.is_cut)
        }
        Some(whole) => {
            let images = &whole.images;
            let normals = images.vectors(&surface.normals);
            let places = (whole.positions.as_slice(), normals.as_slice());
            let (demands, is_cut) = (images.values(demands), images.values(&own.is_cut));
            let mut shares = wrinkled_shares(&whole.mesh, places, &demands, &is_cut);
            shares.truncate(images.own_count());
            shares
        }
    };
    let pairs = own.weights.iter().zip(shares);
    pairs.map(|(weight, share)| weight * share).collect()
}
