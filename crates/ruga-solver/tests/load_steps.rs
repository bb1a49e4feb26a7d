//! The sequence of loads for structures whose onset is known.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use ruga_solver::{LoadSettings, LoadStepper, Outcome, Verdict};

struct Run {
    /// Loads whose state was kept, in order.
    kept: Vec<f64>,
    trials: usize,
    gave_up: bool,
}

/// Runs a structure that is stable below `onset` and fails on steps longer than `longest`.
fn run(keys: &[f64], onset: f64, longest: f64) -> Run {
    let mut loads = LoadStepper::new(keys, LoadSettings::default()).unwrap();
    let (mut kept, mut trials, mut gave_up) = (vec![0.0], 0, false);
    while let Some(trial) = loads.next_trial() {
        trials += 1;
        assert!(trials < 1000);
        let last = kept[kept.len() - 1];
        assert!(trial.load > last && trial.load <= 1.0);
        let outcome = if trial.load - last > longest {
            Outcome::Failed
        } else if trial.load > onset && last <= onset {
            Outcome::Buckled
        } else {
            Outcome::Stable
        };
        match loads.report(outcome) {
            Verdict::Keep => kept.push(trial.load),
            Verdict::Discard => {}
            Verdict::GiveUp => gave_up = true,
        }
    }
    Run {
        kept,
        trials,
        gave_up,
    }
}

#[test]
fn lands_at_1_05_to_1_1_of_the_onset_then_grows() {
    for onset in [0.04, 0.1, 0.233, 0.25, 0.41, 0.5, 0.77] {
        let run = run(&[0.5, 1.0], onset, 1.0);
        let landing = run.kept.iter().copied().find(|&load| load > onset).unwrap();
        let ratio = landing / onset;
        let at_key = landing == 0.5 && ratio < 1.1;
        assert!((1.05..=1.1).contains(&ratio) || at_key, "{onset}: {ratio}");
        assert!(run.trials <= 20, "{} trials", run.trials);
        for pair in run.kept.windows(2).filter(|pair| pair[0] > onset) {
            assert!(pair[1] / pair[0] <= 1.5 + 1e-12);
        }
        assert!(run.kept.contains(&0.5));
        assert_eq!(run.kept.last(), Some(&1.0));
    }
}

#[test]
fn key_loads_are_hit_exactly_without_buckling() {
    let keys = [0.1, 1.0 / 3.0, 0.7, 1.0];
    let run = run(&keys, 2.0, 1.0);
    assert_eq!(run.kept[1..], keys);
    assert_eq!(run.trials, keys.len());
}

#[test]
fn onset_just_below_a_key_buckles_at_the_key() {
    let run = run(&[1.0], 0.99, 1.0);
    assert_eq!(run.kept.last(), Some(&1.0));
    assert!(!run.kept.iter().any(|&load| load > 0.99 && load < 1.0));
}

#[test]
fn failures_shorten_the_steps() {
    let run = run(&[1.0], 0.3, 0.1);
    assert!(!run.gave_up);
    assert_eq!(run.kept.last(), Some(&1.0));
    assert!(run.kept.windows(2).all(|pair| pair[1] - pair[0] <= 0.1));
}

#[test]
fn a_load_that_never_converges_is_given_up() {
    let mut loads = LoadStepper::new(&[1.0], LoadSettings::default()).unwrap();
    let mut last = Verdict::Keep;
    let mut trials = 0;
    while loads.next_trial().is_some() {
        last = loads.report(Outcome::Failed);
        trials += 1;
        assert!(trials < 100);
    }
    assert_eq!(last, Verdict::GiveUp);
    assert_eq!(loads.kept_load(), 0.0);
}
