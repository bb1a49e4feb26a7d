//! What a film is made of and how it is held.

use ruga_material::{LayerMaterial, Substrate, WavelengthModel, Wrinkling, wrinkling};
use ruga_shell::{BendingModel, FaceParameters, LayerParameters};

use crate::{Base, Strip, equilateral};

/// Which terms hold the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilmCoupling {
    /// Low-pass rows alone, at a spacing in wavelengths.
    Constraint(f64),
    /// Foundation and tie.
    Elastic,
    /// Foundation, tie and rows at 1.5 wavelengths.
    Hybrid,
}

/// The dead load with which the base holds a film that lies on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseReaction {
    /// None: the film may leave a curved base to shed its compression.
    None,
    /// What balances membrane and bending on the base itself, compression counted up to the
    /// critical strain.
    UpToCritical,
}

/// A film, what carries it, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSpec {
    /// The film.
    pub film: LayerMaterial,
    /// A half-space; its thickness plays no part.
    pub substrate: Substrate,
    /// Shape of the base.
    pub base: Base,
    /// What holds the film.
    pub coupling: FilmCoupling,
    /// Dead load.
    pub reaction: BaseReaction,
    /// How its bending is measured.
    pub bending: BendingModel,
    /// Factor on the foundation's `K1`; 1 for what theory asks.
    pub gradient_factor: f64,
}

impl FilmSpec {
    /// Points per wavelength of [`strip`](Self::strip).
    pub const POINTS: f64 = 12.0;

    /// A film of 0.1 mm, `ratio` times as stiff as its flat base, hybrid coupling.
    pub fn flat(ratio: f64) -> Self {
        let substrate = Substrate {
            young: 1e5,
            poisson: 0.3,
            thickness: 1.0,
        };
        Self {
            film: LayerMaterial {
                young: ratio * substrate.young,
                poisson: substrate.poisson,
                thickness: 1e-4,
                density: 1100.0,
            },
            substrate,
            base: Base::Flat,
            coupling: FilmCoupling::Hybrid,
            reaction: BaseReaction::None,
            bending: BendingModel::VertexCurvature,
            gradient_factor: 1.0,
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

    pub(crate) fn parameters(&self, strip: &Strip) -> LayerParameters {
        let theory = self.theory();
        let held = !matches!(self.coupling, FilmCoupling::Constraint(_));
        let spring = |stiffness: f64| if held { stiffness } else { 0.0 };
        let face = FaceParameters {
            young: self.film.young,
            poisson: self.film.poisson,
            thickness: self.film.thickness,
            normal_stiffness: spring(theory.normal_stiffness),
            gradient_stiffness: spring(self.gradient_factor * theory.gradient_stiffness),
        };
        let tie = spring(theory.tangential_stiffness);
        LayerParameters::uniform(face, strip.faces.len(), tie, strip.points.len())
    }
}
