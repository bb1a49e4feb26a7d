//! A strip of film in plane strain as a chain of points, over half a wave.
//!
//! Crest and trough are planes of symmetry, so that nothing can slide and no wave is counted
//! twice; the length of the box is the half wave. Waves that merge or split are outside.

use ruga_material::Wrinkling;

use super::analytic::{BendingLaw, Onset};
use super::chain_energy::ChainEnergy;
use super::dense_newton::newton;
use super::lowest;

/// A film on Pasternak springs, and how finely it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// Stiffnesses of the film and its springs, and the scales of linear theory.
    pub film: Wrinkling,
    /// How bending feels the stretch.
    pub bending: BendingLaw,
    /// Points per wave, even; 32 to 64.
    pub points: usize,
}

/// A film in equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainState {
    /// `sqrt(2)` RMS height about its mean, m.
    pub amplitude: f64,
    /// Energy per rest area less that of the flat film, J/m^2.
    pub energy_gap: f64,
    /// Heights of the points of a half wave, m, from crest to trough.
    pub heights: Vec<f64>,
    /// Newton steps.
    pub iterations: usize,
    /// Whether the last step was short enough.
    pub converged: bool,
}

/// Shares of the critical wavelength between which the best one is looked for.
const WAVELENGTHS: [f64; 2] = [0.8, 1.35];

/// Strain up to which a flat film is asked for its stability.
const LARGEST_STRAIN: f64 = 0.4;

/// How closely wavelengths are searched for.
const FINE: f64 = 1e-5;

impl Chain {
    /// Where the flat film becomes unstable first, over all wavelengths.
    pub fn onset(&self) -> Onset {
        let [low, high] = WAVELENGTHS.map(|share| share * self.film.wavelength);
        let wavelength = lowest(low, high, FINE, |wavelength| self.onset_at(wavelength));
        Onset {
            strain: self.onset_at(wavelength),
            wavelength,
        }
    }

    /// Strain at which the flat film becomes unstable against one wavelength (m) and its
    /// harmonics.
    pub fn onset_at(&self, wavelength: f64) -> f64 {
        let is_stable = |strain: f64| {
            let energy = self.energy(strain, wavelength);
            let (_, _, hessian) = energy.derivatives(&energy.flat());
            hessian.cholesky().is_some()
        };
        let (mut low, mut high) = (0.0, LARGEST_STRAIN);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if is_stable(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Wavelength (m) of least energy at a strain beyond the onset.
    pub fn best_wavelength(&self, strain: f64) -> f64 {
        let [low, high] = WAVELENGTHS.map(|share| share * self.film.wavelength);
        lowest(low, high, FINE, |wavelength| {
            self.wrinkled(strain, wavelength).energy_gap
        })
    }

    /// The film at a strain, in waves of one length (m); the flat state below the onset.
    pub fn wrinkled(&self, strain: f64, wavelength: f64) -> ChainState {
        let energy = self.energy(strain, wavelength);
        let guess = self
            .film
            .amplitude(strain)
            .max(0.1 * self.film.amplitude(2.0 * strain));
        let mut state = energy.sine(guess);
        let (iterations, converged) = newton(
            energy.length(),
            &|state| energy.value(state),
            &|state| energy.derivatives(state),
            &mut state,
        );
        let heights = state.as_slice()[..=energy.segments].to_vec();
        ChainState {
            amplitude: energy.amplitude(&state),
            energy_gap: (energy.value(&state) - energy.value(&energy.flat())) / energy.length(),
            heights,
            iterations,
            converged,
        }
    }

    fn energy(&self, strain: f64, wavelength: f64) -> ChainEnergy {
        ChainEnergy {
            film: self.film,
            bending: self.bending,
            segments: self.points / 2,
            segment: wavelength / self.points as f64,
            strain,
        }
    }
}
