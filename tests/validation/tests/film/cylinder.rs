//! Film on a cylinder of five wavelengths, modulus ratio 150.
//!
//! On springs alone the film leaves its base to shed compression, by `N/(R K0)`, which delays the
//! onset by `chi = C/(R^2 K0) = 0.165`. Rows or the base's reaction keep it there. Onsets are
//! those of a whole tube: at pinned ends the film comes back to the base in ripples, wrinkles
//! start from these, and no state turns unstable before 1.2 critical strains.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use std::f64::consts::TAU;

use ruga_validation::{Base, BaseReaction, Film, FilmCoupling, FilmSpec, equilateral_tube};

const RATIO: f64 = 150.0;
/// Waves of the strip, and around the tube.
const WAVES: f64 = 8.0;
const TUBE_WAVES: f64 = 31.0;
/// Rows of triangles: 1.5 wavelengths, or averages 1.5 wavelengths apart have no room.
const ROWS: usize = 20;
/// Amplitude on a flat base at 2 critical strains, from a fine reference solution.
const FLAT_AMPLITUDE: f64 = 0.978;

struct Measured {
    /// Onset on the tube over the onset on a flat strip.
    relative_onset: f64,
    /// On an arc of 8 waves: mean height over the thickness at 0.9 critical strains.
    lift: f64,
    /// Amplitude over theory's at 2 critical strains.
    amplitude: f64,
    /// Mean height over the amplitude at 2 critical strains.
    offset: f64,
}

fn measure(coupling: FilmCoupling, reaction: BaseReaction) -> Measured {
    let flat = FilmSpec {
        coupling,
        reaction,
        ..FilmSpec::flat(RATIO)
    };
    let wavelength = flat.theory().wavelength;
    let flat_onset = Film::new(&flat, flat.strip(WAVES, ROWS)).onset(0.9, 1.3);

    let circle = TUBE_WAVES * wavelength;
    let tube = FilmSpec {
        base: Base::Tube(circle / TAU),
        ..flat
    };
    let columns = (TUBE_WAVES * FilmSpec::POINTS) as usize;
    let onset = Film::new(&tube, equilateral_tube(circle, columns, ROWS)).onset(0.9, 1.3);

    let arc = FilmSpec {
        base: Base::Cylinder(5.0 * wavelength),
        ..flat
    };
    let steps = Film::new(&arc, arc.strip(WAVES, ROWS)).ramp(&[0.9, 1.5, 2.0], 1);
    let first = steps.first().expect("some step");
    let lift = first.relative_offset * first.amplitude / flat.film.thickness;
    let last = steps.last().expect("some step");
    assert!(last.solve.converged && (last.load - 2.0).abs() < 1e-9);
    println!(
        "{coupling:?} + {reaction:?}: onset flat {flat_onset:.4} tube {onset:.4}, at .9: offset/h {lift:+.3}, at 2: lam {:.3} \
         A {:.3} offset/A {:+.3}",
        last.relative_wavelength, last.relative_amplitude, last.relative_offset
    );
    assert!((first.load - 0.9).abs() < 1e-9);
    Measured {
        lift,
        relative_onset: onset / flat_onset,
        amplitude: last.relative_amplitude,
        offset: last.relative_offset,
    }
}

fn check_held(measured: &Measured, onset_tolerance: f64, lift_tolerance: f64) {
    assert!((measured.relative_onset - 1.0).abs() < onset_tolerance);
    assert!(measured.lift.abs() < lift_tolerance);
    assert!((measured.amplitude / FLAT_AMPLITUDE - 1.0).abs() < 0.03);
    assert!(measured.offset.abs() < 0.1);
}

#[test]
fn springs_alone_delay_the_onset() {
    let measured = measure(FilmCoupling::Elastic, BaseReaction::None);
    assert!((0.12..0.19).contains(&(measured.relative_onset - 1.0)));
    // `N/(R K0)`; wrinkled, the film carries the critical force and sits higher still.
    assert!((0.2..0.3).contains(&measured.lift));
    assert!((0.3..0.45).contains(&measured.offset));
    assert!(measured.amplitude < 0.93);
}

#[test]
fn rows_hold_the_film() {
    check_held(
        &measure(FilmCoupling::Hybrid, BaseReaction::None),
        0.04,
        0.03,
    );
}

#[test]
fn the_reaction_holds_the_film() {
    let reaction = BaseReaction::UpToCritical;
    check_held(&measure(FilmCoupling::Elastic, reaction), 0.03, 1e-3);
}

#[test]
fn rows_and_reaction_hold_the_film() {
    let reaction = BaseReaction::UpToCritical;
    check_held(&measure(FilmCoupling::Hybrid, reaction), 0.03, 1e-3);
}
