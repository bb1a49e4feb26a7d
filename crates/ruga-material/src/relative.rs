//! What a painted map does to a layer at one place.

use crate::error::require_positive;
use crate::wrinkling::stretched_wrinkling;
use crate::{LayerMaterial, MaterialError, Substrate, WavelengthModel, Wrinkling};

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
    /// The layer as painted: modulus and thickness scaled.
    ///
    /// The wavelength is no property of the layer alone; see [`local_wrinkling`].
    pub fn scaled(&self, layer: &LayerMaterial) -> LayerMaterial {
        LayerMaterial {
            young: self.young * layer.young,
            thickness: self.thickness * layer.thickness,
            ..*layer
        }
    }

    /// The largest factor, from 1 up, by which one of the three properties differs from `other`'s.
    pub fn jump_to(&self, other: &Self) -> f64 {
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
/// Modulus and thickness scale the layer (Li 2014, 5.2). The relative wavelength then overrules the
/// prediction for the scaled layer: the modulus of the substrate is taken to be such that the
/// wavelength is exactly `relative.wavelength` times as long, see [`local_substrate`]. Springs, force
/// and critical strain are those of that pair, so wavelength, onset and amplitude stay consistent: a
/// longer wave needs a softer substrate and comes at a smaller strain.
///
/// Costs little more than [`wrinkling`](crate::wrinkling); not worth a table.
///
/// # Errors
/// Those of [`wrinkling`](crate::wrinkling), and [`MaterialError::NotPositive`] for a relative value.
pub fn local_wrinkling(
    layer: &LayerMaterial,
    substrate: &Substrate,
    model: WavelengthModel,
    relative: &RelativeProperties,
) -> Result<Wrinkling, MaterialError> {
    relative.validate()?;
    let local = relative.scaled(layer);
    stretched_wrinkling(&local, substrate, model, relative.wavelength).map(|(found, _)| found)
}

/// The substrate that [`local_wrinkling`] takes to lie under the painted layer: that of the scene,
/// its Young's modulus scaled to give the painted wavelength.
///
/// # Errors
/// Those of [`local_wrinkling`].
pub fn local_substrate(
    layer: &LayerMaterial,
    substrate: &Substrate,
    model: WavelengthModel,
    relative: &RelativeProperties,
) -> Result<Substrate, MaterialError> {
    relative.validate()?;
    let local = relative.scaled(layer);
    let (_, factor) = stretched_wrinkling(&local, substrate, model, relative.wavelength)?;
    let young = factor * substrate.young;
    crate::error::require_representable("the substrate's Young's modulus (Pa)", young)?;
    Ok(Substrate {
        young,
        ..*substrate
    })
}
