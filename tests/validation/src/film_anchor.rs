//! A film on a half-space against the finite-strain anchors (exact continuum, 48 points per
//! wavelength): onset `eps_c (1 + eps_c)`, wavelength `lam_c (1 + eps_c / 3)` and amplitudes.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_stepper::Modelling;

use crate::FlatFilm;

/// Loads in critical strains.
const LOADS: [f64; 5] = [1.25, 1.5, 2.0, 3.0, 4.0];

/// A stiff film on a soft half-space, and what the exact continuum makes of it.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// Modulus of the film over that of the base.
    pub ratio: f64,
    /// Amplitudes at 1.25, 1.5, 2, 3 and 4 critical strains over `(2/k) sqrt(eps - eps_c)`.
    pub amplitudes: [f64; 5],
}

/// A film 150 times as stiff as its base.
pub const SOFTER: Anchor = Anchor {
    ratio: 150.0,
    amplitudes: [0.951, 0.972, 0.978, 0.975, 0.970],
};

/// A film 1000 times as stiff as its base.
pub const STIFFER: Anchor = Anchor {
    ratio: 1000.0,
    amplitudes: [0.986, 0.992, 0.994, 0.994, 0.992],
};

/// Compares a film of standard quality with its anchor, on an artist's mesh of squares or on one that is
/// uneven by a seed.
///
/// The sides of a patch six wavelengths wide, and the ends of the part that is compressed, raise the onset
/// by 1 %.
///
/// # Panics
/// When onset, wavelength or amplitudes are not what they ought to be.
pub fn check_film(anchor: Anchor, mesh_seed: Option<u64>) {
    let Anchor { ratio, amplitudes } = anchor;
    let name = format!("ratio {ratio}, mesh {mesh_seed:?}");
    let film = FlatFilm {
        waves: [6.0, 6.0],
        mesh_seed,
        ..FlatFilm::new(ratio)
    };
    let strain = film.theory().critical_strain;
    let modelling = Modelling::standard();
    let (_, states) = film.states(&modelling, &LOADS);
    let onset = film.onset(&modelling).expect("a film");
    let onset = onset.expect("a film that buckles");
    println!("{name}: onset {onset:.4}, anchor {:.4}", 1.0 + strain);
    let error = onset / (1.0 + strain) - 1.0;
    assert!((-0.005..0.02).contains(&error), "onset {error:+.4}");
    for ((load, anchor), state) in LOADS.iter().zip(amplitudes).zip(&states) {
        let wavelength = state.relative_wavelength / (1.0 + strain / 3.0) - 1.0;
        let amplitude = state.relative_amplitude / anchor - 1.0;
        println!(
            "{name}: load {load}, errors of wavelength {wavelength:+.4}, amplitude {amplitude:+.4}"
        );
        assert!(
            wavelength.abs() < 0.025,
            "wavelength at {load}: {wavelength:+.4}"
        );
        assert!(
            amplitude.abs() < 0.03,
            "amplitude at {load}: {amplitude:+.4}"
        );
    }
}
