//! Loss of heat slows a front, and kills it where theory says.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use ruga_burn::{
    BurnError, BurnLaw, BurnSolver, Front, FrontCorrection, FrontDeath, FrontDesign, Prospect,
};
use sheets::{lit, settings, strip, strip_speed, unit_front};

fn losing(heat_ratio: f64, loss_time: f64) -> BurnLaw {
    BurnLaw {
        loss_time: Some(loss_time),
        ..unit_front(heat_ratio).law().unwrap()
    }
}

#[test]
fn speed_with_loss() {
    // Loss time in a/c² and speed in c, of the front without loss, at a heat ratio of 14.3.
    for (loss_time, expected) in [(40.0, 0.948), (20.0, 0.892), (10.0, 0.763)] {
        let law = losing(14.3, loss_time);
        let front = Front::of(&law).unwrap();
        assert!((front.speed - expected).abs() < 6e-4, "{front:?}");
        for (cells, correction, tolerance) in [
            (8.0, FrontCorrection::Uncorrected, 0.015),
            (4.0, FrontCorrection::Corrected, 0.005),
        ] {
            let edge = 1.0 / cells;
            let sheet = strip((36.0 * cells) as usize, edge);
            let settings = settings(0.4, correction);
            let mut solver = BurnSolver::new(sheet.field(), law, settings).unwrap();
            let mut state = lit(&sheet, law.burning(), |x| x.x - 6.0);
            let clock = [edge, 0.2 * edge];
            let speed = strip_speed(&mut solver, &mut state, clock, [12.0, 22.0]);
            let error = speed / front.speed - 1.0;
            println!(
                "loss time {loss_time} {correction:?} {:.2} %",
                error * 100.0
            );
            assert!(error.abs() < tolerance, "{loss_time} {speed} {front:?}");
        }
    }
}

#[test]
fn fronts_live_above_the_least_loss_time_and_die_below() {
    // Heat ratio, least loss time in a/c², speed there in c.
    let table = [
        (2.0, 19.7, 0.60),
        (3.43, 11.3, 0.54),
        (5.71, 8.25, 0.48),
        (14.3, 5.85, 0.40),
    ];
    for (heat_ratio, least, speed) in table {
        let death = FrontDeath::of(&losing(heat_ratio, 1.0)).unwrap();
        println!("death {heat_ratio} {death:.4?}");
        assert!((death.loss_time / least - 1.0).abs() < 0.005, "{death:?}");
        assert!((death.speed - speed).abs() < 0.015, "{death:?}");
        assert!(burns_through(heat_ratio, 1.1 * least), "{heat_ratio}");
        assert!(!burns_through(heat_ratio, 0.9 * least), "{heat_ratio}");
    }
}

/// Whether a fire on a strip of 36 widths is alive after 25 of them.
fn burns_through(heat_ratio: f64, loss_time: f64) -> bool {
    let (cells, edge) = (8.0, 0.125);
    let law = losing(heat_ratio, loss_time);
    let sheet = strip((36.0 * cells) as usize, edge);
    let settings = settings(0.2, FrontCorrection::Corrected);
    let mut solver = BurnSolver::new(sheet.field(), law, settings).unwrap();
    let mut state = lit(&sheet, 1.2 * law.burning(), |x| x.x - 6.0);
    while state.fuel_left(solver.mesh()) > 5.0 * edge {
        solver.step(&mut state, &[], 0.5).unwrap();
        if let Prospect::NothingWillBurn { hottest } = state.prospect(&law, &[]) {
            assert!(hottest <= law.ignition);
            return false;
        }
    }
    true
}

#[test]
fn a_front_that_dies_is_refused_with_the_least_loss_time() {
    for heat_ratio in [1.2, 2.0, 14.3, 300.0] {
        let least = FrontDeath::of(&losing(heat_ratio, 1.0)).unwrap().loss_time;
        let error = Front::of(&losing(heat_ratio, 0.99 * least)).unwrap_err();
        let BurnError::FrontDies {
            loss_time,
            least: told,
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!((loss_time, told), (0.99 * least, least));
        let living = Front::of(&losing(heat_ratio, 1.001 * least)).unwrap();
        let death = FrontDeath::of(&losing(heat_ratio, 1.0)).unwrap();
        assert!(living.speed > death.speed && living.speed < 1.2 * death.speed);
    }
}

#[test]
fn a_design_beyond_death_is_refused_with_the_least_loss_time() {
    let design = |loss_time| FrontDesign {
        loss_time: Some(loss_time),
        ..unit_front(3.43)
    };
    let error = design(1.0).law().unwrap_err();
    let BurnError::FrontDies {
        loss_time: 1.0,
        least,
    } = error
    else {
        panic!("{error}");
    };
    assert!(design(0.999 * least).law().is_err());
    let law = design(1.001 * least).law().unwrap();
    let front = Front::of(&law).unwrap();
    assert!((front.speed - 1.0).abs() < 1e-6 && (front.width - 1.0).abs() < 1e-6);
    let death = FrontDeath::of(&law).unwrap();
    assert!(death.loss_time < 1.001 * least && death.loss_time > 0.9 * least);
}

#[test]
fn little_loss_is_no_loss() {
    for heat_ratio in [1.5, 5.71, 100.0] {
        let front = Front::of(&losing(heat_ratio, 1e9)).unwrap();
        let lossless = Front::of(&unit_front(heat_ratio).law().unwrap()).unwrap();
        assert!((front.speed / lossless.speed - 1.0).abs() < 1e-6);
        assert!((front.burning_length / lossless.burning_length - 1.0).abs() < 1e-6);
        assert!((front.burnt / lossless.burnt - 1.0).abs() < 1e-6);
    }
}
