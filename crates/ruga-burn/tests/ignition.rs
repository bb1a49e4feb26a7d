//! Fires start from sources and hot places, and only where these are hot enough.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use ruga_burn::{
    BurnLaw, BurnSettings, BurnSolver, BurnState, FrontCorrection, Prospect, Radiation, Source,
};
use ruga_mesh::PerVertex;
use sheets::{SURROUNDINGS, Sheet, irregular, lit, strip, unit_front};

fn source(sheet: &Sheet, temperature: f64, coefficient: f64) -> Source {
    Source {
        temperature,
        coefficient,
        weights: sheet.per_vertex(|x| if x.x < 2.0 { 1.0 } else { 0.0 }),
    }
}

/// Fuel that a source burns within 20 units of time, as a share of the whole.
fn burnt_by(temperature: f64, coefficient: f64) -> f64 {
    let sheet = strip(48, 0.25);
    let law = unit_front(3.43).law().unwrap();
    let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
    let mut state = BurnState::fresh(solver.mesh(), SURROUNDINGS).unwrap();
    let sources = [source(&sheet, temperature, coefficient)];
    let mut burnt = 0.0;
    for _ in 0..200 {
        burnt += solver.step(&mut state, &sources, 0.1).unwrap().burnt;
        let temperatures = state.temperature().as_slice();
        assert!(
            temperatures
                .iter()
                .all(|&t| t >= SURROUNDINGS * (1.0 - 1e-12))
        );
    }
    burnt / 12.0 / 0.25
}

#[test]
fn sources_set_on_fire() {
    // Touching briskly, gently, and so strongly that an explicit step would explode.
    assert!([1e1, 1.0, 1e9].iter().all(|&h| burnt_by(1000.0, h) > 0.9));
    assert_eq!(burnt_by(450.0, 10.0), 0.0);
    assert_eq!(burnt_by(1000.0, 0.0), 0.0);
}

#[test]
fn a_source_draws_the_sheet_to_its_temperature_exponentially() {
    let sheet = strip(8, 0.25);
    let law = unit_front(3.43).law().unwrap();
    let even = |temperature: f64, coefficient: f64| Source {
        temperature,
        coefficient,
        weights: sheet.per_vertex(|_| 0.5),
    };
    // Two sources act like one at the mean of their temperatures, weighted by their coefficients.
    for sources in [
        vec![even(420.0, 2.0)],
        vec![even(400.0, 1.5), even(480.0, 0.5)],
    ] {
        let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
        let mut state = BurnState::fresh(solver.mesh(), SURROUNDINGS).unwrap();
        for _ in 0..10 {
            solver.step(&mut state, &sources, 0.1).unwrap();
        }
        let expected = 420.0 - 120.0 * (-1.0_f64).exp();
        let error = state.temperature().as_slice()[5] - expected;
        assert!(error.abs() < 1e-8, "{error}");
    }
}

#[test]
fn a_starter_must_be_hot_enough() {
    let law = unit_front(5.71).law().unwrap();
    let check = law.starter(650.0);
    assert_eq!((check.meeting, check.least), (475.0, 700.0));
    assert!(!check.is_hot_enough && law.starter(701.0).is_hot_enough);
    // Ash far wider than a front, beside fresh sheet.
    let burns = |hot: f64| {
        let sheet = strip(240, 0.125);
        let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
        let mut state = lit(&sheet, hot, |x| x.x - 15.0);
        let steps = (0..60).map(|_| solver.step(&mut state, &[], 0.2).unwrap().burnt);
        steps.sum::<f64>() > 0.0
    };
    assert!(burns(1.05 * check.least) && !burns(0.97 * check.least));
}

#[test]
fn prospects() {
    let sheet = irregular([8, 8], 0.25, 0.2, 1);
    let law = unit_front(3.43).law().unwrap();
    let field = sheet.field();
    let cold = BurnState::fresh(&field, SURROUNDINGS).unwrap();
    let nothing = Prospect::NothingWillBurn {
        hottest: SURROUNDINGS,
    };
    assert_eq!(cold.prospect(&law, &[]), nothing);
    assert_eq!(cold.prospect(&law, &[source(&sheet, 480.0, 1.0)]), nothing);
    let mut nowhere = source(&sheet, 1000.0, 1.0);
    nowhere.weights = sheet.per_vertex(|_| 0.0);
    assert_eq!(cold.prospect(&law, &[nowhere]), nothing);
    assert_eq!(cold.prospect(&law, &[source(&sheet, 1000.0, 0.0)]), nothing);
    let may_ignite = cold.prospect(&law, &[source(&sheet, 1000.0, 1.0)]);
    assert_eq!(may_ignite, Prospect::MayIgnite);
    let ash = lit(&sheet, 1000.0, |x| x.x - 1.0);
    assert_eq!(ash.prospect(&law, &[]), Prospect::MayIgnite);
    let burning = BurnState::fresh(&field, 600.0).unwrap();
    assert_eq!(burning.prospect(&law, &[]), Prospect::Burning);
}

#[test]
fn radiation_cools_hot_places_most_and_never_below_the_surroundings() {
    let sheet = strip(4, 0.25);
    let law = BurnLaw {
        radiation: Some(Radiation {
            emissivity: 0.8,
            areal_heat_capacity: 100.0,
        }),
        ..unit_front(3.43).law().unwrap()
    };
    let settings = BurnSettings {
        advance: None,
        correction: FrontCorrection::Uncorrected,
    };
    let cooled = |hot: f64, step: f64, steps: usize| {
        let mut solver = BurnSolver::new(sheet.field(), law, settings).unwrap();
        let count = solver.mesh().vertex_count();
        let mut fuel = PerVertex::filled(count, 0.0);
        // Fuel in one corner keeps the sheet from being burnt out; it burns off in the first step.
        fuel.as_mut_slice()[0] = 1e-12;
        let mut state = BurnState::new(solver.mesh(), PerVertex::filled(count, hot), fuel).unwrap();
        for _ in 0..steps {
            solver.step(&mut state, &[], step).unwrap();
        }
        state.temperature().as_slice()[3]
    };
    // dT/dt = -k T⁴ while the surroundings do not count: T⁻³ grows by 3 k per second.
    let k = 2.0 * 0.8 * 5.670_374_419e-8 / 100.0;
    let exact = (3000.0_f64.powi(-3) + 3.0 * k * 0.02).powf(-1.0 / 3.0);
    let [coarse, fine] = [100, 200].map(|n| cooled(3000.0, 0.02 / n as f64, n) / exact - 1.0);
    println!("radiation {coarse:.5} {fine:.5}");
    assert!(fine.abs() < 2e-3 && (coarse / fine - 2.0).abs() < 0.2);
    assert!(cooled(3000.0, 1e3, 3) >= SURROUNDINGS);
    assert!((cooled(3000.0, 1e3, 3) - SURROUNDINGS).abs() < 1e-6);
}
