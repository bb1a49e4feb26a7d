//! Motion in time: where it ends, and that it takes time.

mod patch;

use std::cell::Cell;

use patch::{draft, driver, pose, skin};
use ruga_solver::{
    Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError, StopRule, minimise,
};
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

thread_local! {
    /// Whether the skin has once been asked whether it rests.
    static IS_ASKED: Cell<bool> = const { Cell::new(false) };
}

/// Newton's method, which finds no step once the skin was asked whether it rests.
fn fails_at_rest(
    objective: &dyn Objective,
    targets: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let is_question = settings.max_iterations == 1;
    let was_asked = IS_ASKED.replace(IS_ASKED.get() || is_question);
    let solve = minimise(objective, targets, x, kkt, settings, keep_going)?;
    Ok(match was_asked && !is_question {
        true => SolveReport {
            converged: false,
            stop: StopRule::IterationLimit,
            ..solve
        },
        false => solve,
    })
}

/// What a solve has left without an end of a step is no result.
#[test]
fn a_step_to_rest_that_is_not_found_gives_no_key() {
    let result = run(&Modelling {
        dynamics: Some(Dynamics {
            time_step: 1e-3,
            damping: 0.5,
        }),
        minimise: fails_at_rest,
        ..draft()
    });
    assert!(!result.converged);
    assert!(result.keys.is_empty());
    let told = result.warnings.iter();
    let mut told = told.filter(|w| w.contains("no step in time found"));
    assert!(told.next().is_some(), "{:?}", result.warnings);
}
