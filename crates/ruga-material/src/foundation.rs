//! Stiffness of a bonded elastic layer of finite thickness against a normal wave.
//!
//! Everything here depends on two numbers: `x = k H` and the Poisson ratio through `q = 3 - 4ν`.
//! With the unit `U = 4 μ (1 - ν) / H` the stiffness is `K = U g(x)`,
//! `g = x (q sinh x cosh x + x) / (q² sinh² x - x²)`, and its local exponent `p = d ln g / d ln x`.
//!
//! Two facts bound both. A field admissible in a thin layer, continued by zero, is admissible in a
//! thicker one, so `g/x` falls with `x`: `p ≤ 1` and `g ≥ x/q`, the half-space. And the field without
//! tangential displacement is admissible, so `g ≤ a x coth(x/(a δ)) ≤ a x + 1/δ` with
//! `δ = q - 1` and `a = 1/√(δ (1 + q))`. That `p ≥ -2` and that `x⁴/(g (2 - p))` rises, so that a layer
//! on top has one critical wave, is not proven here but checked by the tests over all ν and `x`.

use crate::Substrate;

/// Above this `x` the layer is a half-space: what it misses, `4 x² exp(-2x)`, is under 1e-18.
const HALF_SPACE_FROM: f64 = 25.0;

/// Below this `x` the differences `sinh x / x - 1` and `cosh x - sinh x / x` come from their series,
/// because they would lose digits; above it they lose less than one.
const SERIES_BELOW: f64 = 1.0;

/// Normal stiffness of the substrate against a wave of number `wave_number`, in Pa/m.
///
/// `K(k) = 4 μ k (1 - ν) (q s c + kH) / (q² s² - (kH)²)`, with `s`, `c` the hyperbolic sine and
/// cosine of `kH`, `q = 3 - 4ν` and `μ = E/(2(1 + ν))`: plane strain, lower face held, upper face
/// bonded to a layer that does not stretch. Its limits are `M/H` for long waves (`M` the confined
/// modulus), `12 μ/(k² H³)` in between where ν is close to 0.5, and
/// `2 E (1 - ν)² k / ((1 - ν²)(3 - 4ν))`, the half-space, for short ones.
///
/// # Validity
/// Any `wave_number` (1/m) from 0 up, and any valid substrate; ν = 0.5 is also meaningful, for
/// `wave_number > 0`. Accurate to a few units in the last place for every `kH`.
pub fn substrate_stiffness(wave_number: f64, substrate: &Substrate) -> f64 {
    let ratio = Foundation::new(substrate.poisson).at(wave_number * substrate.thickness);
    stiffness_unit(substrate) * ratio.stiffness
}

/// `U = 4 μ (1 - ν) / H` (Pa/m), in which [`Foundation`] counts.
pub(crate) fn stiffness_unit(substrate: &Substrate) -> f64 {
    2.0 * substrate.young * (1.0 - substrate.poisson)
        / ((1.0 + substrate.poisson) * substrate.thickness)
}

/// The dimensionless stiffness of a bonded layer for one Poisson ratio.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foundation {
    /// `q = 3 - 4ν`, from 1 to 7.
    pub(crate) q: f64,
    /// `δ = q - 1 = 2 (1 - 2ν)`, computed on its own because it is small for skin.
    pub(crate) delta: f64,
}

/// Stiffness at one wave number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FoundationPoint {
    /// `g = K/U`.
    pub(crate) stiffness: f64,
    /// `p = d ln K / d ln k`, from -2 to 1.
    pub(crate) exponent: f64,
}

impl Foundation {
    pub(crate) fn new(poisson: f64) -> Self {
        // First δ, then q = 1 + δ: the other way round δ would lose its digits near ν = 0.5.
        let delta = 2.0 * (1.0 - 2.0 * poisson);
        Self {
            q: 1.0 + delta,
            delta,
        }
    }

    /// Stiffness and exponent at `x = kH ≥ 0`.
    ///
    /// With `S = sinh x / x` every factor of `g = (q S c + 1) / ((S - 1 + δ S)(q S + 1))` is a sum of
    /// positive terms, so nothing cancels however small `x` and `δ` are.
    pub(crate) fn at(&self, x: f64) -> FoundationPoint {
        let Self { q, delta } = *self;
        // Also keeps the hyperbolic functions from overflowing.
        if x > HALF_SPACE_FROM {
            return FoundationPoint {
                stiffness: x / q,
                exponent: 1.0,
            };
        }
        let (sinh, cosh) = (x.sinh(), x.cosh());
        let (excess, slope) = sinh_over_x_terms(x, sinh, cosh);
        let ratio = 1.0 + excess;
        // The lower factor is q S - 1, written as a sum because q S is close to 1 in thin layers.
        let top = q * ratio * cosh + 1.0;
        let (lower, upper) = (excess + delta * ratio, q * ratio + 1.0);
        FoundationPoint {
            stiffness: top / (lower * upper),
            // Logarithmic derivatives of the three factors by ln x; both lower ones change by q x
            // S'.
            exponent: q * (slope * cosh + ratio * x * sinh) / top
                - q * slope / lower
                - q * slope / upper,
        }
    }
}

/// `S - 1` and `x S' = cosh x - S`, for `S = sinh x / x`.
fn sinh_over_x_terms(x: f64, sinh: f64, cosh: f64) -> (f64, f64) {
    if x >= SERIES_BELOW {
        let ratio = sinh / x;
        return (ratio - 1.0, cosh - ratio);
    }
    // S = Σ x²ⁿ/(2n+1)!, so that x S' = Σ 2n x²ⁿ/(2n+1)!. Eight terms leave 1e-17 at x = 1.
    let (mut term, mut excess, mut slope) = (1.0, 0.0, 0.0);
    for n in 1..=8 {
        let even = f64::from(2 * n);
        term *= x * x / (even * (even + 1.0));
        excess += term;
        slope += even * term;
    }
    (excess, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    const POISSON: [f64; 9] = [
        -0.999,
        -0.5,
        0.0,
        0.3,
        0.45,
        0.48,
        0.499,
        0.499_999,
        0.5 - 1e-12,
    ];

    fn wave_numbers() -> impl Iterator<Item = f64> {
        (-80..=40).map(|i| (f64::from(i) / 8.0).exp())
    }

    #[test]
    fn exponent_is_the_logarithmic_slope() {
        let step = 1e-4_f64;
        for poisson in POISSON {
            let foundation = Foundation::new(poisson);
            for x in wave_numbers() {
                let above = foundation.at(x * step.exp()).stiffness;
                let below = foundation.at(x / step.exp()).stiffness;
                let slope = (above / below).ln() / (2.0 * step);
                // Central differences: 1e-8 from the third derivative, 1e-11 from rounding.
                assert!(
                    (slope - foundation.at(x).exponent).abs() < 2e-8,
                    "ν {poisson}, x {x}"
                );
            }
        }
    }

    /// Bounds that the bracket of the critical wave and its uniqueness rest on.
    #[test]
    fn exponent_and_stiffness_stay_in_their_bounds() {
        let rounding = 1e-13;
        for poisson in POISSON {
            let foundation = Foundation::new(poisson);
            let Foundation { q, delta } = foundation;
            let mut quotient = 0.0;
            for x in wave_numbers() {
                let FoundationPoint {
                    stiffness,
                    exponent,
                } = foundation.at(x);
                let at = format!("ν {poisson}, x {x}: g {stiffness}, p {exponent}");
                assert!(
                    (-2.0 - rounding..=1.0 + rounding).contains(&exponent),
                    "{at}"
                );
                assert!(stiffness >= x / q * (1.0 - rounding), "{at}");
                let bound = x / (delta * (1.0 + q)).sqrt() + 1.0 / delta;
                assert!(stiffness <= bound * (1.0 + rounding), "{at}");
                let next = x * x * x * x / (stiffness * (2.0 - exponent));
                assert!(next > quotient, "{at}");
                quotient = next;
            }
        }
    }

    #[test]
    fn pieces_meet_where_the_formula_changes() {
        for poisson in POISSON {
            let foundation = Foundation::new(poisson);
            for x in [SERIES_BELOW, HALF_SPACE_FROM] {
                let (below, above) = (foundation.at(x.next_down()), foundation.at(x.next_up()));
                assert!(
                    (below.stiffness / above.stiffness - 1.0).abs() < 1e-14,
                    "ν {poisson}"
                );
                assert!(
                    (below.exponent - above.exponent).abs() < 3e-14,
                    "ν {poisson}, x {x}"
                );
            }
        }
    }
}
