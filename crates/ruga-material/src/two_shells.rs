//! Two shells, one on springs above the other: which plane waves they share, and at what strain.
//!
//! Normal springs `Ks = K0_1 + K1_1 k²` hold the lower shell on the driver, `Kn = K0_2 + K1_2 k²` the
//! upper shell on the lower one, tangential springs `K_t` keep it from sliding. A wave of number `k`
//! in both appears at the smallest eigenvalue `e` of `A v = e B v` with
//!
//! ```text
//! A = [[D1 k⁴ + Ks + Kn + Kq t² k²,  -Kn], [-Kn,  D2 k⁴ + Kn]]      B = diag(S1 k², S2 k²)
//! 1/Kq = 1/(S1 k²) + 1/K_t + 1/(S2 k²)
//! ```
//!
//! where `D` is bending stiffness, `S` membrane stiffness and `t` the mid-surface offset.
//! No double counting: `Kn` is the lower layer's compliance across its thickness and acts on the
//! *deviation* from the lower shell. This small matrix fits the exact elastic three-layer stack
//! within 2 % in strain and 4 % in wavelength for membrane ratios from 0.1 to 14.

use crate::Wrinkling;

/// One of the two shells with the springs under it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shell {
    /// `D` (N m).
    pub(crate) bending: f64,
    /// `S` (N/m).
    pub(crate) membrane: f64,
    /// `K0` (Pa/m).
    pub(crate) normal: f64,
    /// `K1` (N/m).
    pub(crate) gradient: f64,
}

impl Shell {
    pub(crate) fn new(wrinkling: &Wrinkling) -> Self {
        Self {
            bending: wrinkling.bending_stiffness,
            membrane: wrinkling.membrane_stiffness,
            normal: wrinkling.normal_stiffness,
            gradient: wrinkling.gradient_stiffness,
        }
    }

    /// `K0/k² + K1` (N/m), the springs against a wave, over `k²`.
    ///
    /// At least half of `K0/k²`, which acts only where `K1` is negative (thin, nearly incompressible
    /// foundations) and the wave shorter than the shell's own: there the fit of value and slope would
    /// turn into springs that push.
    fn springs(&self, squared: f64) -> f64 {
        let normal = self.normal / squared;
        (normal + self.gradient).max(0.5 * normal)
    }
}

/// Both shells and the springs between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TwoShells {
    pub(crate) lower: Shell,
    pub(crate) upper: Shell,
    /// `K_t` (Pa/m).
    pub(crate) tangential: f64,
    /// `t` (m).
    pub(crate) offset: f64,
}

/// A local minimum of the strain over the wave number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Minimum {
    pub(crate) wave_number: f64,
    pub(crate) strain: f64,
}

impl TwoShells {
    /// `Kq` (Pa/m): the tangential springs in series with what the shells' membranes give way.
    pub(crate) fn shear(&self, wave_number: f64) -> f64 {
        let squared = wave_number * wave_number;
        let softness = 1.0 / (self.lower.membrane * squared)
            + 1.0 / self.tangential
            + 1.0 / (self.upper.membrane * squared);
        1.0 / softness
    }

    /// `e(k)`, the strain at which a wave of this number appears.
    pub(crate) fn strain(&self, wave_number: f64) -> f64 {
        let squared = wave_number * wave_number;
        let Self { lower, upper, .. } = self;
        let below = lower.springs(squared);
        let between = upper.springs(squared);
        let sandwich = self.shear(wave_number) * self.offset * self.offset;
        // The rows of A over k², without the coupling.
        let first = lower.bending * squared + below + sandwich;
        let second = upper.bending * squared;
        let diagonal = [
            (first + between) / lower.membrane,
            (second + between) / upper.membrane,
        ];
        let coupling = between * between / (lower.membrane * upper.membrane);
        let mean = 0.5 * (diagonal[0] + diagonal[1]);
        let half = 0.5 * (diagonal[0] - diagonal[1]);
        let larger = mean + (half * half + coupling).sqrt();
        // The difference of the two roots would cancel where `between` is large: product over sum.
        let determinant = first * second + between * (first + second);
        determinant / (lower.membrane * upper.membrane) / larger
    }

    /// Every local minimum of the strain, the longest wave first; at least one.
    ///
    /// `waves`: the critical wave numbers of both layers alone, between and around which they lie.
    pub(crate) fn minima(&self, waves: [f64; 2]) -> Vec<Minimum> {
        // A composite's wave is longer than the lower layer's: 8 times for a stiffness 500 times as
        // large. 30 is beyond any pair for which this theory means something.
        const LONGEST: f64 = 30.0;
        // The fine wave is hardly moved by the coupling.
        const SHORTEST: f64 = 3.0;
        // Minima are as wide as their wave number; those closer than this are one.
        const STEPS_PER_E_FOLD: f64 = 24.0;
        // Between these ends there is a minimum: springs make long waves dear, bending short ones.
        let start = (waves[0].min(waves[1]) / LONGEST).ln();
        let end = (waves[0].max(waves[1]) * SHORTEST).ln();
        let steps = ((end - start) * STEPS_PER_E_FOLD).ceil() as usize;
        let place = |step: usize| start + (end - start) * step as f64 / steps as f64;
        let strain = |logarithm: f64| self.strain(logarithm.exp());
        let sampled: Vec<f64> = (0..=steps).map(|step| strain(place(step))).collect();
        let mut found = Vec::new();
        for (step, window) in sampled.windows(3).enumerate() {
            // Strict on one side only, so that a minimum between two equal samples is found once.
            if window[1] < window[0] && window[1] <= window[2] {
                let wave_number = golden_section(place(step), place(step + 2), strain).exp();
                found.push(Minimum {
                    wave_number,
                    strain: self.strain(wave_number),
                });
            }
        }
        found
    }
}

/// Place in `[start, end]` where `value` is smallest, to about the root of the rounding.
fn golden_section(start: f64, end: f64, value: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    // Closer, values differ by rounding alone.
    const WIDTH: f64 = 1e-8;
    let (mut start, mut end) = (start, end);
    let mut inner = [end - GOLDEN * (end - start), start + GOLDEN * (end - start)];
    let mut values = inner.map(&value);
    while end - start > WIDTH {
        if values[0] < values[1] {
            end = inner[1];
            inner = [end - GOLDEN * (end - start), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            start = inner[0];
            inner = [inner[1], start + GOLDEN * (end - start)];
            values = [values[1], value(inner[1])];
        }
    }
    0.5 * (start + end)
}
