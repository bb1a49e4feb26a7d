//! Averaging constraints alone, as the papers have them: their spacing sets the wavelength, the film
//! buckles below the critical strain, and nothing is claimed about amplitude.

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
    // Spurious at the critical strain already, where the film should still be smooth.
    let [_, critical, twice, _] = [0, 1, 2, 3].map(|i| states[i]);
    assert!((0.3..1.0).contains(&(critical.amplitude / thickness)));
    // Nothing but bending opposes shorter waves, and stress far above the onset makes them.
    assert!((0.7..1.05).contains(&twice.relative_wavelength));
    assert!((1.05..1.45).contains(&twice.relative_amplitude));
}
