//! A layer's wavelength at single vertices of a mesh.

use ruga_blend::Driver;
use ruga_material::{RelativeProperties, Wrinkling};

use crate::skin::local_skin::{local_skin, painted, relative_at};
use crate::skin::material_places::uv;
use crate::skin::skin_mesh::SkinMesh;
use crate::{LayerSpec, StepperError};

/// The layer's wavelength at the vertices of a mesh, computed where it is asked for.
pub(crate) struct WavelengthField<'a> {
    spec: &'a LayerSpec,
    nominal: &'a Wrinkling,
    driver: &'a Driver,
    skin: &'a SkinMesh,
}

impl<'a> WavelengthField<'a> {
    pub(crate) fn new(
        spec: &'a LayerSpec,
        nominal: &'a Wrinkling,
        driver: &'a Driver,
        skin: &'a SkinMesh,
    ) -> Self {
        Self {
            spec,
            nominal,
            driver,
            skin,
        }
    }

    /// The wavelength at a vertex, m.
    ///
    /// # Errors
    /// [`StepperError::Material`].
    pub(crate) fn at(&self, vertex: usize) -> Result<f64, StepperError> {
        if self.is_even() {
            return Ok(self.nominal.wavelength);
        }
        let relative = relative_at(self.spec, self.driver, self.skin, vertex);
        Ok(local_skin(self.spec, &relative)?.wrinkling.wavelength)
    }

    /// A wavelength that no vertex exceeds, m.
    pub(crate) fn longest(&self) -> f64 {
        if self.is_even() {
            return self.nominal.wavelength;
        }
        let mut largest = RelativeProperties {
            wavelength: 0.0,
            young: 0.0,
            thickness: 0.0,
        };
        for place in self.skin.points.points() {
            let here = painted(self.spec, &uv(self.driver, place));
            largest.wavelength = largest.wavelength.max(here.wavelength);
            largest.young = largest.young.max(here.young);
            largest.thickness = largest.thickness.max(here.thickness);
        }
        if let Some(field) = &self.spec.variation {
            largest.thickness *= field.bounds()[1];
        }
        // Waves are the longer, the stiffer and the thicker the layer is; the slack is for the
        // rounding of each. Where there is no such material there is no bound.
        local_skin(self.spec, &largest)
            .map_or(f64::INFINITY, |local| 1.001 * local.wrinkling.wavelength)
    }

    fn is_even(&self) -> bool {
        self.spec.map.is_none() && self.spec.variation.is_none()
    }
}
