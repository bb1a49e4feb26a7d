//! Results on fine meshes, whose pattern was found on a coarse one.

mod patch;

use patch::{draft, driver, pose, skin};
use ruga_stepper::{Coupling, Modelling, Observer, PoseResult, Progress, plan};

/// Notes the meshes that are solved on, and may stop the work.
struct Watch {
    meshes: Vec<usize>,
    /// Iterations after which the work ends.
    patience: usize,
}

impl Watch {
    fn new(patience: usize) -> Self {
        Self {
            meshes: Vec::new(),
            patience,
        }
    }

    /// The patch at its last key.
    fn run(&mut self, points_per_wavelength: f64) -> PoseResult {
        let driver = driver();
        let layers = [skin("forehead-furrow", Coupling::Hybrid)];
        let mut pose = pose(&driver, "press", 1.0);
        pose.keys = vec![1.0];
        let modelling = Modelling {
            points_per_wavelength,
            ..draft()
        };
        let plan = plan(&driver, &layers, &[pose], &modelling, 1024).expect("a valid scene");
        plan.simulate(0, self).expect("a valid scene")
    }
}

impl Observer for Watch {
    fn progress(&mut self, progress: Progress) -> bool {
        if self.meshes.last() != Some(&progress.vertices) {
            self.meshes.push(progress.vertices);
        }
        self.patience -= 1;
        self.patience > 0
    }

    fn wants_frames(&self) -> bool {
        false
    }
}

#[test]
fn twenty_points_have_the_pattern_of_twelve() {
    let (mut of_fine, mut of_coarse) = (Watch::new(usize::MAX), Watch::new(usize::MAX));
    let results = [of_fine.run(20.0), of_coarse.run(12.0)];
    let [coarse, fine] = of_fine.meshes[..] else {
        panic!("two meshes: {:?}", of_fine.meshes);
    };
    assert!(2 * coarse < fine, "{coarse} and {fine} vertices");
    assert_eq!(of_coarse.meshes.len(), 1);
    assert!(results.iter().all(|result| result.converged));
    let layers = results.each_ref().map(|result| &result.layers[0]);
    assert_eq!(layers[0].vertices, fine);
    let difference = |values: [f64; 2]| (values[0] / values[1] - 1.0).abs();
    let energy = difference(layers.map(|layer| layer.energy));
    let amplitude = difference(layers.map(|layer| layer.amplitude));
    let wavelength = difference(layers.map(|layer| layer.wavelength.expect("wrinkles")));
    let found = format!("energy {energy:.4}, amplitude {amplitude:.4}, wavelength {wavelength:.4}");
    assert!(
        energy < 0.01 && amplitude < 0.03 && wavelength < 0.03,
        "{found}"
    );
}

#[test]
fn a_search_on_a_coarse_mesh_can_be_interrupted() {
    let mut watch = Watch::new(3);
    let result = watch.run(20.0);
    assert_eq!(watch.meshes.len(), 1);
    assert!(result.interrupted && !result.converged);
    assert!(result.keys.is_empty());
}
