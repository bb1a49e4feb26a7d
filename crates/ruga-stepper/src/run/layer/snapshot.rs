//! A layer as others see it.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, vertex_means};

use super::Layer;
use super::output::{OnOutput, Output, Shown, Unmade};
use crate::error::Halt;
use crate::preparing::Preparing;
use crate::skin::interpolation::{Interpolation, Values};
use crate::skin::parts::in_parts;
use crate::skin::quiet::{VertexDemand, wrinkled_shares};
use crate::skin::relief::{ReliefWeights, shown_positions};
use crate::skin::skin_mesh::{RegionMesh, ShownFaces, SkinMesh};
use crate::skin::upper_shell::UpperShell;
use crate::support::surface_below::SurfaceBelow;
use crate::{ComputedMesh, LayerSpec, LayerSurface};

/// Distance (wavelengths) from the plane where one half of a symmetric pose ends within which the other half counts in
/// what is shown: more than discs and fades reach.
const BESIDE_PLANE: f64 = 2.0;

/// A layer as others see it: its mesh, its shape, and what the surface below asks of it. What solves it, three quarters
/// of its memory, is not needed for that.
pub(crate) struct LayerView<'l> {
    spec: Cow<'l, LayerSpec>,
    wrinkling: Wrinkling,
    skin: Cow<'l, SkinMesh>,
    /// Weights of the relief on its own mesh.
    weights: Cow<'l, ReliefWeights>,
    upper: Option<Cow<'l, UpperShell>>,
    /// The support surface on its own mesh.
    posed: Cow<'l, PosedSurface>,
    /// Positions of its vertices, then of those of a layer that moves together with it, m.
    positions: Cow<'l, [Vector3<f64>]>,
    pub(super) shape: Shape,
}

/// Where a layer is on what lies below it, and what that asks of it, at the vertices of a mesh.
#[derive(Clone)]
pub(crate) struct Shape {
    /// Displacements of the vertices from where they would be without wrinkles, m.
    deviations: Vec<Vector3<f64>>,
    /// Those of a layer that moves together with it, m; empty where there is none.
    upper_deviations: Vec<Vector3<f64>>,
    /// What the support surface asks for.
    demands: Vec<VertexDemand>,
}

/// Values at the vertices of an output mesh, m.
pub(crate) struct OutputValues {
    positions: Vec<Vector3<f64>>,
    /// Positions as maps show them.
    relief: Vec<Vector3<f64>>,
    /// Both of a layer that moves together with this one.
    upper: Option<[Vec<Vector3<f64>>; 2]>,
    driver_positions: Vec<Vector3<f64>>,
    /// Unit vectors.
    driver_normals: Vec<Vector3<f64>>,
}

impl Shape {
    /// The shape at the vertices of the output mesh, to which `interpolation` takes it, or which are its own.
    pub(super) fn on_output(&self, interpolation: Option<&Interpolation>) -> Self {
        let Some(interpolation) = interpolation else {
            return self.clone();
        };
        let values = self.demands.iter();
        let values = values.map(|d| Vector3::new(d.strain_ratio, d.wavelength, d.turn));
        let values: Vec<_> = values.collect();
        // All at once: most of the work on a place serves everything that is known there.
        let own = [Values::Vectors(&self.deviations), Values::Numbers(&values)];
        let (deviations, upper_deviations, values) = match self.upper_deviations.is_empty() {
            true => {
                let [deviations, values] = interpolation.apply(own);
                (deviations, Vec::new(), values)
            }
            false => {
                let [deviations, values] = own;
                let upper = Values::Vectors(&self.upper_deviations);
                let [deviations, upper, values] = interpolation.apply([deviations, upper, values]);
                (deviations, upper, values)
            }
        };
        let demand = |value: Vector3<f64>| VertexDemand {
            strain_ratio: value.x,
            wavelength: value.y,
            turn: value.z,
        };
        Self {
            deviations,
            upper_deviations,
            demands: values.into_iter().map(demand).collect(),
        }
    }
}

impl Layer {
    /// The layer as others see it.
    pub(crate) fn view(&self) -> LayerView<'_> {
        LayerView {
            shape: self.shape(),
            spec: Cow::Borrowed(&self.spec),
            wrinkling: self.wrinkling,
            skin: Cow::Borrowed(&self.skin),
            weights: Cow::Borrowed(&self.weights),
            upper: self.upper.as_ref().map(Cow::Borrowed),
            posed: Cow::Borrowed(&self.support.posed),
            positions: Cow::Borrowed(&self.positions),
        }
    }

    /// What others see of a layer that is solved no further, and what it is shown by.
    pub(crate) fn into_view(self) -> (LayerView<'static>, Output) {
        let view = LayerView {
            shape: self.shape(),
            spec: Cow::Owned(self.spec),
            wrinkling: self.wrinkling,
            skin: Cow::Owned(self.skin),
            weights: Cow::Owned(self.weights),
            upper: self.upper.map(Cow::Owned),
            posed: Cow::Owned(Arc::unwrap_or_clone(self.support).posed),
            positions: Cow::Owned(self.positions),
        };
        (view, self.output)
    }

    fn shape(&self) -> Shape {
        Shape {
            deviations: self.deviations(),
            upper_deviations: self.upper_deviations(),
            demands: self.demands(),
        }
    }

    /// What the support surface asks of the layer, or of the softer of two that move together, at the
    /// vertices of its own mesh: the mean over the faces there.
    fn demands(&self) -> Vec<VertexDemand> {
        let ratios = self.strain_ratios();
        let upper = self.upper.as_ref();
        let upper = upper.map_or(f64::INFINITY, |upper| upper.critical_strain());
        let of_face = |face: FaceId| {
            let critical = self.properties.on_face(face).wrinkling.critical_strain;
            ratios.of_face(face) * critical / critical.min(upper)
        };
        let mut means = vertex_means(&self.skin.mesh, of_face).into_vec();
        self.raise_near_creases(&mut means, 1.0);
        let pairs = means.into_iter().zip(self.properties.at_vertices());
        let demands = pairs.map(|(ratio, local)| VertexDemand::new(ratio, &local.wrinkling));
        let mut demands: Vec<_> = demands.collect();
        self.let_turn_near_slits(&mut demands);
        demands
    }
}

impl LayerView<'_> {
    /// The mesh that it was computed on.
    pub(crate) fn skin(&self) -> &SkinMesh {
        &self.skin
    }

    /// The mesh that it was computed on, and positions of its vertices, then of those of a layer that moves together
    /// with it, m.
    pub(crate) fn into_shape(self) -> (SkinMesh, Vec<Vector3<f64>>) {
        (self.skin.into_owned(), self.positions.into_owned())
    }

    /// Support surface of its own mesh.
    pub(crate) fn support(&self) -> &PosedSurface {
        &self.posed
    }

    /// What shows the layer, whose mesh is a fitted one, once, on an output mesh that was `made`.
    pub(crate) fn shown_on(
        &self,
        driver: &Driver,
        made: (RegionMesh, Arc<Unmade>),
        preparing: &mut Preparing<'_>,
    ) -> Result<Shown, Halt> {
        let layer = (&*self.spec, &self.wrinkling, &*self.skin);
        Shown::new(driver, layer, made, false, preparing)
    }

    /// The layer as results have it on its output mesh, in a shape at the vertices of that, and one that moves together
    /// with it, over what is below that mesh: `real`, or as maps show it, if that is something else.
    pub(crate) fn values(
        &self,
        (on_output, shape): (&OnOutput<'_>, Shape),
        (real, shown): (&SurfaceBelow<'_>, Option<&SurfaceBelow<'_>>),
    ) -> OutputValues {
        let Shape {
            deviations,
            upper_deviations,
            demands,
        } = shape;
        let weights = on_output.weights(&demands, &real.normals());
        // Before the lists below are made, when memory is most.
        drop(demands);
        let of_part = |vertices: Range<usize>| {
            let (support, real) = real.at(vertices.clone()).lifted_over_support();
            let shown = shown.map(|shown| shown.at(vertices.clone()).lifted_over_support().1);
            let shown = shown.as_ref().unwrap_or(&real);
            // The support surface is known on the output mesh itself. Only the deviation from it is
            // carried over from the layer's coarser mesh, so that smooth parts of the region stay
            // exact.
            let positions = sums(&real.positions, &deviations[vertices.clone()]);
            let relief = shown_positions(&positions, &real, shown, &weights[vertices]);
            (positions, relief, support)
        };
        let vertices = deviations.len();
        // A list that grows takes up to twice as much.
        let list = || Vec::with_capacity(vertices);
        let mut values = OutputValues {
            positions: list(),
            relief: list(),
            upper: None,
            driver_positions: list(),
            driver_normals: list(),
        };
        in_parts(vertices, of_part, |(positions, relief, support)| {
            values.positions.extend(positions);
            values.relief.extend(relief);
            values.driver_positions.extend(support.positions);
            values.driver_normals.extend(support.normals);
        });
        values.upper = self.upper.as_deref().map(|upper| {
            // A layer that moves together with another one lies on it alone.
            let PosedSurface {
                positions,
                normals,
                tangents,
            } = real.lifted();
            let above = PosedSurface {
                positions: upper.above(&positions, &normals).collect(),
                normals,
                tangents,
            };
            let positions = sums(&above.positions, &upper_deviations);
            let relief = shown_positions(&positions, &above, &above, &weights);
            [positions, relief]
        });
        values
    }

    /// The layer as results have it on its output mesh, with these `values` at the vertices, and one that moves
    /// together with it.
    pub(crate) fn surfaces(
        &self,
        driver: &Driver,
        (on_output, values): (OnOutput<'_>, OutputValues),
        offset: f64,
    ) -> Vec<LayerSurface> {
        let mesh = &on_output.mesh;
        let [positions, relief] = [values.positions, values.relief];
        let own = LayerSurface {
            name: self.spec.name.clone(),
            relief: mesh.on_both_sides(relief),
            positions: mesh.on_both_sides(positions),
            driver_positions: mesh.on_both_sides(values.driver_positions),
            driver_normals: mesh.on_both_sides(values.driver_normals),
            offset,
            on_plane: mesh.skin.on_plane.as_slice().into(),
            computed: ComputedMesh::new(driver, &self.skin, self.own_positions()),
            ..LayerSurface::default()
        };
        let upper = values
            .upper
            .map(|upper| upper.map(|values| mesh.on_both_sides(values)));
        let ShownFaces { faces, uvs, artist } = on_output.into_faces(driver);
        let own = LayerSurface {
            faces,
            uvs,
            artist,
            ..own
        };
        let upper = upper.zip(self.upper.as_deref());
        let upper = upper.map(|([positions, relief], upper)| {
            let (_, upper_positions) = self.positions.split_at(self.skin.mesh.vertex_count());
            LayerSurface {
                name: upper.name.clone(),
                relief,
                positions,
                offset: offset + upper.offset,
                computed: ComputedMesh::new(driver, &self.skin, upper_positions),
                ..own.clone()
            }
        });
        match upper {
            None => vec![own],
            Some(upper) => vec![own, upper],
        }
    }

    /// Positions of the layer's own vertices as maps show them, over the support surface as maps
    /// show that.
    pub(crate) fn shown_positions(&self, shown: &PosedSurface) -> Vec<Vector3<f64>> {
        let asked = (self.shape.demands.as_slice(), self.posed.normals.as_slice());
        let weights = shown_weights(&self.weights, &self.skin, asked);
        shown_positions(self.own_positions(), &self.posed, shown, &weights)
    }

    fn own_positions(&self) -> &[Vector3<f64>] {
        &self.positions[..self.skin.mesh.vertex_count()]
    }
}

impl OnOutput<'_> {
    /// Weights of the relief over a surface with these `normals` that asks for these `demands`.
    fn weights(&self, demands: &[VertexDemand], normals: &[Vector3<f64>]) -> Vec<f64> {
        shown_weights(&self.weights, &self.mesh.skin, (demands, normals))
    }
}

/// Deviations added to places.
fn sums(places: &[Vector3<f64>], deviations: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let pairs = places.iter().zip(deviations);
    pairs.map(|(place, deviation)| place + deviation).collect()
}

/// Weights of the relief at the vertices of a mesh, with what the surface below, with these normals, asks for there.
fn shown_weights(
    own: &ReliefWeights,
    skin: &SkinMesh,
    (demands, normals): (&[VertexDemand], &[Vector3<f64>]),
) -> Vec<f64> {
    let longest = demands.iter().map(|d| d.wavelength).fold(0.0, f64::max);
    let shares = match skin.mirrored_within(BESIDE_PLANE * longest) {
        None => {
            let places = (skin.rest.positions.as_slice(), normals);
            wrinkled_shares(&skin.mesh, places, demands, &own.is_cut)
        }
        Some(whole) => {
            let images = &whole.images;
            let normals = images.vectors(normals);
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
