//! A front that is asked for by speed and width comes out, on any mesh.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use ruga_burn::{BurnSettings, BurnSolver, BurnState, Front, FrontDesign};
use sheets::{SURROUNDINGS, Sheet, lit, strip, strip_speed, turned};

/// Paper in millimetres per second.
const PAPER: FrontDesign = FrontDesign {
    speed: 2e-3,
    width: 5e-3,
    ignition: 573.0,
    burning: 1100.0,
    surroundings: SURROUNDINGS,
    loss_time: None,
};

fn designs() -> [FrontDesign; 4] {
    [
        PAPER,
        FrontDesign {
            loss_time: Some(60.0),
            ..PAPER
        },
        // Smouldering, narrow and slow.
        FrontDesign {
            speed: 1e-4,
            width: 1e-3,
            ignition: 450.0,
            burning: 900.0,
            loss_time: Some(200.0),
            ..PAPER
        },
        FrontDesign {
            speed: 0.3,
            width: 0.04,
            burning: 2200.0,
            loss_time: Some(2.0),
            ..PAPER
        },
    ]
}

#[test]
fn the_law_has_the_front_that_was_asked_for() {
    for design in designs() {
        let front = Front::of(&design.law().unwrap()).unwrap();
        assert!((front.speed / design.speed - 1.0).abs() < 1e-9, "{front:?}");
        assert!((front.width / design.width - 1.0).abs() < 1e-9, "{front:?}");
        assert!(front.burnt <= design.burning + 1e-6 && front.burnt > design.ignition);
    }
}

/// Speed and width of the front on a mesh of `cells` per width.
fn measured(design: &FrontDesign, cells: f64) -> [f64; 2] {
    let edge = design.width / cells;
    let sheet = strip((40.0 * cells) as usize, edge);
    let law = design.law().unwrap();
    let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
    let mut state = lit(&sheet, law.burning(), |x| x.x - 6.0 * design.width);
    let clock = [edge, 0.2 * edge / design.speed];
    let between = [12.0, 20.0].map(|k| k * design.width);
    let speed = strip_speed(&mut solver, &mut state, clock, between);
    [speed, width(design, &sheet, &state)]
}

/// Length over which the temperature falls by a factor e between the vertices around half of ignition.
fn width(design: &FrontDesign, sheet: &Sheet, state: &BurnState) -> f64 {
    let excess = |share: f64| share * (design.ignition - design.surroundings);
    let points = sheet.positions.iter().zip(state.temperature().as_slice());
    let ahead: Vec<_> = points
        .map(|(x, t)| (x.x, t - design.surroundings))
        .filter(|(_, v)| *v < excess(0.8) && *v > excess(0.08))
        .collect();
    let (first, last) = (ahead.first().unwrap(), ahead.last().unwrap());
    (last.0 - first.0) / (first.1 / last.1).ln()
}

#[test]
fn runs_have_the_speed_and_the_width_that_were_asked_for() {
    for design in designs() {
        let [speed, width] = measured(&design, 4.0);
        let [speed, width] = [speed / design.speed - 1.0, width / design.width - 1.0];
        println!("design {speed:.4} {width:.4}");
        assert!(speed.abs() < 0.02 && width.abs() < 0.02, "{design:?}");
    }
}

#[test]
fn halved_and_doubled_mesh_have_the_same_speed() {
    for design in designs() {
        let [coarse, middle, fine] = [2.0, 4.0, 8.0].map(|cells| measured(&design, cells)[0]);
        println!("meshes {:.4} {:.4}", coarse / middle, fine / middle);
        assert!((coarse / middle - 1.0).abs() < 0.02, "{design:?}");
        assert!((fine / middle - 1.0).abs() < 0.02, "{design:?}");
    }
}

#[test]
fn steps_of_any_length_have_the_same_speed() {
    let design = PAPER;
    let edge = design.width / 4.0;
    let sheet = turned([24.0 * design.width, 3.0 * design.width], edge, 0.3, 1);
    let law = design.law().unwrap();
    let burnt = [0.01, 0.02, 0.5].map(|time_step| {
        let mut solver = BurnSolver::new(sheet.field(), law, BurnSettings::default()).unwrap();
        let mut state = lit(&sheet, law.burning(), |x| x.x - 6.0 * design.width);
        let (mut burnt, mut early) = (0.0, 0.0);
        for k in 1..=(35.0 / time_step) as usize {
            let report = solver.step(&mut state, &[], time_step).unwrap();
            let most = 0.2 * solver.mesh().mean_edge() / design.speed;
            assert!(report.substep <= most && report.substep * 2.0 > most.min(time_step));
            let whole = f64::from(report.substeps) * report.substep;
            assert!((whole - time_step).abs() < 1e-12 * time_step);
            burnt += report.burnt;
            if k == (15.0 / time_step) as usize {
                early = burnt;
            }
        }
        (burnt - early) / (3.0 * design.width) / 20.0
    });
    println!("steps {burnt:?}");
    assert!(burnt.iter().all(|c| (c / design.speed - 1.0).abs() < 0.01));
}
