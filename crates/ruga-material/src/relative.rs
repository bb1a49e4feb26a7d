//! Effect of a painted map on a layer at one place.

use crate::error::require_positive;
use crate::{LayerMaterial, MaterialError, Substrate, WavelengthModel, Wrinkling, wrinkling};

/// Painted properties at one place, each relative to the layer's own value; 1 changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeProperties {
    /// Wavelength over the one predicted there, above 0.
    pub wavelength: f64,
    /// Young's modulus over the layer's, above 0.
    pub young: f64,
    /// Thickness over the layer's, above 0.
    pub thickness: f64,
}

impl Default for RelativeProperties {
    fn default() -> Self {
        Self {
            wavelength: 1.0,
            young: 1.0,
            thickness: 1.0,
        }
    }
}

impl RelativeProperties {
    /// The layer as painted: modulus scaled, and thickness by its own factor and that of the
    /// wavelength, see [`local_wrinkling`].
    pub fn scaled(&self, layer: &LayerMaterial) -> LayerMaterial {
        LayerMaterial {
            young: self.young * layer.young,
            // Scaling lengths and no modulus leaves the critical strain as it is.
            thickness: self.wavelength * self.thickness * layer.thickness,
            ..*layer
        }
    }

    /// Substrate of the layer as painted: as many times as thick as the wavelength is long.
    pub fn scaled_substrate(&self, substrate: &Substrate) -> Substrate {
        Substrate {
            thickness: self.wavelength * substrate.thickness,
            ..*substrate
        }
    }

    /// The largest factor, from 1 up, by which one of the three properties differs from `other`'s.
    pub fn jump_to(&self, other: &Self) -> f64 {
        // Ratios, because wavelength and strain go with powers of the properties; the same in both
        // directions.
        let factor = |a: f64, b: f64| (a / b).max(b / a);
        factor(self.wavelength, other.wavelength)
            .max(factor(self.young, other.young))
            .max(factor(self.thickness, other.thickness))
    }

    /// Accepts finite positive values.
    fn validate(&self) -> Result<(), MaterialError> {
        require_positive("relative wavelength", self.wavelength)?;
        require_positive("relative Young's modulus", self.young)?;
        require_positive("relative thickness", self.thickness)
    }
}

/// Critical wave and springs of a painted `layer` at a place with `relative` properties.
///
/// Modulus and thickness scale the layer (Li 2014, 5.2). The relative wavelength then scales the
/// whole section, layer and substrate alike ([`RelativeProperties::scaled`],
/// [`RelativeProperties::scaled_substrate`]): a section `s` times as large has waves exactly `s` times
/// as long and as high, at the same critical strain, whatever the model. The other way to a painted
/// wavelength, a stiffer or softer substrate under the same layer, changes the critical strain by
/// `s^-2`: skin painted to a third of the wavelength would bear nine times the compression, and not
/// wrinkle at all.
///
/// Costs as much as [`wrinkling`]; not worth a table.
///
/// # Errors
/// Those of [`wrinkling`], and [`MaterialError::NotPositive`] for a relative value.
pub fn local_wrinkling(
    layer: &LayerMaterial,
    substrate: &Substrate,
    model: WavelengthModel,
    relative: &RelativeProperties,
) -> Result<Wrinkling, MaterialError> {
    relative.validate()?;
    let below = relative.scaled_substrate(substrate);
    wrinkling(&relative.scaled(layer), &below, model)
}
