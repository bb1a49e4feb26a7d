//! What a film is made of and how it is held.

use ruga_material::{LayerMaterial, Substrate, WavelengthModel, Wrinkling, wrinkling};
use ruga_shell::{BendingModel, FaceParameters, LayerParameters};
use ruga_stepper::LayerSpec;

use super::{Strip, equilateral};
use crate::FlatFilm;

/// Which terms hold the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilmCoupling {
    /// Low-pass rows alone, at a spacing in wavelengths.
    Constraint(f64),
    /// Foundation and tangential springs.
    Elastic,
    /// Foundation, tangential springs and rows at 1.5 wavelengths.
    Hybrid,
}

/// A film, what carries it, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSpec {
    /// The film.
    pub film: LayerMaterial,
    /// A half-space; its thickness plays no part.
    pub substrate: Substrate,
    /// What holds the film.
    pub coupling: FilmCoupling,
    /// How its bending is measured.
    pub bending: BendingModel,
}

impl FilmSpec {
    /// Points per wavelength of [`strip`](Self::strip).
    pub const POINTS: f64 = 12.0;

    /// A film of 0.1 mm, `ratio` times as stiff as its base, hybrid coupling.
    pub fn flat(ratio: f64) -> Self {
        let LayerSpec {
            material,
            substrate,
            ..
        } = FlatFilm::new(ratio).layer;
        Self {
            film: material,
            substrate,
            coupling: FilmCoupling::Hybrid,
            bending: BendingModel::VertexCurvature,
        }
    }

    /// Half-space theory.
    pub fn theory(&self) -> Wrinkling {
        wrinkling(&self.film, &self.substrate, WavelengthModel::HalfSpace).expect("valid materials")
    }

    /// An equilateral strip of `waves` critical wavelengths and `rows` rows of triangles.
    pub fn strip(&self, waves: f64, rows: usize) -> Strip {
        let columns = (waves * Self::POINTS).round() as usize;
        equilateral(waves * self.theory().wavelength, columns, rows)
    }

    pub(super) fn parameters(&self, strip: &Strip) -> LayerParameters {
        let theory = self.theory();
        let held = !matches!(self.coupling, FilmCoupling::Constraint(_));
        let spring = |stiffness: f64| if held { stiffness } else { 0.0 };
        let face = FaceParameters {
            young: self.film.young,
            poisson: self.film.poisson,
            thickness: self.film.thickness,
            normal_stiffness: spring(theory.normal_stiffness),
            gradient_stiffness: spring(theory.gradient_stiffness),
        };
        let tangential = spring(theory.tangential_stiffness);
        LayerParameters::uniform(face, strip.faces.len(), tangential, strip.points.len())
    }
}
