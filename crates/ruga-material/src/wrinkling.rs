//! Wave that appears first, and the springs that reproduce it.

use std::f64::consts::TAU;

use crate::error::require_representable;
use crate::foundation::{Foundation, stiffness_unit};
use crate::material::plane_strain_factor;
use crate::{LayerMaterial, MaterialError, Substrate};

/// Largest tangential stiffness in units of `C k_c²`. A stiffer one keeps the layer from sliding
/// along with the wave and costs amplitude: 0.8 % at this bound, up to 18 % beyond.
const MAX_TANGENTIAL: f64 = 0.12;

/// How the stiffness of the foundation is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
pub enum WavelengthModel {
    /// Film on a bonded elastic layer of finite thickness.
    ///
    /// The layer stands on a rigid base; the other two models are limits of this one.
    #[default]
    Layer,
    /// Film on a half-space (Rémillard & Kry 2013, eq. 3).
    ///
    /// `K = E_s k / (2 (1 - ν_s²))`, without shear at the interface. Ignores the thickness of the
    /// substrate. Within 5 % for `k H ≥ 4`.
    HalfSpace,
    /// The scaling of Li 2014, eq. 3.1.
    ///
    /// Thin incompressible layer after Cerda and Mahadevan, `K = 4 E_s / (k² H³)`, with the prefactor
    /// `2π / (96 (1 - ν²))^(1/6)` that they leave open. Ignores the Poisson ratio of the substrate.
    /// Within 5 % for `k H ≤ 1` where that is close to 0.5.
    CerdaMahadevan,
}

impl WavelengthModel {
    /// Every model, the default first.
    pub const ALL: [Self; 3] = [Self::Layer, Self::HalfSpace, Self::CerdaMahadevan];

    /// Name in scenes and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Layer => "layer",
            Self::HalfSpace => "half-space",
            Self::CerdaMahadevan => "cerda-mahadevan",
        }
    }
}

/// Everything that the planner and the shell need of one layer on what carries it.
///
/// The springs act per area of the base surface on the deviation `w` from it, with the energy
/// `½ ∫ K0 w² + K1 |∇w|²` along the normal and `½ ∫ Kt |u|²` along the surface. A shell on them
/// wrinkles with this wavelength, at this strain and with this amplitude (Pasternak fit of value and
/// slope of `K` at `k_c`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrinkling {
    /// Critical wavelength `λ` (m), in the rest configuration.
    pub wavelength: f64,
    /// Critical wave number `k_c = 2π/λ` (1/m).
    pub wave_number: f64,
    /// Plane compressive strain at which wrinkles appear, `ε_c = N_c/C`. Nominal above 0.1; a value
    /// that no compression reaches, even above 1, says that this layer does not wrinkle.
    pub critical_strain: f64,
    /// Compressive force per width at which wrinkles appear, `N_c` (N/m).
    pub critical_force: f64,
    /// Bending stiffness `D` (N m).
    pub bending_stiffness: f64,
    /// Membrane stiffness `C` (N/m).
    pub membrane_stiffness: f64,
    /// Normal spring `K0 = D k_c⁴` (Pa/m).
    pub normal_stiffness: f64,
    /// Spring on the gradient of the normal deviation, `K1 = N_c - 2 D k_c²` (N/m). Between
    /// `-D k_c²/2` and `D k_c²`; negative where the substrate is thin and nearly incompressible.
    pub gradient_stiffness: f64,
    /// Tangential spring `Kt` (Pa/m): `2 K0`, at most `0.12 C k_c²`.
    pub tangential_stiffness: f64,
}

impl Wrinkling {
    /// Disturbance of the elastic coupling by a radius of curvature (m) of the base surface:
    /// `χ = C/(R² K0)`.
    ///
    /// Without constraint rows the critical strain rises to `ε_c (1 + χ)`, because the layer can
    /// relieve its force by moving off the base. Harmless below 0.02. The sign of the radius does not
    /// matter; a plane has an infinite one. Infinite at a radius of 0.
    pub fn curvature_measure(&self, radius: f64) -> f64 {
        self.membrane_stiffness / (radius * radius * self.normal_stiffness)
    }

    /// Amplitude `A = (2/k_c) √(ε - ε_c)` (m), half the height from trough to crest, at the
    /// compressive strain `ε`; 0 up to the critical strain.
    ///
    /// A single sine whose membrane force stays at `N_c`. A nonlinear shell on the springs has 3 % less
    /// from 1.5 to `4 ε_c` at a modulus ratio of 150, 1 % at 1000.
    pub fn amplitude(&self, strain: f64) -> f64 {
        2.0 / self.wave_number * (strain - self.critical_strain).max(0.0).sqrt()
    }

    /// Wrinkling from the critical wave number and the local exponent `p` of `K ~ k^p` there:
    /// `N_c = D k_c² (1 + 2/(2 - p))`.
    fn new(layer: &LayerMaterial, wave: CriticalWave) -> Self {
        let CriticalWave {
            wave_number,
            exponent,
        } = wave;
        let shell = ShellStiffness {
            bending: layer.bending_stiffness(),
            membrane: layer.membrane_stiffness(),
        };
        let bending_force = shell.bending * wave_number * wave_number;
        let critical_force = bending_force * (1.0 + 2.0 / (2.0 - exponent));
        // 2/(2 - p) - 1, without the difference of two nearly equal forces.
        let gradient_stiffness = bending_force * exponent / (2.0 - exponent);
        Self::on_springs(shell, wave_number, critical_force, gradient_stiffness)
    }

    /// A shell with the springs that its critical wave and force stand for.
    pub(crate) fn on_springs(
        shell: ShellStiffness,
        wave_number: f64,
        critical_force: f64,
        gradient_stiffness: f64,
    ) -> Self {
        let squared = wave_number * wave_number;
        // With K = K0 + K1 k² the force is least at k_c just where K0 = D k_c⁴. K1 then sets the
        // least force and does not move the wave: a wrong K1 shows in the onset, never in the
        // wavelength.
        let normal_stiffness = shell.bending * squared * squared;
        // Twice the normal spring is what a half-space has against a tangential wave, Ē_s k_c/2.
        let tangential_bound = MAX_TANGENTIAL * shell.membrane * squared;
        Self {
            wavelength: TAU / wave_number,
            wave_number,
            critical_strain: critical_force / shell.membrane,
            critical_force,
            bending_stiffness: shell.bending,
            membrane_stiffness: shell.membrane,
            normal_stiffness,
            gradient_stiffness,
            tangential_stiffness: (2.0 * normal_stiffness).min(tangential_bound),
        }
    }

    pub(crate) fn representable(self) -> Result<Self, MaterialError> {
        require_representable("the wavelength (m)", self.wavelength)?;
        require_representable("the wave number (1/m)", self.wave_number)?;
        require_representable("the membrane stiffness (N/m)", self.membrane_stiffness)?;
        require_representable("the bending stiffness (N m)", self.bending_stiffness)?;
        require_representable("the critical force (N/m)", self.critical_force)?;
        require_representable("the critical strain", self.critical_strain)?;
        require_representable("the normal stiffness (Pa/m)", self.normal_stiffness)?;
        // Zero and negative values are good ones for K1 alone.
        if !self.gradient_stiffness.is_finite() {
            return Err(MaterialError::Overflow {
                quantity: "the gradient stiffness (N/m)",
                value: self.gradient_stiffness,
            });
        }
        require_representable("the tangential stiffness (Pa/m)", self.tangential_stiffness)?;
        Ok(self)
    }
}

/// Critical wave of `layer` on `substrate`, with the springs that reproduce it.
///
/// Minimises `N(k) = D k² + K(k)/k²`. For [`WavelengthModel::Layer`] the minimum always exists and
/// is the only one; it is found to about 1e-14.
///
/// # Errors
/// Those of [`LayerMaterial::validate`] and [`Substrate::validate`];
/// [`MaterialError::Overflow`] when a result leaves the range of floating-point numbers.
pub fn wrinkling(
    layer: &LayerMaterial,
    substrate: &Substrate,
    model: WavelengthModel,
) -> Result<Wrinkling, MaterialError> {
    let wave = critical_wave(layer, substrate, model)?;
    Wrinkling::new(layer, wave).representable()
}

/// Stiffness of a shell: `D` (N m) and `C` (N/m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShellStiffness {
    pub(crate) bending: f64,
    pub(crate) membrane: f64,
}

/// Wave number at which `N(k)` is smallest, and `p = d ln K / d ln k` there.
struct CriticalWave {
    wave_number: f64,
    exponent: f64,
}

fn critical_wave(
    layer: &LayerMaterial,
    substrate: &Substrate,
    model: WavelengthModel,
) -> Result<CriticalWave, MaterialError> {
    layer.validate()?;
    substrate.validate()?;
    match model {
        WavelengthModel::Layer => bonded_layer_wave(layer, substrate),
        WavelengthModel::HalfSpace => Ok(half_space_wave(layer, substrate)),
        WavelengthModel::CerdaMahadevan => Ok(cerda_mahadevan_wave(layer, substrate)),
    }
}

/// `k h = (3 Ē_s/Ē)^(1/3)`.
fn half_space_wave(layer: &LayerMaterial, substrate: &Substrate) -> CriticalWave {
    let modulus_ratio = substrate.young / layer.young * plane_strain_factor(layer.poisson)
        / plane_strain_factor(substrate.poisson);
    CriticalWave {
        wave_number: (3.0 * modulus_ratio).cbrt() / layer.thickness,
        exponent: 1.0,
    }
}

/// `k⁶ = 96 (1 - ν²) E_s / (E h³ H³)`.
fn cerda_mahadevan_wave(layer: &LayerMaterial, substrate: &Substrate) -> CriticalWave {
    let modulus_ratio = 96.0 * plane_strain_factor(layer.poisson) * substrate.young / layer.young;
    // Roots before products: h³ H³ may leave the range of floats where its sixth root is a length.
    let length = layer.thickness.sqrt() * substrate.thickness.sqrt();
    CriticalWave {
        wave_number: modulus_ratio.cbrt().sqrt() / length,
        exponent: -2.0,
    }
}

/// Solves `2 D k⁴ = K (2 - p)`, which is `dN/dk = 0`, in `x = k H` and `d = D/(U H⁴)`.
fn bonded_layer_wave(
    layer: &LayerMaterial,
    substrate: &Substrate,
) -> Result<CriticalWave, MaterialError> {
    let height = substrate.thickness;
    // Divided one by one, since the fourth power of a height may leave the range where the ratio
    // does not.
    let bending =
        layer.bending_stiffness() / height / height / (stiffness_unit(substrate) * height) / height;
    require_representable("the ratio of bending to foundation stiffness", bending)?;
    let foundation = Foundation::new(substrate.poisson);
    let (x, exponent) = critical_x(bending, &foundation);
    Ok(CriticalWave {
        wave_number: x / height,
        exponent,
    })
}

/// The root of `2 d x⁴ = g(x) (2 - p(x))`, and `p` there.
///
/// The quotient of the two sides rises with `x`, from 0 to infinity, so there is one root. It lies
/// above the half-space's, `2 d x³ = 1/q`, because `g ≥ x/q` and `p ≤ 1`; and below any `x` with
/// `d x⁴ ≥ 4 a x` and `d x⁴ ≥ 4/δ`, because `g ≤ a x + 1/δ` and `p ≥ -2`. See [`crate::foundation`].
fn critical_x(bending: f64, foundation: &Foundation) -> (f64, f64) {
    // The step converges by a factor of 3 or better; bisection of the widest bracket needs 60.
    const MAX_ITERATIONS: usize = 100;
    // A few units in the last place.
    const TOLERANCE: f64 = 4.0 * f64::EPSILON;
    let Foundation { q, delta } = *foundation;
    let mut low = (0.5 / (bending * q)).cbrt();
    let mut high = (4.0 / (bending * (delta * (1.0 + q)).sqrt()))
        .cbrt()
        .max((4.0 / (bending * delta)).sqrt().sqrt());
    // The half-space's root, which is that of every thick substrate.
    let mut x = low;
    for _ in 0..MAX_ITERATIONS {
        let point = foundation.at(x);
        let excess = 2.0 * bending * x * x * x * x / (point.stiffness * (2.0 - point.exponent));
        if excess < 1.0 {
            low = x;
        } else {
            high = x;
        }
        // Newton in ln x, with the slope 4 - p that a constant p has.
        let proposed = x * (-excess.ln() / (4.0 - point.exponent)).exp();
        // The bracket closes first where the rounding of `excess` exceeds the tolerance.
        if (proposed - x).abs() <= TOLERANCE * x || high - low <= TOLERANCE * high {
            return (x, point.exponent);
        }
        let inside = low < proposed && proposed < high;
        x = if inside {
            proposed
        } else {
            // The bracket may span decades, so it is halved in the logarithm.
            low.sqrt() * high.sqrt()
        };
    }
    (x, foundation.at(x).exponent)
}
