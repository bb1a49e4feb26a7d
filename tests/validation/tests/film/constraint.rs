//! Averaging constraints alone, as the papers have them, on hinges: the film is up at the critical
//! strain already, its waves are too short beyond it and too high.

use ruga_stepper::{BendingModel, Coupling, EdgeLimits, Modelling};
use ruga_validation::FlatFilm;

#[test]
fn rows_alone_buckle_early_into_short_waves() {
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
    let (_, states) = film.states(&modelling, &[1.0, 2.0]);
    let thickness = film.layer.material.thickness;
    for state in &states {
        let height = state.amplitude / thickness;
        println!("A/h {height:.3}, {state:?}");
    }
    // Spurious at the critical strain already, where the film should still be smooth.
    let [critical, twice] = [0, 1].map(|i| states[i]);
    assert!((0.3..1.0).contains(&(critical.amplitude / thickness)));
    // Nothing but bending opposes shorter waves, and stress far above the onset makes them.
    assert!((0.7..1.05).contains(&twice.relative_wavelength));
    assert!((1.05..1.45).contains(&twice.relative_amplitude));
}
