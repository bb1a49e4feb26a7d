//! Rest shape, material and mass of a burning sheet's triangles.

use nalgebra::{Matrix2, Vector2};
use ruga_blend::Driver;
use ruga_material::{FreshSheet, ShrinkLaw};
use ruga_mesh::{FaceId, Id};
use ruga_shell::FaceParameters;

use super::covering::Covering;
use super::field_grid::FieldGrid;
use super::fire::Fire;
use crate::skin::skin_mesh::SkinMesh;
use crate::{PaintedNumber, StepperError};

/// What the triangles of a sheet are made of before they burn, and how they shrink.
#[derive(Default)]
pub(super) struct FreshFaces {
    materials: Vec<FaceParameters>,
    laws: Vec<ShrinkLaw>,
    /// Directions of the grain in the triangles' rest frames.
    grains: Vec<Option<Vector2<f64>>>,
}

/// Rest shape and material of a triangle of the sheet.
pub(super) struct BurntFace {
    pub(super) stretch: Matrix2<f64>,
    /// Natural curvature, 1/m.
    pub(super) curvature: Matrix2<f64>,
    pub(super) material: FaceParameters,
    /// Mass of the whole face over that of the fresh one.
    pub(super) mass: f64,
}

impl FreshFaces {
    /// Those of `skin` with these materials, painted as it is in the mean over the field's triangles that lie on each.
    pub(super) fn new(
        fire: &Fire,
        (driver, skin): (&Driver, &SkinMesh),
        materials: Vec<FaceParameters>,
        (grid, covering): (&FieldGrid, &Covering),
    ) -> Self {
        let middle = |field: FaceId, paint: &Option<PaintedNumber>| {
            let at = |uv: &Vector2<f64>| paint.as_ref().map_or(1.0, |paint| paint.at(*uv));
            grid.uvs[field.index()].iter().map(at).sum::<f64>() / 3.0
        };
        let factors = covering.sums(|field| {
            [&fire.shrink_factor, &fire.asymmetry_factor].map(|paint| middle(field, paint))
        });
        let faces = (0..factors.len()).map(FaceId::from_index);
        let laws = factors.iter().zip(faces);
        let laws =
            laws.map(|(sums, face)| fire.shrink_by(sums.map(|sum| sum / covering.weight(face))));
        Self {
            laws: laws.collect(),
            grains: fire.grain.on_skin(driver, skin).into_vec(),
            materials,
        }
    }

    /// A triangle with so much fuel left, of a sheet whose char has so much of the fresh mass.
    pub(super) fn burnt(
        &self,
        face: FaceId,
        (fuel, char_mass): (f64, f64),
    ) -> Result<BurntFace, StepperError> {
        let fresh = &self.materials[face.index()];
        let sheet = FreshSheet {
            young: fresh.young,
            thickness: fresh.thickness,
        };
        let shrunk = self.laws[face.index()].shrunk(&sheet, fuel);
        let shrunk = shrunk.map_err(|source| StepperError::Char { source })?;
        let mean = |[along, across]: [f64; 2]| Matrix2::identity() * (0.5 * (along + across));
        let (stretch, curvature) = match self.grains[face.index()] {
            Some(grain) => (shrunk.stretch(grain), shrunk.curvature(grain)),
            None => (mean(shrunk.lengths), mean(shrunk.curvatures)),
        };
        Ok(BurntFace {
            stretch,
            curvature,
            material: FaceParameters {
                young: shrunk.young,
                thickness: shrunk.thickness,
                ..*fresh
            },
            mass: char_mass + (1.0 - char_mass) * fuel,
        })
    }
}
