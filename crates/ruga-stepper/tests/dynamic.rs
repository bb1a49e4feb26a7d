//! Motion in time: where it ends, and that it takes time.

mod patch;

use patch::{draft, driver, pose, skin};
use ruga_stepper::{Coupling, Dynamics, Modelling, PoseResult, Silent, plan};

fn run(modelling: &Modelling) -> PoseResult {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let poses = [pose(&driver, "press", 1.0)];
    let plan = plan(&driver, &layers, &poses, modelling, 1024).expect("a valid scene");
    plan.simulate(0, &mut Silent).expect("a valid scene")
}

fn moving(time_step: f64, damping: f64) -> PoseResult {
    run(&Modelling {
        dynamics: Some(Dynamics { time_step, damping }),
        ..draft()
    })
}

/// The energies of both agree to 1 % when the skin rests.
#[test]
fn motion_ends_where_the_equilibria_are() {
    let still = run(&draft());
    let moved = moving(0.02, 0.5);
    assert!(moved.converged, "{:?}", moved.warnings);
    assert_eq!(moved.keys.len(), still.keys.len());
    let [still, moved] = [&still.layers[0], &moved.layers[0]];
    let energy = moved.energy / still.energy;
    assert!((energy - 1.0).abs() < 0.01, "energy {energy}");
    let wavelength = moved.wavelength.expect("wrinkles") / still.wavelength.expect("wrinkles");
    assert!((wavelength - 1.0).abs() < 0.1, "wavelength {wavelength}");
}

/// In two milliseconds the skin, whose waves take ten, has not come to rest.
#[test]
fn a_short_time_is_not_enough_to_rest() {
    let result = moving(1e-5, 0.5);
    assert!(!result.converged);
    assert!(
        result.warnings.iter().any(|w| w.contains("still moving")),
        "{:?}",
        result.warnings
    );
}
