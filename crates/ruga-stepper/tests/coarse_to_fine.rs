//! Results on fine meshes, whose pattern was found on a coarse one.

mod patch;

use patch::{draft, driver, pose, skin};
use ruga_stepper::{Coupling, Modelling, Observer, PoseResult, Progress, plan};

/// Notes the meshes that are solved on, and may stop the work or ask for frames.
struct Watch {
    meshes: Vec<usize>,
    /// Iterations after which the work ends.
    patience: usize,
    wants_frames: bool,
}

impl Watch {
    fn new(patience: usize, wants_frames: bool) -> Self {
        Self {
            meshes: Vec::new(),
            patience,
            wants_frames,
        }
    }

    /// The patch with as few points as are found on a coarse mesh first, at its last key alone.
    fn run(&mut self) -> PoseResult {
        let driver = driver();
        let layers = [skin("forehead-furrow", Coupling::Hybrid)];
        let mut pose = pose(&driver, "press", 1.0);
        (pose.keys, pose.steps) = (vec![1.0], 1);
        let modelling = Modelling {
            points_per_wavelength: 20.0,
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
        self.patience = self.patience.saturating_sub(1);
        self.patience > 0
    }

    fn wants_frames(&self) -> bool {
        self.wants_frames
    }
}

#[test]
fn a_pattern_of_a_coarse_mesh_is_the_one_that_load_steps_find() {
    let (mut direct, mut steps) = (Watch::new(usize::MAX, false), Watch::new(usize::MAX, true));
    let results = [direct.run(), steps.run()];
    let [coarse, fine] = direct.meshes[..] else {
        panic!("two meshes: {:?}", direct.meshes);
    };
    assert!(2 * coarse < fine, "{coarse} and {fine} vertices");
    assert_eq!(steps.meshes, [fine]);
    let layers = results.each_ref().map(|result| &result.layers[0]);
    assert!(results.iter().all(|result| result.converged));
    assert_eq!(layers[0].vertices, fine);
    let ratio = |value: [f64; 2]| value[0] / value[1] - 1.0;
    let energy = ratio(layers.map(|layer| layer.energy));
    let amplitude = ratio(layers.map(|layer| layer.amplitude));
    let wavelength = ratio(layers.map(|layer| layer.wavelength.expect("wrinkles")));
    let found = format!("energy {energy:.4}, amplitude {amplitude:.4}, wavelength {wavelength:.4}");
    assert!(energy.abs() < 3e-3, "{found}");
    assert!(amplitude.abs() < 0.03 && wavelength.abs() < 0.03, "{found}");
}

#[test]
fn a_search_on_a_coarse_mesh_can_be_interrupted() {
    let mut watch = Watch::new(3, false);
    let result = watch.run();
    assert_eq!(watch.meshes.len(), 1);
    assert!(result.interrupted && !result.converged);
    assert!(result.keys.is_empty());
}
