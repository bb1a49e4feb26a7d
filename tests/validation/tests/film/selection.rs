//! The film chooses its own wavelength: from a cold start, in a box that is no multiple of it,
//! whatever the onset.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_validation::{Film, FilmSpec};

const ROWS: usize = 20;

/// Mean wavelength (m) at 1.5 critical strains over three seeds, in a box of `waves` predicted ones.
fn simulated_wavelength(spec: &FilmSpec, waves: f64) -> f64 {
    let mut film = Film::new(spec, spec.strip(waves, 12));
    let found = [1, 2, 3].map(|seed| {
        let steps = film.ramp(&[1.5], seed);
        let last = steps.last().expect("some step");
        assert!(last.solve.converged);
        last.relative_wavelength
    });
    println!("box of {waves}: lam {found:.3?}");
    found.iter().sum::<f64>() / 3.0 * film.wrinkling.wavelength
}

/// Li 2014, fig. 3-3: a quarter of the thickness, 64 times the modulus.
#[test]
fn wavelength_scales_with_thickness_and_cube_root_of_modulus() {
    let spec = FilmSpec::flat(20.0);
    let (mut thin, mut stiff) = (spec, spec);
    thin.film.thickness /= 4.0;
    stiff.film.young *= 64.0;
    // Different boxes, none of them whole waves, so that the film has to find the number; half a
    // wave is 3 %.
    let reference = simulated_wavelength(&spec, 16.3);
    let quarter = simulated_wavelength(&thin, 17.3) / reference;
    let fourfold = simulated_wavelength(&stiff, 18.2) / reference;
    println!("thickness / 4: {quarter:.4}; modulus x 64: {fourfold:.3}");
    assert!((4.0 * quarter - 1.0).abs() < 0.05);
    assert!((fourfold / 4.0 - 1.0).abs() < 0.05);
}

#[test]
fn cold_start_finds_the_wavelength_from_every_seed() {
    let spec = FilmSpec::flat(150.0);
    let waves = 8.0;
    let mut film = Film::new(&spec, spec.strip(waves, ROWS));
    for seed in 1..=4 {
        let step = film.cold_start(3.0, seed);
        println!(
            "seed {seed}: lam {:.3}  A {:.3}  gap {:.3}  iterations {}",
            step.relative_wavelength,
            step.relative_amplitude,
            step.relative_gap,
            step.solve.iterations
        );
        assert!(step.solve.converged);
        assert!(step.solve.iterations <= 40);
        // One half-wave of 16.
        assert!((1.0 / step.relative_wavelength - 1.0).abs() < 0.5 / waves + 1e-9);
    }
}

/// A wrong `K1` cannot be seen in the wavelength, only in the onset: by a third when doubled.
#[test]
fn doubled_gradient_stiffness_moves_the_onset_alone() {
    let spec = FilmSpec::flat(150.0);
    let doubled = FilmSpec {
        gradient_factor: 2.0,
        ..spec
    };
    let [(onset, wavelength), (late_onset, late_wavelength)] = [spec, doubled].map(|spec| {
        let mut film = Film::new(&spec, spec.strip(8.0, ROWS));
        let onset = film.onset(0.9, 1.6);
        let steps = film.ramp(&[2.0], 1);
        let last = steps.last().expect("some step");
        println!(
            "K1 x {}: onset {onset:.4}  lam {:.3}",
            spec.gradient_factor, last.relative_wavelength
        );
        (onset, last.relative_wavelength)
    });
    assert!((late_onset / onset / (1.369 / 1.018) - 1.0).abs() < 0.02);
    assert!((1.0 / late_wavelength - 1.0 / wavelength).abs() < 0.5 / 8.0 + 1e-9);
}
