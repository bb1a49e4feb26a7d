//! The layer that wrinkles and the substrate that carries it.

use crate::MaterialError;
use crate::error::{require_poisson, require_positive};

/// An isotropic elastic layer that may wrinkle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LayerMaterial {
    /// Young's modulus `E` (Pa), above 0. Dermis: 4e6, epidermis: 600e6 (Li 2014, 5.2).
    pub young: f64,
    /// Poisson ratio `ν`, strictly inside (-1, 0.5). Skin: 0.48.
    pub poisson: f64,
    /// Thickness `h` (m), above 0. Dermis: 1.3e-3, epidermis: 0.12e-3 (Li 2014, 5.2).
    pub thickness: f64,
    /// Mass per volume (kg/m³), above 0; used by dynamics only. Skin: 1100.
    pub density: f64,
}

impl LayerMaterial {
    /// Accepts the material if every parameter is in its range.
    ///
    /// # Errors
    /// [`MaterialError::NotPositive`] or [`MaterialError::PoissonOutOfRange`], for the first
    /// parameter in the order of the fields.
    pub fn validate(&self) -> Result<(), MaterialError> {
        require_positive("layer Young's modulus (Pa)", self.young)?;
        require_poisson("layer Poisson ratio", self.poisson)?;
        require_positive("layer thickness (m)", self.thickness)?;
        require_positive("layer density (kg/m³)", self.density)
    }

    /// Membrane stiffness `C = E h / (1 - ν²)` (N/m): force per width over plane strain.
    pub fn membrane_stiffness(&self) -> f64 {
        self.young * self.thickness / plane_strain_factor(self.poisson)
    }

    /// Bending stiffness `D = E h³ / (12 (1 - ν²))` (N m).
    pub fn bending_stiffness(&self) -> f64 {
        self.membrane_stiffness() * self.thickness * self.thickness / 12.0
    }

    /// This layer as the substrate of the next one up.
    pub fn as_substrate(&self) -> Substrate {
        Substrate {
            // The layer below it counts as rigid. Against the exact stack that puts the fine wave's
            // critical strain up to 9 % high, which a layer solved by its own wave accepts.
            young: self.young,
            poisson: self.poisson,
            thickness: self.thickness,
        }
    }
}

/// The elastic foundation under a layer, its lower face held.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Substrate {
    /// Young's modulus `E_s` (Pa), above 0. Under the dermis: 0.5e6 (Li 2014, 5.2).
    pub young: f64,
    /// Poisson ratio `ν_s`, strictly inside (-1, 0.5). Skin: 0.48.
    pub poisson: f64,
    /// Thickness `H` (m), above 0. Under the dermis: 15e-3 (Li 2014, 5.2).
    pub thickness: f64,
}

impl Substrate {
    /// Accepts the substrate if every parameter is in its range.
    ///
    /// # Errors
    /// [`MaterialError::NotPositive`] or [`MaterialError::PoissonOutOfRange`], for the first
    /// parameter in the order of the fields.
    pub fn validate(&self) -> Result<(), MaterialError> {
        require_positive("substrate Young's modulus (Pa)", self.young)?;
        require_poisson("substrate Poisson ratio", self.poisson)?;
        require_positive("substrate thickness (m)", self.thickness)
    }
}

/// `1 - ν²`, which makes a plane-strain modulus of Young's modulus. The product keeps its digits
/// where ν is close to -1.
pub(crate) fn plane_strain_factor(poisson: f64) -> f64 {
    (1.0 - poisson) * (1.0 + poisson)
}
