//! A straight front has the speed and the width of the closed form, in every direction.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use ruga_burn::{BurnLaw, BurnSolver, Front, FrontCorrection};
use ruga_mesh::PerVertex;
use sheets::{
    HEAT_RATIOS, IGNITION, SURROUNDINGS, crossing_times, fitted_speed, lit, settings, strip,
    strip_speed, tube, turned, unit_front,
};

/// Speed on a strip with `cells` per width and substeps in which the front goes `advance` cells.
fn speed(heat_ratio: f64, cells: f64, advance: f64, correction: FrontCorrection) -> f64 {
    let (edge, ash) = (1.0 / cells, 6.0);
    let sheet = strip((30.0 * cells) as usize, edge);
    let law = unit_front(heat_ratio).law().unwrap();
    let mut solver =
        BurnSolver::new(sheet.field(), law, settings(2.0 * advance, correction)).unwrap();
    let mut state = lit(&sheet, 1.1 * law.burning(), |x| x.x - ash);
    strip_speed(
        &mut solver,
        &mut state,
        [edge, advance * edge],
        [12.0, 19.0],
    )
}

#[test]
fn closed_form() {
    // p, g, burning zone in widths: the table of the closed form.
    let table = [
        [2.0, 0.2865, 1.11],
        [3.43, 0.4440, 2.01],
        [5.71, 0.5559, 2.89],
        [14.3, 0.6946, 4.52],
    ];
    for [heat_ratio, g, zone] in table {
        let law = unit_front(heat_ratio).law().unwrap();
        let front = Front::of(&law).unwrap();
        assert!((front.speed - 1.0).abs() < 1e-9 && (front.width - 1.0).abs() < 1e-9);
        assert!((front.burnt - law.burning()).abs() < 1e-6 * law.burning());
        assert!((front.burning_length - zone).abs() < 0.006, "{front:?}");
        let rate = law.diffusivity * law.adiabatic_rise * law.burn_rate;
        assert!((front.speed / (2.0 * rate.sqrt()) - g).abs() < 3e-4);
        let (g, p) = (front.speed / (2.0 * rate.sqrt()), heat_ratio);
        let angle = (std::f64::consts::PI - g.acos()) / (1.0 - g * g).sqrt();
        assert!((2.0 * g * (g * angle).exp() / (p - 1.0) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn discrete_front_is_a_little_slow() {
    for heat_ratio in HEAT_RATIOS {
        for (cells, tolerance) in [(4.0, 0.03), (8.0, 0.015), (16.0, 0.01)] {
            let error = speed(heat_ratio, cells, 0.1, FrontCorrection::Uncorrected) - 1.0;
            println!("uncorrected {heat_ratio} {cells} {:.2} %", error * 100.0);
            assert!(
                error < 0.0 && error > -tolerance,
                "{heat_ratio} {cells} {error}"
            );
        }
    }
}

#[test]
fn corrected_front_has_the_speed_of_the_closed_form() {
    for heat_ratio in HEAT_RATIOS {
        for (cells, tolerance) in [(2.0, 0.012), (4.0, 0.002), (16.0, 0.0005)] {
            let error = speed(heat_ratio, cells, 0.2, FrontCorrection::Corrected) - 1.0;
            println!("corrected {heat_ratio} {cells} {:.3} %", error * 100.0);
            assert!(error.abs() < tolerance, "{heat_ratio} {cells} {error}");
        }
        // Steps two and a half times as long as the default ones.
        let error = speed(heat_ratio, 4.0, 0.5, FrontCorrection::Corrected) - 1.0;
        println!("long steps {heat_ratio} {:.3} %", error * 100.0);
        assert!(error.abs() < 0.016, "{heat_ratio} {error}");
    }
}

#[test]
fn same_speed_in_eight_directions() {
    let (size, edge) = ([24.0, 5.0], 0.25);
    let law = unit_front(3.43).law().unwrap();
    let mut speeds = Vec::new();
    for k in 0..8 {
        let angle = std::f64::consts::TAU * (f64::from(k) + 0.2) / 8.0;
        let sheet = turned(size, edge, angle, 3);
        let mut state = lit(&sheet, 1.1 * law.burning(), |x| x.x - 5.0);
        let settings = settings(0.2, FrontCorrection::Corrected);
        let mut solver = BurnSolver::new(sheet.field(), law, settings).unwrap();
        let times = crossing_times(&mut solver, &mut state, 0.05, 18.0);
        speeds.push(fitted_speed(&sheet, &times, |x| x.x > 14.0 && x.x < 20.0));
    }
    println!("directions {speeds:.4?}");
    assert!(speeds.iter().all(|c| (c - 1.0).abs() < 0.015), "{speeds:?}");
}

#[test]
fn same_speed_on_a_tube() {
    let edge = 0.25;
    let sheet = tube([88, 40], edge, 0.25, 5);
    let law = unit_front(3.43).law().unwrap();
    let mut state = lit(&sheet, 1.1 * law.burning(), |x| x.x - 5.0);
    let field = sheet.field();
    assert!(field.clipped() <= 4, "only borders may have obtuse angles");
    let mut solver =
        BurnSolver::new(field, law, settings(0.4, FrontCorrection::Corrected)).unwrap();
    let times = crossing_times(&mut solver, &mut state, 0.05, 16.0);
    let speed = fitted_speed(&sheet, &times, |x| x.x > 12.0 && x.x < 17.0);
    println!("tube {speed:.4}");
    assert!((speed - 1.0).abs() < 0.015, "{speed}");
}

#[test]
fn preheated_length() {
    for (correction, tolerance) in [
        (FrontCorrection::Corrected, 0.005),
        (FrontCorrection::Uncorrected, 0.05),
    ] {
        for heat_ratio in HEAT_RATIOS {
            let (cells, edge) = (8.0, 0.125);
            let sheet = strip((30.0 * cells) as usize, edge);
            let law = unit_front(heat_ratio).law().unwrap();
            let mut solver =
                BurnSolver::new(sheet.field(), law, settings(0.4, correction)).unwrap();
            let mut state = lit(&sheet, 1.1 * law.burning(), |x| x.x - 4.0);
            for _ in 0..640 {
                solver.step(&mut state, &[], 0.2 * edge).unwrap();
            }
            let width = decay_length(&sheet, state.temperature());
            println!("width {heat_ratio} {correction:?} {width:.4}");
            assert!((width - 1.0).abs() < tolerance, "{heat_ratio} {width}");
        }
    }
}

/// Length over which the temperature ahead of the front falls by a factor e, by a line through logarithms.
fn decay_length(sheet: &sheets::Sheet, temperature: &PerVertex<f64>) -> f64 {
    let (mut sums, mut count) = ([0.0; 4], 0.0);
    for (x, t) in sheet.positions.iter().zip(temperature.as_slice()) {
        let v = (t - SURROUNDINGS) / (IGNITION - SURROUNDINGS);
        if v < 0.8 && v > 0.05 {
            let (x, y) = (x.x, v.ln());
            for (sum, term) in sums.iter_mut().zip([x, y, x * x, x * y]) {
                *sum += term;
            }
            count += 1.0;
        }
    }
    let [x, y, xx, xy] = sums;
    -(count * xx - x * x) / (count * xy - x * y)
}

#[test]
fn painted_speed_scales_the_front_at_the_same_width() {
    let (cells, edge) = (4.0, 0.25);
    let sheet = strip((40.0 * cells) as usize, edge);
    let law = unit_front(5.71).law().unwrap();
    // Half as fast up to 20, then 1.5 times as fast.
    let factors = sheet.per_vertex(|x| if x.x < 20.0 { 0.5 } else { 1.5 });
    let settings = settings(0.2, FrontCorrection::Corrected);
    let mut solver = BurnSolver::with_speed_factors(sheet.field(), law, factors, settings).unwrap();
    let mut state = lit(&sheet, 1.1 * law.burning(), |x| x.x - 5.0);
    let substep = 0.2 * edge / 1.5;
    assert_eq!(solver.substeps(0.9 * substep).unwrap(), 1);
    let times = crossing_times(&mut solver, &mut state, substep, 45.0);
    let time_at = |x: f64| times[(x / edge).round() as usize];
    let slow = 6.0 / (time_at(18.0) - time_at(12.0));
    let fast = 8.0 / (time_at(36.0) - time_at(28.0));
    println!("painted {slow:.4} {fast:.4}");
    assert!((slow / 0.5 - 1.0).abs() < 0.01 && (fast / 1.5 - 1.0).abs() < 0.01);
    let faster = BurnLaw {
        diffusivity: 1.5 * law.diffusivity,
        burn_rate: 1.5 * law.burn_rate,
        ..law
    };
    let front = Front::of(&faster).unwrap();
    assert!((front.speed - 1.5).abs() < 1e-9 && (front.width - 1.0).abs() < 1e-9);
}

#[test]
fn meshes_too_coarse_for_a_front_still_burn() {
    // One cell per width, a third, and a burning zone of a tenth of a width.
    for (heat_ratio, cells) in [(3.43, 1.0), (3.43, 0.3), (1.05, 4.0)] {
        let edge = 1.0 / cells;
        let sheet = strip(40, edge);
        let law = unit_front(heat_ratio).law().unwrap();
        let settings = settings(0.2, FrontCorrection::Corrected);
        let mut solver = BurnSolver::new(sheet.field(), law, settings).unwrap();
        let mut state = lit(&sheet, 4.0 * law.burning(), |x| x.x - 10.0 * edge);
        let whole = state.fuel_left(solver.mesh());
        for _ in 0..20 {
            solver.step(&mut state, &[], 0.1 * edge).unwrap();
        }
        let burnt = whole - state.fuel_left(solver.mesh());
        assert!(
            burnt > 0.0 && burnt.is_finite(),
            "{heat_ratio} {cells} {burnt}"
        );
        let hottest = state
            .temperature()
            .as_slice()
            .iter()
            .copied()
            .fold(0.0, f64::max);
        assert!(hottest <= 4.0 * law.burning() + law.adiabatic_rise);
    }
}
