//! Inverse design: the layer that shows a wanted wavelength at a wanted strain.

use std::f64::consts::TAU;

use crate::error::{require_poisson, require_positive, require_representable};
use crate::foundation::{Foundation, stiffness_unit};
use crate::material::plane_strain_factor;
use crate::{LayerMaterial, MaterialError, Substrate};

/// The layer that on `substrate` has the critical `wavelength` (m) and `critical_strain`.
///
/// Needs no iteration: the wavelength fixes `K` and its local exponent `p`, hence
/// `D = K (2 - p)/(2 k⁴)` and `N_c = D k² + K/k²`; the strain then fixes `C = N_c/ε_c`,
/// `h = √(12 D/C)` and `E`. On a half-space `h = λ √ε_c / π`. [`wrinkling`](crate::wrinkling) with
/// the default model returns the two targets. Above a critical strain of 0.1 the layer is hardly
/// stiffer than its substrate, and film theory only nominal.
///
/// # Errors
/// [`MaterialError::NotPositive`], [`MaterialError::PoissonOutOfRange`] or
/// [`MaterialError::StrainOutOfRange`] for the first argument that is not acceptable;
/// [`MaterialError::Overflow`] when a result leaves the range of floating-point numbers.
pub fn design_layer(
    wavelength: f64,
    critical_strain: f64,
    poisson: f64,
    density: f64,
    substrate: &Substrate,
) -> Result<LayerMaterial, MaterialError> {
    require_positive("wavelength (m)", wavelength)?;
    if !(critical_strain > 0.0 && critical_strain < 1.0) {
        return Err(MaterialError::StrainOutOfRange {
            value: critical_strain,
        });
    }
    require_poisson("layer Poisson ratio", poisson)?;
    require_positive("layer density (kg/m³)", density)?;
    substrate.validate()?;

    // The stiffness of the substrate and its exponent depend on the wave alone, so both are known
    // before the layer is.
    let wave_number = TAU / wavelength;
    let point = Foundation::new(substrate.poisson).at(wave_number * substrate.thickness);
    let stiffness = stiffness_unit(substrate) * point.stiffness;
    // N_c / (D k²), from 1.5 to 3, and D k² from the vanishing derivative of N.
    let force_ratio = 1.0 + 2.0 / (2.0 - point.exponent);
    let bending_force = stiffness * (1.0 - 0.5 * point.exponent) / wave_number / wave_number;
    // From N_c = C ε_c and D/C = h²/12: only a ratio of forces enters, no modulus.
    let thickness = (12.0 * critical_strain / force_ratio).sqrt() / wave_number;
    let membrane_stiffness = bending_force * force_ratio / critical_strain;
    let young = membrane_stiffness * plane_strain_factor(poisson) / thickness;

    // Targets that are each in range may ask for a layer that is not.
    require_representable("the layer thickness (m)", thickness)?;
    require_representable("the layer's Young's modulus (Pa)", young)?;
    Ok(LayerMaterial {
        young,
        poisson,
        thickness,
        density,
    })
}
