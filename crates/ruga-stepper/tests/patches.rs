//! Layers that are solved in overlapping patches, against the same as a whole.

mod patch;

use patch::{draft, driver, pose, skin};
use ruga_stepper::{Coupling, Modelling, Observer, PoseResult, Progress, plan};

/// Ends the work after so many reports of progress, and counts them.
struct Patience(usize);

impl Observer for Patience {
    fn progress(&mut self, _: Progress) -> bool {
        assert!(self.0 > 0, "asked again after the end was asked for");
        self.0 -= 1;
        self.0 > 0
    }

    fn wants_frames(&self) -> bool {
        false
    }
}

/// The patch of skin at half of its pose and all of it, with so many points per wavelength, and as a whole
/// up to so many vertices at 12 points.
fn run(
    (coupling, points): (Coupling, f64),
    whole_vertices: usize,
    patience: &mut Patience,
) -> PoseResult {
    let driver = driver();
    let layers = [skin("forehead-furrow", coupling)];
    let poses = [pose(&driver, "press", 1.0)];
    let modelling = Modelling {
        points_per_wavelength: points,
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
    pool.install(|| run((Coupling::Hybrid, 10.0), 400, &mut Patience(usize::MAX)))
}

/// The patch of skin as a whole, and in patches where it has more than `most` vertices.
fn compared((coupling, points): (Coupling, f64), most: usize) -> [PoseResult; 2] {
    let results =
        [usize::MAX, most].map(|most| run((coupling, points), most, &mut Patience(usize::MAX)));
    for result in &results {
        assert!(result.converged, "{coupling:?}: {:?}", result.warnings);
        // With fewer it would be left whole, and the test would have no sense.
        let layer = &result.layers[0];
        assert!(layer.vertices > 9 * most / 8, "{} vertices", layer.vertices);
    }
    // In patches the last digits differ; with more points than 12 the limit is higher than `most`.
    let [whole, patched] = results.each_ref().map(|result| result.layers[0].energy);
    assert!(whole != patched, "{coupling:?}: not in patches");
    results
}

/// Differences of energy, wavelength and amplitude, as shares.
fn differences(results: &[PoseResult; 2]) -> [f64; 3] {
    let [one, other] = results.each_ref().map(|result| &result.layers[0]);
    let waves = [one, other].map(|layer| layer.wavelength.expect("wrinkles"));
    [
        other.energy / one.energy - 1.0,
        waves[1] / waves[0] - 1.0,
        other.amplitude / one.amplitude - 1.0,
    ]
}

#[test]
fn patches_keep_the_pattern_of_the_whole() {
    // So many points that a mesh of 12, which is left whole, finds the pattern and takes it far.
    for coupling in [Coupling::Hybrid, Coupling::Elastic] {
        let results = compared((coupling, 21.0), 650);
        let [energy, wavelength, amplitude] = differences(&results).map(f64::abs);
        assert!(energy < 3e-4, "{coupling:?}: {energy}");
        assert!(wavelength < 2e-3, "{coupling:?}: {wavelength}");
        assert!(amplitude < 3e-3, "{coupling:?}: {amplitude}");
        let surfaces = results.each_ref().map(|result| &result.keys[1].layers[0]);
        let pairs = surfaces[0].positions.iter().zip(&surfaces[1].positions);
        let square: f64 = pairs.map(|(a, b)| (a - b).norm_squared()).sum();
        let distance = (square / surfaces[0].positions.len() as f64).sqrt();
        // The same waves, which have slid by a thirtieth of their length at most.
        let most = 0.3 * results[0].layers[0].amplitude;
        assert!(
            distance > 0.0 && distance < most,
            "{coupling:?}: {distance:e} of {most:e} m"
        );
    }
}

#[test]
fn patches_end_as_low_as_the_whole() {
    // Patches of one wavelength, a quarter of what they are at the quality `standard`. Averages that they
    // share stiffen small ones.
    for (coupling, most) in [(Coupling::Hybrid, 6e-3), (Coupling::Elastic, 5e-4)] {
        let results = compared((coupling, 14.0), 950);
        let [energy, wavelength, amplitude] = differences(&results).map(f64::abs);
        assert!(energy < most, "{coupling:?}: {energy}");
        assert!(wavelength < 0.02, "{coupling:?}: {wavelength}");
        assert!(amplitude < 0.03, "{coupling:?}: {amplitude}");
    }
}

#[test]
fn wide_patches_find_a_first_pattern_of_the_same_waves() {
    // More than six times as many vertices as may be solved as a whole; wide patches of two wavelengths, and
    // narrow ones of less than one.
    let results = compared((Coupling::Elastic, 14.0), 180);
    assert!(results[1].layers[0].vertices > 6 * 180 * 196 / 144);
    let [energy, wavelength, amplitude] = differences(&results).map(f64::abs);
    assert!(energy < 0.005, "{energy}");
    assert!(wavelength < 0.02, "{wavelength}");
    assert!(amplitude < 0.03, "{amplitude}");
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
    run((Coupling::Hybrid, 10.0), 400, &mut all);
    let reports = usize::MAX - all.0;
    // In the sweeps of the last key, which are most of its work, also while other patches are under way.
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let result = pool
            .expect("threads")
            .install(|| run((Coupling::Hybrid, 10.0), 400, &mut Patience(reports - 3)));
        assert!(result.interrupted && !result.converged);
        assert_eq!(result.keys.len(), 1);
    }
}
