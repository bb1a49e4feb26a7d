//! Layers that are solved in overlapping patches, against the same as a whole.

mod patch;

use patch::{draft, driver, pose, skin};
use ruga_stepper::{Coupling, Modelling, Observer, PoseResult, Progress, plan};

/// Ends the work after so many reports of progress, and counts them.
struct Patience(usize);

impl Observer for Patience {
    fn progress(&mut self, _: Progress) -> bool {
        self.0 -= 1;
        self.0 > 0
    }

    fn wants_frames(&self) -> bool {
        false
    }
}

/// The patch of skin at half of its pose and all of it, as a whole up to so many vertices.
fn run(coupling: Coupling, whole_vertices: usize, patience: &mut Patience) -> PoseResult {
    let driver = driver();
    let layers = [skin("forehead-furrow", coupling)];
    let poses = [pose(&driver, "press", 1.0)];
    let modelling = Modelling {
        points_per_wavelength: 10.0,
        whole_vertices,
        ..draft()
    };
    let plan = plan(&driver, &layers, &poses, &modelling, 1024).expect("a valid scene");
    plan.simulate(0, patience).expect("a valid scene")
}

/// With threads of its own.
fn run_on(threads: usize) -> PoseResult {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("threads");
    pool.install(|| run(Coupling::Hybrid, 400, &mut Patience(usize::MAX)))
}

#[test]
fn patches_find_what_the_whole_finds() {
    for coupling in [Coupling::Hybrid, Coupling::Elastic] {
        let [whole, patched] =
            [usize::MAX, 400].map(|most| run(coupling, most, &mut Patience(usize::MAX)));
        assert!(
            whole.converged && patched.converged,
            "{:?}",
            patched.warnings
        );
        let [one, other] = [&whole, &patched].map(|result| &result.layers[0]);
        // Fewer vertices would have left it whole, and the test without a sense.
        assert!(other.vertices > 800, "{} vertices", other.vertices);
        assert_eq!(one.vertices, other.vertices);
        let difference = |a: f64, b: f64| (a / b - 1.0).abs();
        assert!(difference(one.energy, other.energy) < 1e-3);
        assert!(difference(one.amplitude, other.amplitude) < 0.01);
        let surfaces = [&whole, &patched].map(|result| &result.keys[1].layers[0]);
        let pairs = surfaces[0].positions.iter().zip(&surfaces[1].positions);
        let square: f64 = pairs.map(|(a, b)| (a - b).norm_squared()).sum();
        let distance = (square / surfaces[0].positions.len() as f64).sqrt();
        // The same waves at the same places, though found in another way.
        assert!(
            distance > 0.0 && distance < 0.1 * one.amplitude,
            "{coupling:?}: {distance:e} of {:e} m",
            one.amplitude
        );
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let results = [1, 2, 3].map(run_on);
    for result in &results[1..] {
        for (key, first) in result.keys.iter().zip(&results[0].keys) {
            assert_eq!(key.layers[0].positions, first.layers[0].positions);
        }
    }
}

#[test]
fn sweeps_can_be_interrupted() {
    let mut all = Patience(usize::MAX);
    run(Coupling::Hybrid, 400, &mut all);
    let reports = usize::MAX - all.0;
    // In the sweeps of the last key, which are most of its work.
    let result = run(Coupling::Hybrid, 400, &mut Patience(reports - 3));
    assert!(result.interrupted && !result.converged);
    assert_eq!(result.keys.len(), 1);
}
