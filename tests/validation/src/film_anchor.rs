//! A film on a half-space against the finite-strain anchors (exact continuum, 48 points per
//! wavelength): onset `eps_c (1 + eps_c)`, wavelength `lam_c (1 + eps_c / 3)`, amplitudes and energy
//! gaps.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use crate::{Film, FilmSpec, Step, Strip, unstructured};

/// Waves in a strip.
const WAVES: usize = 8;
/// Rows of triangles: 1.5 wavelengths.
const ROWS: usize = 20;
/// Loads in critical strains.
const LOADS: [f64; 5] = [1.25, 1.5, 2.0, 3.0, 4.0];

/// A stiff film on a soft half-space, and what the exact continuum makes of it.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// Modulus of the film over that of the base.
    pub ratio: f64,
    /// Amplitudes at 1.25, 1.5, 2, 3 and 4 critical strains over `(2/k) sqrt(eps - eps_c)`.
    pub amplitudes: [f64; 5],
    /// Energy gaps at 3 and 4 critical strains over `-C/2 (eps - eps_c)^2`. The deviation from 1
    /// follows the critical strain.
    pub gaps: [f64; 2],
}

/// A film 150 times as stiff as its base.
pub const SOFTER: Anchor = Anchor {
    ratio: 150.0,
    amplitudes: [0.951, 0.972, 0.978, 0.975, 0.970],
    gaps: [0.900, 0.890],
};

/// A film 1000 times as stiff as its base.
pub const STIFFER: Anchor = Anchor {
    ratio: 1000.0,
    amplitudes: [0.986, 0.992, 0.994, 0.994, 0.992],
    gaps: [0.970, 0.970],
};

fn strip(spec: &FilmSpec, seed: Option<u64>) -> Strip {
    let even = spec.strip(WAVES as f64, ROWS);
    match seed {
        None => even,
        Some(seed) => unstructured(even.length, WAVES * FilmSpec::POINTS as usize, ROWS, seed),
    }
}

fn print(name: &str, steps: &[Step]) {
    for step in steps {
        println!(
            "{name}: load {:.3}  lam {:.3}  A {:.3}  gap {:.3}  iterations {}  factorizations {}  {:?}",
            step.load,
            step.relative_wavelength,
            step.relative_amplitude,
            step.relative_gap,
            step.solve.iterations,
            step.solve.factorizations,
            step.solve.stop,
        );
    }
}

/// Compares a film of eight waves with its anchor, on equilateral triangles or on an unstructured mesh of
/// a seed, and gives its number of waves.
///
/// # Panics
/// When onset, amplitudes, energy gaps or the solver's steps are not what they ought to be.
pub fn check_film(anchor: Anchor, seed: Option<u64>) -> f64 {
    let Anchor {
        ratio,
        amplitudes,
        gaps,
    } = anchor;
    let name = format!("ratio {ratio}, mesh {seed:?}");
    let spec = FilmSpec::flat(ratio);
    let mut film = Film::new(&spec, strip(&spec, seed));
    film.calibrate_bending();
    let onset = film.onset(0.9, 1.15);
    let expected = 1.0 + film.wrinkling.critical_strain;
    println!("{name}: onset {onset:.4}, anchor {expected:.4}");
    assert!((onset / expected - 1.0).abs() < 0.03, "onset {onset}");

    let steps = film.ramp(&LOADS, 1);
    print(&name, &steps);
    let first = steps
        .iter()
        .find(|step| step.solve.left_saddle)
        .expect("the film buckles");
    assert!(first.load < 1.15 * onset, "landed at {}", first.load);
    assert!(first.solve.iterations <= 12, "{}", first.solve.iterations);
    for step in steps.iter().filter(|step| step.load > first.load) {
        assert!(step.solve.converged);
        assert!(step.solve.iterations <= 6, "{}", step.solve.iterations);
        // Ends allow multiples of half a wave only; the next one costs 0.9 % of the energy gap.
        let waves = WAVES as f64 / step.relative_wavelength;
        assert!((waves - WAVES as f64).abs() < 0.6, "{waves} waves");
    }
    for (load, anchor) in LOADS.iter().zip(amplitudes).skip(1) {
        let error = at(&steps, *load).relative_amplitude / anchor - 1.0;
        assert!(error.abs() < 0.03, "amplitude at {load}: {error:+.3}");
    }
    for (load, anchor) in LOADS.iter().skip(3).zip(gaps) {
        let error = at(&steps, *load).relative_gap / anchor - 1.0;
        assert!(error.abs() < 0.03, "energy gap at {load}: {error:+.3}");
    }
    WAVES as f64 / steps.last().expect("a ramp").relative_wavelength
}

fn at(steps: &[Step], load: f64) -> &Step {
    steps
        .iter()
        .find(|step| (step.load - load).abs() < 1e-9)
        .expect("every load is hit")
}
