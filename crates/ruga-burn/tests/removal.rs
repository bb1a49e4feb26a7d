//! Removed material conducts no heat, and the solver keeps up with what goes.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::Vector3;
use ruga_burn::{BurnLaw, BurnSettings, BurnSolver, BurnState, FrontCorrection};
use ruga_mesh::{PerFace, PerVertex, VertexId};
use sheets::{Sheet, irregular, unit_front};

const SETTINGS: BurnSettings = BurnSettings {
    advance: None,
    correction: FrontCorrection::Uncorrected,
};

/// A share for each face, by its centre.
fn shares(sheet: &Sheet, of: impl Fn(Vector3<f64>) -> f64) -> PerFace<f64> {
    let faces = sheet.mesh.faces().as_slice().iter();
    let centre = |f: &[ruga_mesh::VertexId; 3]| {
        f.map(|v| sheet.positions[v.0 as usize])
            .iter()
            .sum::<Vector3<f64>>()
            / 3.0
    };
    faces.map(|f| of(centre(f))).collect()
}

fn warm(sheet: &Sheet, of: impl Fn(&Vector3<f64>) -> f64) -> BurnState {
    let fuel = PerVertex::filled(sheet.positions.len(), 1.0);
    BurnState::new(&sheet.field(), sheet.per_vertex(of), fuel).unwrap()
}

fn law() -> BurnLaw {
    unit_front(3.43).law().unwrap()
}

#[test]
fn no_heat_crosses_a_gap() {
    // Sheared, so that many of its edges are flipped, some of them across the gap.
    let mut sheet = irregular([24, 16], 0.25, 0.3, 5);
    for x in &mut sheet.positions {
        x.x += 1.5 * x.y;
    }
    let across = |x: &Vector3<f64>| x.x - 1.5 * x.y;
    let mut solver = BurnSolver::new(sheet.field(), law(), SETTINGS).unwrap();
    assert!(solver.mesh().flips() > 100);
    let gap = shares(&sheet, |x| {
        if (across(&x) - 3.0).abs() < 0.6 {
            0.0
        } else {
            1.0
        }
    });
    solver.set_conducting(&gap).unwrap();
    let mut state = warm(&sheet, |x| if across(x) < 3.0 { 480.0 } else { 310.0 });
    let content = state.heat_content(solver.mesh());
    for _ in 0..50 {
        solver.step(&mut state, &[], 0.5).unwrap();
    }
    for (x, &t) in sheet.positions.iter().zip(state.temperature().as_slice()) {
        let expected = if across(x) < 3.0 { 480.0 } else { 310.0 };
        assert!((t - expected).abs() < 1e-9, "{t} at {x}");
    }
    assert!((state.heat_content(solver.mesh()) / content - 1.0).abs() < 1e-12);
}

#[test]
fn half_a_face_conducts_half() {
    let sheet = irregular([12, 12], 0.25, 0.3, 2);
    let halved = BurnLaw {
        diffusivity: 0.5 * law().diffusivity,
        ..law()
    };
    let results = [(law(), 0.5), (halved, 1.0)].map(|(law, share)| {
        let mut solver = BurnSolver::new(sheet.field(), law, SETTINGS).unwrap();
        let mut state = warm(&sheet, |x| 400.0 + 50.0 * x.x.sin());
        // Once before the first factorisation, once after.
        solver.set_conducting(&shares(&sheet, |_| share)).unwrap();
        solver.step(&mut state, &[], 0.3).unwrap();
        solver.set_conducting(&shares(&sheet, |_| 1.0)).unwrap();
        solver.set_conducting(&shares(&sheet, |_| share)).unwrap();
        solver.step(&mut state, &[], 0.3).unwrap();
        state.into_parts().0
    });
    for (v, t) in results[0].iter() {
        assert!((t - results[1][v]).abs() < 1e-9);
    }
}

#[test]
fn the_factor_is_kept_until_it_takes_more_than_eight_iterations() {
    let sheet = irregular([40, 40], 0.25, 0.3, 8);
    let mut solver = BurnSolver::new(sheet.field(), law(), SETTINGS).unwrap();
    let mut state = warm(&sheet, |x| 400.0 + 50.0 * (x.x + 2.0 * x.y).sin());
    let first = solver.step(&mut state, &[], 0.02).unwrap();
    assert_eq!((first.factorisations, first.iterations), (1, 1));
    let again = solver.step(&mut state, &[], 0.02).unwrap();
    assert_eq!((again.factorisations, again.iterations), (0, 1));

    // A few faces that thin out are made up for by some iterations.
    let thinned = shares(&sheet, |x| if x.norm() < 0.5 { 0.9 } else { 1.0 });
    solver.set_conducting(&thinned).unwrap();
    let few = solver.step(&mut state, &[], 0.02).unwrap();
    println!("thinned {few:?}");
    assert!(few.factorisations == 0 && few.iterations > 1 && few.iterations <= 8);

    // Much of the sheet goes, in pieces: factorised anew, once.
    let torn = shares(&sheet, |x| ((3.0 * x.x).sin() * (2.0 * x.y).sin()).max(0.0));
    solver.set_conducting(&torn).unwrap();
    let anew = solver.step(&mut state, &[], 0.02).unwrap();
    println!("torn {anew:?}");
    assert_eq!(anew.factorisations, 1);
    let after = solver.step(&mut state, &[], 0.02).unwrap();
    assert_eq!((after.factorisations, after.iterations), (0, 1));
}

#[test]
fn a_torn_sheet_makes_no_new_extreme() {
    let sheet = irregular([30, 30], 0.25, 0.35, 4);
    let torn = shares(&sheet, |x| {
        ((9.0 * x.x).sin() + (7.0 * x.y).cos()).clamp(0.0, 1.0)
    });
    for step in [1e-4, 1.0, 1e4] {
        let mut solver = BurnSolver::new(sheet.field(), law(), SETTINGS).unwrap();
        solver.set_conducting(&torn).unwrap();
        let mut state = warm(&sheet, |x| {
            if (5.0 * x.x * x.y).sin() > 0.0 {
                310.0
            } else {
                490.0
            }
        });
        for _ in 0..3 {
            solver.step(&mut state, &[], step).unwrap();
            let values = state.temperature().as_slice();
            assert!(values.iter().all(|&t| t > 310.0 - 1e-9 && t < 490.0 + 1e-9));
        }
    }
}

#[test]
fn resumed_after_forgetting_is_the_same_to_the_last_bit() {
    let sheet = irregular([30, 30], 0.25, 0.3, 8);
    let thinned = shares(&sheet, |x| if x.norm() < 0.5 { 0.9 } else { 1.0 });
    let start = warm(&sheet, |x| 400.0 + 150.0 * (x.x + 2.0 * x.y).sin());
    let run = |solver: &mut BurnSolver, state: &mut BurnState| {
        for _ in 0..5 {
            solver.step(state, &[], 0.02).unwrap();
        }
    };
    let mut solver = BurnSolver::new(sheet.field(), law(), SETTINGS).unwrap();
    let mut through = start;
    run(&mut solver, &mut through);
    solver.set_conducting(&thinned).unwrap();
    solver.forget();
    let (temperature, fuel) = through.clone().into_parts();
    run(&mut solver, &mut through);

    let mut solver = BurnSolver::new(sheet.field(), law(), SETTINGS).unwrap();
    solver.set_conducting(&thinned).unwrap();
    let mut resumed = BurnState::restored(solver.mesh(), temperature, fuel).unwrap();
    run(&mut solver, &mut resumed);
    assert_eq!(resumed, through);
}

#[test]
fn dropped_fuel_is_told_and_gone() {
    let sheet = irregular([6, 6], 0.25, 0.3, 8);
    let field = sheet.field();
    let mut state = warm(&sheet, |_| 400.0);
    let whole = state.fuel_left(&field);
    let fallen = [3, 17, 3].map(VertexId);
    let dropped = state.drop_fuel(&field, &fallen);
    let areas = field.areas();
    assert!((dropped - areas[fallen[0]] - areas[fallen[1]]).abs() < 1e-15);
    assert!((whole - dropped - state.fuel_left(&field)).abs() < 1e-13);
    assert_eq!(state.fuel()[fallen[1]], 0.0);
}
