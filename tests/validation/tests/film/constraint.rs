//! Averaging constraints alone, as the papers have them: they set the wavelength by their spacing, let
//! the film buckle below the critical strain, and claim nothing about amplitude.

use ruga_stepper::{BendingModel, Coupling, EdgeLimits, Modelling};
use ruga_validation::FlatFilm;

#[test]
fn rows_alone_set_the_wavelength_and_buckle_early() {
    let mut film = FlatFilm::new(150.0);
    film.layer.coupling = Coupling::Constraint;
    let modelling = Modelling {
        bending: BendingModel::Hinge,
        remesh: Some(EdgeLimits {
            aspect: 2.0,
            ..EdgeLimits::default()
        }),
        ..Modelling::standard()
    };
    let (_, states) = film.states(&modelling, &[0.5, 1.0, 2.0, 4.0]);
    let thickness = film.layer.material.thickness;
    for state in &states {
        let height = state.amplitude / thickness;
        println!("A/h {height:.3}, {state:?}");
    }
    // Spurious below the critical strain, where the film should still be smooth; a perfect lattice
    // buckles at 0.33 of it along one axis, at 0.39 along the other.
    let [half, critical, twice, _] = [0, 1, 2, 3].map(|i| states[i]);
    assert!(half.amplitude > 0.1 * thickness);
    assert!((0.6..1.0).contains(&(critical.amplitude / thickness)));
    // Nothing but bending opposes shorter waves, and stress far above the onset makes them;
    // `sqrt((eps - eps_c/3)/(eps - eps_c))` is 1.29.
    assert!((0.7..1.05).contains(&twice.relative_wavelength));
    assert!((1.15..1.45).contains(&twice.relative_amplitude));
}
