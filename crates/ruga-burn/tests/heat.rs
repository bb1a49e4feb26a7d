//! Heat flows as it does on a surface: right rate, right order, conserved, without new extremes.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_burn::{BurnLaw, BurnSettings, BurnSolver, BurnState, FrontCorrection};
use ruga_mesh::{PerVertex, VertexId};
use sheets::{SURROUNDINGS, Sheet, irregular, strip, tube, unit_front};

/// Heat alone: the sheet stays below ignition, steps are taken whole.
const HEAT: BurnSettings = BurnSettings {
    advance: None,
    correction: FrontCorrection::Uncorrected,
};

fn solver(sheet: &Sheet, law: BurnLaw) -> BurnSolver {
    BurnSolver::new(sheet.field(), law, HEAT).unwrap()
}

fn warm(sheet: &Sheet, temperature: PerVertex<f64>) -> BurnState {
    let fuel = PerVertex::filled(temperature.len(), 1.0);
    BurnState::new(&sheet.field(), temperature, fuel).unwrap()
}

fn law(diffusivity: f64) -> BurnLaw {
    BurnLaw {
        diffusivity,
        ..unit_front(3.43).law().unwrap()
    }
}

/// Part of `cos(k x)` in the temperature, in kelvin.
fn mode(sheet: &Sheet, solver: &BurnSolver, state: &BurnState, k: f64) -> f64 {
    let (mut sum, mut norm) = (0.0, 0.0);
    for (v, area) in solver.mesh().areas().iter() {
        let wave = (k * sheet.positions[v.0 as usize].x).cos();
        sum += area * wave * (state.temperature()[v] - 350.0);
        norm += area * wave * wave;
    }
    sum / norm
}

/// Relative error of `a k²` as one step shows it, on an irregular mesh of `edges` per wave of length 1.
fn rate_error(edges: usize, seed: u64) -> f64 {
    let sheet = irregular([edges, edges], 1.0 / edges as f64, 0.2, seed);
    let k = std::f64::consts::TAU;
    let (diffusivity, step) = (0.1, 0.05);
    let mut solver = solver(&sheet, law(diffusivity));
    let mut state = warm(&sheet, sheet.per_vertex(|x| 350.0 + 40.0 * (k * x.x).cos()));
    let before = mode(&sheet, &solver, &state, k);
    solver.step(&mut state, &[], step).unwrap();
    let after = mode(&sheet, &solver, &state, k);
    (before / after - 1.0) / step / (diffusivity * k * k) - 1.0
}

#[test]
fn a_wave_decays_at_the_right_rate_to_second_order_in_the_edge() {
    let mean = |edges| {
        let errors = (0..4).map(|seed| rate_error(edges, seed).abs());
        errors.sum::<f64>() / 4.0
    };
    let [coarse, middle, fine] = [8, 16, 32].map(mean);
    println!("rate error {coarse:.4} {middle:.4} {fine:.4}");
    assert!((0..4).all(|seed| rate_error(16, seed).abs() < 0.02));
    assert!(coarse / middle > 3.0 && middle / fine > 3.0);
}

#[test]
fn a_wave_decays_to_first_order_in_the_step() {
    let k = std::f64::consts::TAU;
    let sheet = strip(64, 1.0 / 64.0);
    let error = |steps: usize| {
        let mut solver = solver(&sheet, law(0.1));
        let mut state = warm(&sheet, sheet.per_vertex(|x| 350.0 + 40.0 * (k * x.x).cos()));
        for _ in 0..steps {
            solver.step(&mut state, &[], 0.2 / steps as f64).unwrap();
        }
        mode(&sheet, &solver, &state, k) / (40.0 * (-0.1 * k * k * 0.2).exp()) - 1.0
    };
    let [coarse, fine, finest] = [10, 20, 40].map(error);
    println!("step error {coarse:.4} {fine:.4} {finest:.4}");
    assert!(coarse > 0.0 && (coarse / fine - 2.0).abs() < 0.25);
    assert!((fine / finest - 2.0).abs() < 0.25);
}

#[test]
fn a_point_source_spreads_as_a_gaussian() {
    let (cells, edge, diffusivity, time) = (64, 1.0 / 64.0, 1.0, 0.004);
    let sheet = irregular([cells, cells], edge, 0.2, 11);
    let mut solver = solver(&sheet, law(diffusivity));
    let centre = (cells / 2) * (cells + 1) + cells / 2;
    let mut temperature = PerVertex::filled(sheet.positions.len(), 300.0);
    temperature[VertexId(centre as u32)] += 190.0;
    let heat = 190.0 * solver.mesh().areas()[VertexId(centre as u32)];
    let mut state = warm(&sheet, temperature);
    let steps = 200;
    for _ in 0..steps {
        solver.step(&mut state, &[], time / steps as f64).unwrap();
    }
    let peak = heat / (4.0 * std::f64::consts::PI * diffusivity * time);
    let (mut sum, mut count) = (0.0, 0.0);
    for (x, t) in sheet.positions.iter().zip(state.temperature().as_slice()) {
        let distance = (x - sheet.positions[centre]).norm_squared() / (4.0 * diffusivity * time);
        if distance < 4.0 {
            sum += ((t - 300.0) / peak - (-distance).exp()).powi(2);
            count += 1.0;
        }
    }
    let error = f64::sqrt(sum / count);
    println!("gaussian rms {error:.4}");
    assert!(error < 0.02, "{error}");
}

#[test]
fn heat_is_kept() {
    for (sheet, seed) in [
        (irregular([20, 15], 0.1, 0.35, 2), 1),
        (tube([12, 9], 0.1, 0.35, 2), 2),
    ] {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let noise: PerVertex<f64> = sheet
            .positions
            .iter()
            .map(|_| random.random_range(250.0..490.0))
            .collect();
        for step in [1e-6, 1e-2, 1.0, 1e6] {
            let mut solver = solver(&sheet, law(1.0));
            let mut state = warm(&sheet, noise.clone());
            let before = state.heat_content(solver.mesh());
            for _ in 0..20 {
                solver.step(&mut state, &[], step).unwrap();
            }
            let drift = state.heat_content(solver.mesh()) / before - 1.0;
            println!("drift {step} {drift:.1e}");
            assert!(drift.abs() < 1e-12, "{step} {drift}");
        }
    }
}

#[test]
fn no_step_makes_a_new_extreme() {
    // Slivers and obtuse triangles on purpose: a sheared, jittered sheet, and one rolled up.
    let mut sheared = irregular([24, 24], 0.1, 0.4, 7);
    for x in &mut sheared.positions {
        x.x += 2.5 * x.y;
    }
    for sheet in [sheared, tube([24, 12], 0.1, 0.4, 7)] {
        assert!(sheet.field().flips() > 0);
        let mut random = Pcg64Mcg::seed_from_u64(4);
        let noise: PerVertex<f64> = sheet
            .positions
            .iter()
            .map(|_| {
                if random.random_range(0..9) == 0 {
                    490.0
                } else {
                    310.0
                }
            })
            .collect();
        for exponent in -6..=6 {
            let mut solver = solver(&sheet, law(1.0));
            let mut state = warm(&sheet, noise.clone());
            for _ in 0..3 {
                solver.step(&mut state, &[], 10_f64.powi(exponent)).unwrap();
                let bounds = 310.0 * (1.0 - 1e-12)..=490.0 * (1.0 + 1e-12);
                let values = state.temperature().as_slice();
                let worst = values.iter().find(|t| !bounds.contains(*t));
                assert_eq!(worst, None, "dt 1e{exponent}");
            }
        }
    }
}

#[test]
fn an_even_temperature_stays_and_loss_follows_the_loss_time() {
    let sheet = irregular([10, 10], 0.1, 0.3, 9);
    let mut even = warm(&sheet, sheet.per_vertex(|_| 420.0));
    solver(&sheet, law(1.0)).step(&mut even, &[], 10.0).unwrap();
    assert!(even.temperature().as_slice().iter().all(|&t| t == 420.0));

    let losing = BurnLaw {
        loss_time: Some(4.0),
        ..law(1.0)
    };
    let mut solver = solver(&sheet, losing);
    let mut state = warm(&sheet, sheet.per_vertex(|_| 420.0));
    for _ in 0..400 {
        solver.step(&mut state, &[], 0.01).unwrap();
    }
    let left = (state.temperature().as_slice()[0] - SURROUNDINGS) / 120.0;
    assert!((left / (-1.0_f64).exp() - 1.0).abs() < 0.002, "{left}");
}

#[test]
fn a_bent_sheet_conducts_as_the_flat_one() {
    let flat = irregular([30, 20], 0.05, 0.3, 13);
    let roll = |x: &Vector3<f64>| {
        let (sin, cos) = (x.y / 5.0).sin_cos();
        Vector3::new(x.x, 5.0 * sin, 5.0 * cos)
    };
    let bent = Sheet {
        mesh: flat.mesh.clone(),
        positions: flat.positions.iter().map(roll).collect(),
    };
    let temperatures = [&flat, &bent].map(|sheet| {
        let mut state = warm(
            sheet,
            flat.per_vertex(|x| 350.0 + 90.0 * (4.0 * x.x * x.y).sin()),
        );
        let mut solver = solver(sheet, law(1.0));
        solver.step(&mut state, &[], 0.01).unwrap();
        state.temperature().clone()
    });
    let [flat, bent] = temperatures;
    for (v, t) in flat.iter() {
        assert!((t - bent[v]).abs() < 1e-3, "{t} {}", bent[v]);
    }
}
