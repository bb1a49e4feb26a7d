//! T19: soft bodies in small steps and in large ones. Not on the project's list of failures, which
//! knows given surfaces alone.

use nalgebra::Vector3;
use ruga_constraint::constraint_rows;
use ruga_solver::{Minimise, minimise};
use ruga_stepper::{CellShape, Coupling};
use ruga_validation::baselines::{by_minres, by_residual, by_residual_and_minres};
use ruga_validation::body::{Cushion, Slab, SlabRun, Thrown, push};
use ruga_validation::{Finding, table_line};

/// Thrown for 0.15 s: it falls, lands, and the ball comes down on it.
fn thrown(minimise: Minimise, time_step: f64) -> Thrown {
    let cushion = Cushion {
        scale: 1.0,
        thickness: 1.2e-3,
        ratio: 1000.0,
        cells: 3,
        points: 4.0,
        // A fitted mesh would be another one for every method and step: its first run is theirs.
        is_fitted: false,
        coupling: Coupling::Hybrid,
        time_step,
        steps: (0.15 / time_step).round() as u32,
        minimise,
    };
    let thrown = cushion.throw().expect("a body that can be simulated");
    assert!(thrown.outside < 0.02, "{}", thrown.outside);
    let [low, high] = thrown.heights;
    assert!(low > 0.85 && high < 1.01, "{low} {high}");
    thrown
}

/// Where nothing stands still, inertia leaves no saddle to end on: the papers' methods find the same
/// motion, by the residual in twice as many Newton steps, or give up and say so.
#[test]
fn t19_thrown() {
    let test = "T19 cushion dropped and pressed, dt .005 to .05 s";
    let time_steps = [0.005, 0.02, 0.05];
    let ours = time_steps.map(|step| thrown(minimise, step));
    let iterations =
        |runs: &[&Thrown]| -> usize { runs.iter().map(|run| run.report.newton_iterations).sum() };
    let same = |ours: &Thrown, theirs: &Thrown| {
        let warnings = [&ours.warnings, &theirs.warnings];
        assert!(ours.converged && theirs.converged, "{warnings:?}");
        for run in [ours, theirs] {
            let mut warnings = run.warnings.iter();
            // No step had to be divided.
            let is_told = |w: &String| w.contains("unstable one") || w.contains("halved");
            assert!(!warnings.any(is_told), "{:?}", run.warnings);
        }
        let energy = theirs.report.energy / ours.report.energy - 1.0;
        assert!(energy.abs() < 1e-3, "{energy}");
    };
    let residual = time_steps.map(|step| thrown(by_residual, step));
    for (ours, theirs) in ours.iter().zip(&residual) {
        same(ours, theirs);
    }
    let count = iterations(&ours.each_ref());
    let times = iterations(&residual.each_ref()) as f64 / count as f64;
    assert!(times > 1.8, "{times}");
    let numbers = format!("the same motion in {times:.1} times as many Newton steps");
    table_line(test, "papers: residual merit", Finding::Holds, &numbers);

    let methods: [(Minimise, _, _); 2] = [
        (by_minres, "papers: MINRES", 0.5),
        (by_residual_and_minres, "papers: both", 1.8),
    ];
    for (minimise, method, least) in methods {
        let iterated = thrown(minimise, time_steps[2]);
        if !iterated.converged {
            let is_said = |w: &String| w.contains("no step in time found");
            assert!(iterated.warnings.iter().any(is_said));
            let numbers = "dt .05 alone: gives up on a step however short, and says so";
            table_line(test, method, Finding::Warns, numbers);
            continue;
        }
        same(&ours[2], &iterated);
        let times = iterations(&[&iterated]) as f64 / iterations(&[&ours[2]]) as f64;
        assert!(times > least, "{times}");
        let numbers =
            format!("dt .05 alone: the same motion in {times:.1} times as many Newton steps");
        table_line(test, method, Finding::Holds, &numbers);
    }
    let frames: usize = ours.iter().map(|run| run.frames).sum();
    let numbers = format!(
        "in the room, {:.1} Newton steps a frame",
        count as f64 / frames as f64
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}

/// A slab pushed together to about two critical strains, and its amplitude in skin thicknesses.
///
/// # Errors
/// What the simulator says when it gives up.
fn pushed(minimise: Minimise, steps: u32) -> Result<(SlabRun, f64), String> {
    let mut slab = Slab {
        size: Vector3::repeat(1.0),
        cells: 5,
        shape: CellShape::Quadratic,
        young: 5e4,
        ratio: 100.0,
        thickness: 5e-4,
        coupling: Coupling::Hybrid,
        sample: constraint_rows,
        points: 4.0,
        is_fitted: false,
        slices: Vec::new(),
    };
    let theory = slab.theory().expect("possible materials");
    let cell = 1.25 * theory.wavelength;
    slab.size = Vector3::new(5.0, 1.0, 1.0) * cell;
    slab.slices = vec![
        ("left", [-1.0, cell]),
        ("right", [slab.size.x - cell, 2.0 * slab.size.x]),
    ];
    // Of three cells between the handles, which hold a part of them too.
    let displacement = 0.5 * 2.0 * 3.0 * theory.critical_strain * cell;
    let motions = vec![push("left", displacement), push("right", -displacement)];
    let run = slab.simulate_by(minimise, motions, (&[1.0], steps));
    let run = run.map_err(|error| error.to_string())?;
    assert!(run.converged, "{:?}", run.warnings);
    let amplitude = run.report.amplitude / slab.thickness;
    Ok((run, amplitude))
}

/// At rest the papers' search ends at other, unstable states, however small the steps, by either
/// linear solver, or gives up; by the energy MINRES may stay on a saddle, for it cannot tell.
#[test]
fn t19_pushed() {
    let test = "T19 slab pushed past the onset in 1 step and in 8";
    let says = |run: &SlabRun, what: &str| run.warnings.iter().any(|w| w.contains(what));
    let arrived = |minimise: Minimise| [1, 8].map(|steps| pushed(minimise, steps));
    let iterations =
        |runs: &[(SlabRun, f64); 2]| runs.each_ref().map(|(run, _)| run.report.newton_iterations);

    let ours = arrived(minimise).map(|run| run.expect("an equilibrium"));
    let [jump, slow] = ours.each_ref().map(|(_, amplitude)| *amplitude);
    // A result may be off by the root of its Newton decrement: 3e-5 of the energy, .3 % in amplitude.
    assert!((jump / slow - 1.0).abs() < 6e-3, "{jump} {slow}");
    assert!(ours.iter().all(|(run, _)| run.warnings.is_empty()));

    let methods: [(Minimise, _, _); 2] = [
        (by_residual, "papers: residual merit", "unstable one"),
        (by_residual_and_minres, "papers: both", "cannot tell"),
    ];
    for (minimise, name, warning) in methods {
        let off = arrived(minimise).map(|run| {
            let (run, amplitude) = match run {
                Ok(run) => run,
                Err(said) => {
                    assert!(said.contains("no equilibrium found"), "{said}");
                    return "gives up".to_owned();
                }
            };
            assert!(says(&run, warning), "{:?}", run.warnings);
            let off = amplitude / slow - 1.0;
            assert!((0.02..0.5).contains(&off.abs()), "{off}");
            format!("{:+.0} %", 100.0 * off)
        });
        let numbers = format!("A off by {off:?}; says `{warning}`");
        table_line(test, name, Finding::Warns, &numbers);
    }

    let iterated = arrived(by_minres).map(|run| run.expect("an equilibrium"));
    let off = iterated.each_ref().map(|(run, amplitude)| {
        assert!(says(run, "cannot tell"), "{:?}", run.warnings);
        format!("{:+.0} %", 100.0 * (amplitude / slow - 1.0))
    });
    let numbers = format!(
        "A off by {off:?} after {:?} Newton steps; cannot tell, which it says",
        iterations(&iterated)
    );
    table_line(test, "papers: MINRES", Finding::Warns, &numbers);
    let numbers = format!(
        "the same minimum after {:?} Newton steps",
        iterations(&ours)
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}
