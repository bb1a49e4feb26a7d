//! Sheets that burn while the solver does not get to the end of a step.

mod fires;
mod flat_sheet;

use std::sync::atomic::{AtomicUsize, Ordering};

use fires::{PAPER, ball, burnt, fire, modelling, pose, run, sheet};
use flat_sheet::{paper, rectangle};
use ruga_solver::{
    Iteration, Kkt, Minimise, NewtonSettings, Objective, SolveReport, SolverError, minimise,
};
use ruga_stepper::{Modelling, Silent, plan_sheet};

/// A solve that gets to its end unless it fails.
fn solve(
    (objective, rows): (&dyn Objective, &[f64]),
    (x, kkt): (&mut [f64], &mut Kkt),
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
    fails: bool,
) -> Result<SolveReport, SolverError> {
    let solve = minimise(objective, rows, x, kkt, settings, keep_going)?;
    Ok(SolveReport {
        converged: solve.converged && !fails,
        ..solve
    })
}

/// The solver, which does not get to the end of its third solve.
fn failing_once(
    objective: &dyn Objective,
    rows: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    static SOLVES: AtomicUsize = AtomicUsize::new(0);
    let fails = SOLVES.fetch_add(1, Ordering::Relaxed) == 2;
    solve((objective, rows), (x, kkt), settings, keep_going, fails)
}

#[test]
fn a_step_is_divided_while_it_burns() {
    let (length, width) = (0.03, 0.01);
    let driver = rectangle([length, width], [15, 5]);
    let mut curling = fire(vec![ball(length, 0.5 * width, 0.008)]);
    curling.shrink.along = 0.2;
    let sheet = sheet(curling);
    let burn = |minimise: Minimise| {
        let modelling = Modelling {
            minimise,
            ..modelling(0.5)
        };
        let layer = paper(Vec::new());
        let plan = plan_sheet(&driver, &layer, &sheet, &[pose(10)], &modelling, 512);
        plan.and_then(|plan| plan.simulate(0, &mut Silent))
            .expect("it burns")
    };
    let [whole, divided] = [burn(minimise), burn(failing_once)];
    let is_about = |warning: &String| warning.contains("1 of its steps had to be divided");
    assert!(
        divided.warnings.iter().any(is_about),
        "{:?}",
        divided.warnings
    );
    assert!(!whole.warnings.iter().any(is_about));
    let [whole, divided] = [&whole, &divided].map(burnt);
    // Fuel that a step has burnt before it was given up is there again.
    let lost = whole.fuel_left - divided.fuel_left;
    assert!(whole.fuel_left < 0.9 && lost.abs() < 5e-3, "{lost}");
    let expected = PAPER * length * width * (0.2 + 0.8 * divided.fuel_left);
    assert!((divided.mass / expected - 1.0).abs() < 1e-9);
    // Halves of a step are divided into parts of the same length as whole ones.
    assert_eq!((whole.factorisations, divided.factorisations), (1, 1));
}

/// The solver, which gets to the end of no solve from the fifth on.
fn giving_up(
    objective: &dyn Objective,
    rows: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    static SOLVES: AtomicUsize = AtomicUsize::new(0);
    let fails = SOLVES.fetch_add(1, Ordering::Relaxed) >= 4;
    solve((objective, rows), (x, kkt), settings, keep_going, fails)
}

#[test]
fn a_run_that_gives_up_says_what_has_burnt_until_then() {
    let (length, width) = (0.03, 0.01);
    let driver = rectangle([length, width], [15, 5]);
    let sheet = sheet(fire(vec![ball(length, 0.5 * width, 0.008)]));
    let modelling = Modelling {
        minimise: giving_up,
        ..modelling(0.5)
    };
    let plan = plan_sheet(
        &driver,
        &paper(Vec::new()),
        &sheet,
        &[pose(10)],
        &modelling,
        512,
    );
    let result = plan
        .and_then(|plan| plan.simulate(0, &mut Silent))
        .expect("it begins");
    assert!(!result.converged);
    let layer = &result.layers[0];
    let fire = layer.fire.as_ref().expect("what is known");
    let short = run(&driver, &sheet, (10, 0.5)).expect("it burns");
    assert!(fire.fuel_left < 1.0 && fire.fuel_left > burnt(&short).fuel_left);
    let expected = PAPER * length * width * (0.2 + 0.8 * fire.fuel_left);
    assert!((fire.mass / expected - 1.0).abs() < 1e-9, "{fire:?}");
    assert_eq!(layer.intersections, Some(0));
}
