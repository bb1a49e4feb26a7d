//! What a layer feels of the surface below it, and where that surface is.

use std::sync::Arc;

use nalgebra::{Matrix2, Vector3};
use rayon::prelude::*;
use ruga_blend::{FaceStrain, Weights};
use ruga_material::CAP_START;
use ruga_mesh::{FaceId, Id, PerFace, VertexId, face_areas, vertex_means};
use ruga_shell::ShellError;

use super::creases::CreaseStrengths;
use super::pulls::ToldPulls;
use super::{Layer, laid_on};
use crate::StepperError;
use crate::run::strain_ratio::{
    applied, driven_strains, first_felt, green_strain, relative_to_growth,
};
use crate::skin::interpolation::{Interpolation, Values};
use crate::skin::relief::turn_between;
use crate::support::motion::Inertia;
use crate::support::support_surface::SupportSurface;
use crate::support::{Moves, SolidState};

/// Least factor by which a rest triangle may shrink, so that one which collapses on the way keeps
/// an area.
const LEAST_STRETCH: f64 = 0.05;

/// Positions and velocities of a layer, and its support surface.
pub(crate) struct LayerState {
    positions: Vec<Vector3<f64>>,
    velocities: Vec<Vector3<f64>>,
    support: Arc<SupportSurface>,
    fractions: PerFace<f64>,
    crease_strengths: CreaseStrengths,
    pulls: ToldPulls,
    solid: Option<SolidState>,
}

impl Layer {
    /// Moves the surface below; the layer is carried along, turning with it.
    ///
    /// With a `fraction` under 1 the layer feels only that part of the surface's Green strain, while
    /// the surface stays where it is. Hinges and foundation stay those of the whole strain: with a
    /// rest metric between posed and rest, waves would be chosen in the posed surface's lengths and
    /// end up too long by the compression.
    pub(crate) fn set_support(
        &mut self,
        support: impl Into<Arc<SupportSurface>>,
        fraction: f64,
    ) -> Result<(), StepperError> {
        let fractions = PerFace::filled(self.skin.mesh.face_count(), fraction);
        self.stand_on(support.into(), fractions)
    }

    fn stand_on(
        &mut self,
        support: Arc<SupportSurface>,
        fractions: PerFace<f64>,
    ) -> Result<(), StepperError> {
        let (old, new) = (&self.support.posed, &support.posed);
        let base = laid_on(new, self.upper.as_ref());
        let vertices = self.vertex_count();
        let bases = base.par_iter().zip(&self.base);
        let places = self.positions.par_iter_mut().zip(bases).enumerate();
        places.for_each(|(i, (x, (base, before)))| {
            // Wrinkles turn with the surface. Shifted alone they would lean.
            *x = base + turn_between(old, new, i % vertices) * (*x - before);
        });
        self.base = base;
        self.stay_on_plane();
        self.support = support;
        self.measure_strains();
        self.fractions = fractions;
        self.absorb()?;
        self.hold()
    }

    /// Keeps the vertices where one half of a symmetric pose ends on that plane, whatever was interpolated or turned.
    pub(super) fn stay_on_plane(&mut self) {
        let vertices = self.positions.iter_mut().zip(&self.base);
        let on_plane = vertices.zip(&self.skin.on_plane).filter(|(_, on)| **on);
        for ((x, base), _) in on_plane {
            x.x = base.x;
        }
    }

    /// Measures what the surface below asks of the layer.
    pub(super) fn measure_strains(&mut self) {
        let driven = driven_strains(&self.skin, &self.support);
        let growth = self.support.growth.as_ref();
        let own = growth.map(|growth| relative_to_growth(&driven, growth));
        (self.strains, self.driven) = match own {
            Some(own) => (own, Some(driven)),
            None => (driven, None),
        };
    }

    /// Strains of the surface below.
    fn driven_strains(&self) -> &PerFace<FaceStrain> {
        self.driven.as_ref().unwrap_or(&self.strains)
    }

    /// Loads every face with no more of its strain than gives it the strain ratio `most`.
    pub(crate) fn limit_strains(&mut self, most: &PerFace<f64>) -> Result<(), StepperError> {
        self.fractions = self.strain_ratios().fractions_of(|face| most[face]);
        self.set_loaded_strains()
    }

    /// Sets the forces of the base and the effective strains for what is loaded of the applied ones.
    fn set_loaded_strains(&mut self) -> Result<(), StepperError> {
        if self.solid.is_none() && self.spec.coupling.has_foundation() {
            self.balance()?;
        }
        // Balancing has left the strains of a layer that does not wrinkle.
        self.set_effective_strains(|_, applied| applied)
    }

    /// Sets up the energy for the surface below as it is now.
    ///
    /// On a driver the layer is not bent where it lies in the posed surface: folds that the artist has
    /// drawn sharper than the layer is thick would otherwise be unstable without any compression. A
    /// body bends its layer.
    pub(super) fn hold(&mut self) -> Result<(), StepperError> {
        let posed = &self.support.posed;
        let no_offset = vec![0.0; posed.positions.len()];
        let energy = &mut self.energy;
        // The surface's positions have the layer's offset in them already.
        let mut outcome = energy.set_base(&posed.positions, &posed.normals, &no_offset);
        if self.solid.is_none() {
            outcome = outcome.and_then(|()| self.energy.set_rest_angles(&self.base));
        }
        outcome.map_err(|source| self.shell_error(source))?;
        if let Some(solid) = &mut self.solid {
            self.held_normals.clone_from(&self.support.posed.normals);
            solid.hold();
        }
        // This comes before any natural strain, because a new rest metric clears them.
        self.set_rest_metric()?;
        self.set_loaded_strains()
    }

    /// Sets the forces with which the posed driver holds the layer in its own shape.
    ///
    /// The artist's posed shape is skin in equilibrium: against what a layer lying on it pulls and
    /// presses, the surface pushes back. Without this a layer under tension flattens
    /// the artist's shape, one under half of the critical compression doubles every bump as long
    /// as a wrinkle, and on a cylinder an elastic foundation delays the onset. Compression counts
    /// up to the critical strain, because a wrinkled layer carries no more.
    fn balance(&mut self) -> Result<(), StepperError> {
        let poisson = self.spec.material.poisson;
        // The effective strain `first + nu second` is held to the critical one. The second strain
        // is held first, to what is critical when both are equal, or the first would come out as
        // tension.
        let wanted = |critical: f64, [first, second]: [f64; 2]| {
            let second = second.min(critical / (1.0 + poisson));
            [(critical - poisson * second).min(first), second]
        };
        self.set_effective_strains(wanted)?;
        self.set_reaction();
        Ok(())
    }

    /// Shrinks the rest metric with the surface below, face by face, where that asks for more than
    /// 15 %, and takes out what of its bending is not transferred.
    fn set_rest_metric(&mut self) -> Result<(), StepperError> {
        let driven = self.driven_strains();
        let capped = driven.as_slice().iter().any(|s| s.first > CAP_START);
        let changed = capped || self.support.transfer.is_some();
        // After the last change the metric is set once more, to take it back.
        if changed || self.is_metric_changed {
            let strains = driven.as_slice().par_iter().enumerate();
            let stretches = strains.map(|(f, s)| self.rest_stretch(FaceId::from_index(f), s));
            let stretches: Vec<_> = stretches.collect();
            let outcome = self.energy.set_rest_metric(&stretches);
            outcome.map_err(|source| self.shell_error(source))?;
        }
        self.is_metric_changed = changed;
        self.held_ratios = match self.solid {
            Some(_) => self.metric_ratios().collect(),
            None => Vec::new(),
        };
        Ok(())
    }

    fn rest_stretch(&self, face: FaceId, strain: &FaceStrain) -> Matrix2<f64> {
        let along = strain.direction * strain.direction.transpose();
        // The metric shrinks along the compression only: across it the skin is stretched as the
        // pose asks for.
        let ratio = metric_ratio(strain, self.absorption.share(face, strain));
        let stretch = Matrix2::identity() + along * (ratio - 1.0);
        match &self.support.transfer {
            Some(transfer) => stretch * transfer[face.index()],
            None => stretch,
        }
    }

    fn metric_ratios(&self) -> impl Iterator<Item = f64> + '_ {
        let driven = self.driven_strains().iter();
        driven.map(|(face, strain)| metric_ratio(strain, self.absorption.share(face, strain)))
    }

    /// Fraction of the faces that are compressed beyond 15 %, where the layer feels no more.
    pub(crate) fn capped_fraction(&self) -> f64 {
        let strains = self.strains.as_slice().iter();
        let capped = strains.filter(|strain| strain.first > CAP_START).count();
        capped as f64 / self.strains.len().max(1) as f64
    }

    /// Area of the skin (m²) by which the surface below and its growth compress it beyond what the layer feels.
    pub(crate) fn left_out(&self) -> f64 {
        let areas = face_areas(&self.skin.mesh, &self.skin.rest.positions);
        let of_face = |(face, strain): (FaceId, &FaceStrain)| {
            (1.0 - metric_ratio(strain, self.absorption.share(face, strain))) * areas[face]
        };
        self.strains.iter().map(of_face).sum::<f64>().max(0.0)
    }

    /// Lag of the energy behind the support surface as a solve has left that: the largest angle (rad) by
    /// which a normal has turned, or change of a capped rest length; 0 on a driver.
    pub(crate) fn lag(&self) -> f64 {
        let normals = self.held_normals.iter().zip(&self.support.posed.normals);
        // The arc cosine of a dot product loses half of the digits at small angles, which are the
        // usual ones.
        let turned = normals.map(|(old, new)| old.cross(new).norm().atan2(old.dot(new)));
        let ratios = self.held_ratios.iter().zip(self.metric_ratios());
        let shrunk = ratios.map(|(old, new)| (old - new).abs());
        turned.chain(shrunk).fold(0.0, f64::max)
    }

    /// Lets the layer feel of every face's applied principal strains what `wanted` says, of the
    /// face's critical strain and these.
    fn set_effective_strains(
        &mut self,
        wanted: impl Fn(f64, [f64; 2]) -> [f64; 2] + Sync,
    ) -> Result<(), StepperError> {
        let strains = self.strains.as_slice().par_iter().enumerate();
        let driven = self.driven_strains();
        let natural: Vec<_> = strains
            .map(|(face, strain)| {
                let face = FaceId::from_index(face);
                let critical = self.properties.on_face(face).wrinkling.critical_strain;
                let whole = &driven[face];
                let [own, driven] = [strain, whole].map(|s| self.absorption.share(face, s));
                let effective = wanted(critical, applied(strain, own, self.fractions[face]));
                // What the layer is not to feel, and what it has grown, is strain without stress.
                green_strain(whole, applied(whole, driven, 1.0)) - green_strain(strain, effective)
            })
            .collect();
        let outcome = self.energy.set_natural_strains(&natural);
        outcome.map_err(|source| self.shell_error(source))
    }

    pub(super) fn shell_error(&self, source: ShellError) -> StepperError {
        StepperError::Shell {
            layer: self.spec.name.clone(),
            source,
        }
    }

    /// Lets a layer on a body have grown by these stretches, from when the body is placed next.
    pub(crate) fn grow(&mut self, growth: Option<PerFace<Matrix2<f64>>>) {
        Arc::make_mut(&mut self.support).growth = growth;
    }

    /// Puts everything around the body below where it is at `time`; the inside moves with the handles,
    /// or in a step in time where its velocity takes it, and the layer with the inside.
    pub(crate) fn place_solid(
        &mut self,
        around: (&Moves<'_>, &Weights),
        time: f64,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
        let Some(solid) = &mut self.solid else {
            return Ok(());
        };
        match inertia {
            None => {
                let placed = solid.place(around, time);
                placed.map_err(|source| StepperError::Solver {
                    layer: self.spec.name.clone(),
                    source,
                })?;
            }
            Some(inertia) => {
                solid.place_in_time(around, time, (inertia, &self.positions));
            }
        }
        let posed = solid.surface(&self.support.posed);
        self.set_support(self.support.on_body(posed), 1.0)
    }

    /// Whether an obstacle pushes.
    pub(crate) fn is_touched(&self) -> bool {
        let solid = self.solid.as_ref();
        solid.is_some_and(|solid| solid.is_touched(&self.positions))
    }

    /// Deepest displacement of a vertex into an obstacle, m.
    pub(crate) fn penetration(&self) -> f64 {
        let solid = self.solid.as_ref();
        solid.map_or(0.0, |solid| solid.penetration(&self.positions))
    }

    /// Takes over how `other`, the same layer on another mesh, deviates from the surface below, and of the
    /// strains what gives the strain ratios that `other` had on its faces; both are on the same surface,
    /// and no layer moves together with them. False as soon as `goes_on` says no.
    pub(crate) fn take_shape(
        &mut self,
        other: &Layer,
        ratios: &PerFace<f64>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<bool, StepperError> {
        let Some(interpolation) = Interpolation::new(&other.skin, &self.skin, goes_on) else {
            return Ok(false);
        };
        let means = vertex_means(&other.skin.mesh, |face| ratios[face].max(0.0)).into_vec();
        let at_vertices: Vec<_> = means
            .into_iter()
            .map(|mean| Vector3::new(mean, 0.0, 0.0))
            .collect();
        let [deviations, at_vertices] = interpolation.apply([
            Values::Vectors(&other.deviations()),
            Values::Numbers(&at_vertices),
        ]);
        for v in &self.free {
            let i = v.index();
            self.positions[i] = self.base[i] + deviations[i];
        }
        self.stay_on_plane();
        let faces = self.skin.mesh.faces();
        let mean = |corners: &[VertexId; 3]| {
            corners
                .iter()
                .map(|v| at_vertices[v.index()].x)
                .sum::<f64>()
                / 3.0
        };
        let most = faces.iter().map(|(_, corners)| mean(corners)).collect();
        self.limit_strains(&most)?;
        Ok(true)
    }

    /// Shape of the layer and of what is below it, to return to.
    pub(crate) fn state(&self) -> LayerState {
        LayerState {
            positions: self.positions.clone(),
            velocities: self.velocities.clone(),
            support: Arc::clone(&self.support),
            fractions: self.fractions.clone(),
            crease_strengths: self.crease_strengths.clone(),
            pulls: self.pulls.clone(),
            solid: self.solid.as_ref().map(|solid| solid.state.clone()),
        }
    }

    /// Returns to an earlier shape, and what is below to where it was then.
    pub(crate) fn restore(&mut self, state: &LayerState) -> Result<(), StepperError> {
        if let (Some(solid), Some(state)) = (&mut self.solid, &state.solid) {
            solid.state.clone_from(state);
        }
        // It carries the positions along with the surface, so that they are put back after it.
        self.stand_on(Arc::clone(&state.support), state.fractions.clone())?;
        self.positions.clone_from(&state.positions);
        self.velocities.clone_from(&state.velocities);
        self.pulls.clone_from(&state.pulls);
        self.set_crease_strengths(state.crease_strengths.clone())?;
        Ok(())
    }

    /// Whether a vertex got through an obstacle on its way from an earlier state.
    pub(crate) fn has_passed(&self, before: &LayerState) -> bool {
        match (&self.solid, &before.solid) {
            (Some(solid), Some(state)) => {
                let start = (state, before.positions.as_slice());
                solid.has_passed(start, &self.positions)
            }
            _ => false,
        }
    }
}

/// Factor by which a face's rest length shrinks along its compression, of which a crease takes up a share.
fn metric_ratio(strain: &FaceStrain, taken_up: f64) -> f64 {
    let ratio = (1.0 - strain.first) / (1.0 - first_felt(strain, taken_up));
    ratio.max(LEAST_STRETCH)
}
