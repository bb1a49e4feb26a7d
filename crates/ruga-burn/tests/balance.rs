//! Mass and heat balance in every step, and fuel and temperature stay in their ranges.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::Vector3;
use ruga_burn::{
    BurnLaw, BurnSettings, BurnSolver, BurnState, Prospect, Radiation, Source, StepReport,
};
use ruga_mesh::{FaceId, PerFace, PerVertex};
use sheets::{SURROUNDINGS, Sheet, irregular, lit, strip, tube, unit_front};

/// A law with all that changes heat.
fn full_law() -> BurnLaw {
    BurnLaw {
        loss_time: Some(25.0),
        radiation: Some(Radiation {
            emissivity: 0.9,
            areal_heat_capacity: 9e3,
        }),
        ..unit_front(3.43).law().unwrap()
    }
}

fn ember(sheet: &Sheet, centre: Vector3<f64>, radius: f64) -> Source {
    let near = |x: &Vector3<f64>| (2.0 - (x - centre).norm() / radius).clamp(0.0, 1.0);
    Source {
        temperature: 1300.0,
        coefficient: 5.0,
        weights: sheet.per_vertex(near),
    }
}

/// Checks that a step changed heat and fuel by what its report says, to 1e-10 of the whole.
fn check(solver: &BurnSolver, before: &BurnState, after: &BurnState, report: &StepReport) {
    let heat = [before, after].map(|state| state.heat_content(solver.mesh()));
    let fuel = [before, after].map(|state| state.fuel_left(solver.mesh()));
    let gained = heat[1] - heat[0];
    assert!(
        (gained - report.heat.gain()).abs() < 1e-10 * heat[0],
        "{report:?}"
    );
    assert!((fuel[0] - fuel[1] - report.burnt).abs() < 1e-10 * fuel[0].max(1e-3));
    let fire = report.burnt * solver.law().adiabatic_rise;
    assert!((report.heat.fire - fire).abs() < 1e-10 * heat[0]);
    let fuels = after.fuel().as_slice();
    assert!(fuels.iter().all(|share| (0.0..=1.0).contains(share)));
}

#[test]
fn fuel_heat_and_losses_balance() {
    let [flat, round] = [
        irregular([24, 20], 0.25, 0.3, 3),
        tube([24, 20], 0.25, 0.3, 3),
    ];
    for sheet in [flat, round] {
        let factors = sheet.per_vertex(|x| 1.0 + 0.6 * (2.0 * x.x).sin());
        let settings = BurnSettings::default();
        let mut solver =
            BurnSolver::with_speed_factors(sheet.field(), full_law(), factors, settings).unwrap();
        let mut state = BurnState::fresh(solver.mesh(), SURROUNDINGS).unwrap();
        let mut total = StepReport::default();
        for k in 0..120 {
            // An ember that moves, and a share of the sheet that goes.
            let along = 0.05 * f64::from(k);
            let sources = [ember(&sheet, Vector3::new(along, 1.0, 0.0), 0.7)];
            if k % 10 == 9 {
                let gone = |(f, _): (FaceId, _)| if f.0 % 97 < k / 10 { 0.3 } else { 1.0 };
                let shares: PerFace<f64> = sheet.mesh.faces().iter().map(gone).collect();
                solver.set_conducting(&shares).unwrap();
            }
            let before = state.clone();
            let report = solver.step(&mut state, &sources, 0.1).unwrap();
            check(&solver, &before, &state, &report);
            total.burnt += report.burnt;
            total.heat.sources += report.heat.sources;
            total.heat.loss += report.heat.loss;
            total.heat.radiation += report.heat.radiation;
        }
        println!("{total:.3?}");
        assert!(total.burnt > 5.0 && total.heat.sources > 0.0, "{total:?}");
        assert!(total.heat.loss > 0.0 && total.heat.radiation > 0.0);
    }
}

#[test]
fn without_loss_all_heat_is_that_of_the_fuel() {
    let sheet = strip(60, 0.25);
    let law = unit_front(5.71).law().unwrap();
    let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
    let mut state = lit(&sheet, law.burning(), |x| x.x - 3.0);
    let before = state.heat_content(solver.mesh());
    let fuel = state.fuel_left(solver.mesh());
    while !state.is_burnt_out() {
        solver.step(&mut state, &[], 0.5).unwrap();
    }
    let gained = state.heat_content(solver.mesh()) - before;
    assert!((gained / (fuel * law.adiabatic_rise) - 1.0).abs() < 1e-10);
    assert_eq!(state.prospect(&law, &[]), Prospect::BurntOut);
    // Burnt out, the sheet may be stepped on.
    let report = solver.step(&mut state, &[], 0.5).unwrap();
    assert_eq!((report.burnt, report.heat.fire), (0.0, 0.0));
}

/// Highest temperature that a fire on a sheet reaches.
fn hottest(sheet: &Sheet, law: BurnLaw, mut state: BurnState, steps: usize) -> f64 {
    let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
    let mut hottest = 0.0;
    for _ in 0..steps {
        solver.step(&mut state, &[], 0.05).unwrap();
        hottest = state
            .temperature()
            .as_slice()
            .iter()
            .copied()
            .fold(hottest, f64::max);
    }
    hottest
}

#[test]
fn a_fire_from_ash_stays_below_burning_temperature() {
    for heat_ratio in [2.0, 14.3] {
        let law = unit_front(heat_ratio).law().unwrap();
        let sheet = strip(80, 0.25);
        let state = lit(&sheet, law.burning(), |x| x.x - 5.0);
        let hottest = hottest(&sheet, law, state, 280);
        println!("hottest {heat_ratio} {:.4}", hottest / law.burning());
        assert!(hottest < 1.01 * law.burning(), "{hottest}");
    }
}

#[test]
fn fires_that_meet_are_hotter_by_what_they_have_preheated() {
    let law = unit_front(3.43).law().unwrap();
    let excess = [4.0, 8.0].map(|cells| {
        let sheet = strip((20.0 * cells) as usize, 1.0 / cells);
        let state = lit(&sheet, law.burning(), |x| (x.x - 5.0).min(15.0 - x.x));
        let hottest = hottest(&sheet, law, state, 200);
        (hottest - law.burning()) / (law.ignition - law.surroundings)
    });
    println!("meeting {excess:.3?}");
    // In both fronts the heat ahead of the burnt is more than its fuel will give: it adds up.
    assert!((excess[0] - 2.15).abs() < 0.1 && (excess[1] - 2.15).abs() < 0.1);
}

#[test]
fn hot_fuel_adds_its_rise_to_its_heat() {
    let law = unit_front(3.43).law().unwrap();
    let sheet = strip(20, 0.25);
    let field = sheet.field();
    let hot = PerVertex::filled(field.vertex_count(), 900.0);
    let fuel = PerVertex::filled(field.vertex_count(), 1.0);
    let state = BurnState::new(&field, hot, fuel).unwrap();
    let hottest = hottest(&sheet, law, state, 400);
    // The ends of the strip, whose edges are shorter on average, burn a little slower.
    assert!(
        (hottest - 900.0 - law.adiabatic_rise).abs() < 1.0,
        "{hottest}"
    );
}
