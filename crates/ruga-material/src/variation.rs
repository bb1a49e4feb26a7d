//! Natural unevenness of skin: a smooth random field of thickness in space.

use std::f64::consts::{LN_2, TAU};

use nalgebra::Vector3;

use crate::MaterialError;
use crate::error::{MAX_SPREAD, require_positive, require_representable};

/// Natural unevenness of a layer's thickness.
///
/// An even layer wrinkles in even, parallel corrugations. Skin does not: its furrows bend, join and
/// fade, because its thickness varies from place to place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Variation {
    /// Relative standard deviation of thickness, from 0 (even) to [`Variation::MAX_SPREAD`].
    pub spread: f64,
    /// Size of the larger features in wavelengths of the layer, above 0; see [`VariationField`].
    pub scale: f64,
}

impl Variation {
    /// The largest [`Variation::spread`] accepted. Beyond it thin spots are a quarter as thick as the
    /// layer, and no longer the same skin.
    pub const MAX_SPREAD: f64 = MAX_SPREAD;

    /// Accepts a spread from 0 to [`Variation::MAX_SPREAD`] and a finite scale above 0.
    ///
    /// # Errors
    /// [`MaterialError::SpreadOutOfRange`] or [`MaterialError::NotPositive`].
    pub fn validate(&self) -> Result<(), MaterialError> {
        // A NaN is in no range.
        if !(0.0..=Self::MAX_SPREAD).contains(&self.spread) {
            return Err(MaterialError::SpreadOutOfRange { value: self.spread });
        }
        require_positive("variation scale (wavelengths)", self.scale)
    }
}

/// Smooth random field of relative thickness, evaluated at rest positions.
///
/// The field lives in space, not over UV: it has no seam, and the left half of a face differs from
/// the right. It is infinitely smooth and looks the same in all directions.
///
/// `thickness factor = exp(σ s(z))`, with `σ² = ln(1 + spread²)` and `z = √0.8 z₁ + √0.2 z₂`, each
/// `zᵢ(x) = √(2/M) Σ cos(kⱼ·x + φⱼ)`: a Gaussian random field as a sum of `M` plane waves of random
/// normal wave vectors `kⱼ` and phases (Shinozuka and Deodatis 1991). Soft clipping `s` keeps `z` within
/// 2.5 standard deviations, so that no spot gets absurdly thin.
///
/// The correlation of `zᵢ` at distance `r` is `2^(-(2 r/Lᵢ)²)`: the *feature size* `Lᵢ` is the full width
/// at half maximum, so two points half a feature apart are correlated by a half, and a bump is about
/// one feature wide. `L₁` is `scale * wavelength`, `L₂` a third of it.
///
/// The *median* factor is 1: half of the skin is thicker than the layer's thickness, and the median
/// wavelength stays the nominal one, which is proportional to thickness. The mean is `√(1 + spread²)`,
/// 2 % more at a spread of 0.2.
#[derive(Clone, Debug, PartialEq)]
pub struct VariationField {
    /// `σ`, the standard deviation of the logarithm.
    log_spread: f64,
    modes: Vec<Mode>,
}

/// One plane wave, `amplitude cos(wave·x + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mode {
    amplitude: f64,
    /// Wave vector (1/m).
    wave: Vector3<f64>,
    phase: f64,
}

/// Plane waves per octave. The correlation of one field strays from the formula by about
/// `0.5/√MODES`; evaluation costs one cosine each.
const MODES: usize = 64;

/// Size of an octave's features in units of the larger, and its share of the variance.
const OCTAVES: [(f64, f64); 2] = [(1.0, 0.8), (1.0 / 3.0, 0.2)];

/// The largest `|s|`, in standard deviations.
const CLIP: f64 = 2.5;

/// Slope of `s` at 0, which makes up for the variance that clipping takes: with it a standard normal
/// `z` gives `s(z)` the variance 1 to 1e-4.
const CLIP_SLOPE: f64 = 1.0746;

impl VariationField {
    /// The field of one `seed` for a layer with this `wavelength` (m).
    ///
    /// # Errors
    /// Those of [`Variation::validate`]; [`MaterialError::NotPositive`] for the wavelength;
    /// [`MaterialError::Overflow`] where `scale * wavelength` or its inverse is no floating-point number.
    pub fn new(variation: Variation, wavelength: f64, seed: u64) -> Result<Self, MaterialError> {
        variation.validate()?;
        require_positive("wavelength (m)", wavelength)?;
        let size = variation.scale * wavelength;
        require_representable("size of the variation's features (m)", size)?;
        // Standard deviation of a component of the wave vectors, from the half width of the correlation.
        let wave_number = (8.0 * LN_2).sqrt() / size;
        require_representable("wave number of the variation (1/m)", 3.0 * wave_number)?;

        // The order of the draws is part of what a seed means: wave, then phase, mode by mode.
        let mut random = Random(seed);
        let modes = OCTAVES
            .iter()
            .flat_map(|&(relative_size, variance)| {
                let amplitude = (2.0 * variance / MODES as f64).sqrt();
                std::iter::repeat_n((amplitude, wave_number / relative_size), MODES)
            })
            .map(|(amplitude, wave_number)| Mode {
                amplitude,
                wave: wave_number * random.normal(),
                phase: TAU * random.uniform(),
            })
            .collect();
        Ok(Self {
            // The spread of a log-normal factor, turned into that of its logarithm.
            log_spread: variation.spread.powi(2).ln_1p().sqrt(),
            modes,
        })
    }

    /// Thickness at a rest position `point` (m) over the layer's own, within [`VariationField::bounds`].
    ///
    /// It is 1 where a coordinate is not finite, or so large that its phase is not.
    pub fn thickness_factor(&self, point: &Vector3<f64>) -> f64 {
        let z: f64 = self
            .modes
            .iter()
            .map(|mode| mode.amplitude * (mode.wave.dot(point) + mode.phase).cos())
            .sum();
        if z.is_finite() {
            (self.log_spread * clipped(z)).exp()
        } else {
            1.0
        }
    }

    /// The smallest and the largest factor that can come out, `exp(±2.5 σ)`: 0.61 and 1.64 at a spread
    /// of 0.2.
    pub fn bounds(&self) -> [f64; 2] {
        let largest = (self.log_spread * CLIP).exp();
        [largest.recip(), largest]
    }
}

/// `s(z)`: nearly `z` in the middle, between `-CLIP` and `CLIP` everywhere, of variance 1 for a standard
/// normal `z`.
///
/// The fourth power bends late: a hyperbolic tangent of the same bounds would squeeze the middle, too,
/// and flatten the distribution. It is even and its root is never of 0, so `s` stays smooth.
fn clipped(z: f64) -> f64 {
    let steep = CLIP_SLOPE * z;
    steep / (1.0 + (steep / CLIP).powi(4)).sqrt().sqrt()
}

/// Reproducible random numbers: SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    /// Uniform in `(0, 1)`.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        // The middle of one of 2^52 equal intervals, so that a logarithm can be taken.
        ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Three independent standard normal numbers, by Box and Muller.
    fn normal(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            // Each pair's second number is left unused: the few hundred draws of a field cost
            // nothing.
            let radius = (-2.0 * self.uniform().ln()).sqrt();
            radius * (TAU * self.uniform()).cos()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{CLIP, clipped};

    /// Clipping keeps the variance of a standard normal number, here by the trapezoid rule.
    #[test]
    fn clipping_is_bounded_and_keeps_the_variance() {
        let step = 1e-3;
        let variance: f64 = (-9000..=9000)
            .map(|i| f64::from(i) * step)
            .map(|z| clipped(z).powi(2) * (-0.5 * z * z).exp())
            .sum::<f64>()
            * step
            / std::f64::consts::TAU.sqrt();
        assert!((variance - 1.0).abs() < 1e-4, "{variance}");
        for z in [3.0, 10.0, 1e3, 1e70] {
            assert!(clipped(z) <= CLIP && clipped(z) > 2.0, "{z}");
            assert_eq!(clipped(-z), -clipped(z));
        }
    }
}
