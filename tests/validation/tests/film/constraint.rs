//! Low-pass rows alone, as the papers have them: they set the wavelength by their spacing, let
//! the film buckle at a third of the critical strain, and claim nothing about amplitude.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_shell::BendingModel;
use ruga_validation::{Film, FilmCoupling, FilmSpec};

#[test]
fn rows_alone_set_the_wavelength_and_buckle_early() {
    let spec = FilmSpec {
        // A hex lattice then lets the wavelength itself through.
        coupling: FilmCoupling::Constraint(1.0 / 3.0_f64.sqrt()),
        bending: BendingModel::Hinge,
        ..FilmSpec::flat(150.0)
    };
    // 2.3 wavelengths wide, so that the lattice has rows.
    let mut film = Film::new(&spec, spec.strip(8.0, 32));
    let onset = film.onset(0.05, 1.15);
    println!("{} averages, onset {onset:.3}", film.average_count());
    // A perfect lattice: 0.33 along one axis, 0.39 along the other.
    assert!((0.28..0.42).contains(&onset));

    let steps = film.ramp(&[1.0, 2.0], 1);
    for step in &steps {
        println!(
            "load {:.3}  lam {:.3}  A/h {:.3}  A {:.3}  iterations {}",
            step.load,
            step.relative_wavelength,
            step.amplitude / spec.film.thickness,
            step.relative_amplitude,
            step.solve.iterations
        );
    }
    let landed = steps.iter().find(|step| step.solve.left_saddle);
    let landed = landed.expect("the film buckles");
    assert!(landed.load < 1.15 * onset);
    // A perfect lattice: 1.00 to 1.14.
    assert!((0.93..1.2).contains(&landed.relative_wavelength));

    // Spurious at the critical strain already, where the film should still be smooth.
    let critical = steps.iter().find(|step| (step.load - 1.0).abs() < 1e-9);
    let height = critical.expect("every load is hit").amplitude / spec.film.thickness;
    assert!((0.6..1.0).contains(&height));

    let last = steps.last().expect("some step");
    assert!(last.solve.converged && (last.load - 2.0).abs() < 1e-9);
    // Nothing but bending opposes shorter waves, and stress far above the onset makes them;
    // `sqrt((eps - eps_c/3)/(eps - eps_c))` is 1.29.
    assert!((0.7..1.0).contains(&last.relative_wavelength));
    assert!((1.15..1.45).contains(&last.relative_amplitude));
}
