//! One pose from rest to full weight.

mod patch;

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use patch::{draft, driver, pose, skin};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_material::{PropertyImage, PropertyMap, Wrap};
use ruga_solver::{SolveReport, minimise};
use ruga_stepper::{
    Coupling, Frame, LayerSpec, Modelling, Observer, Phase, PoseResult, Preparation, Progress,
    Silent, StepperError, plan,
};

fn run(coupling: Coupling, modelling: &Modelling, observer: &mut dyn Observer) -> PoseResult {
    run_layer(skin("forehead-furrow", coupling), modelling, observer)
}

fn run_layer(layer: LayerSpec, modelling: &Modelling, observer: &mut dyn Observer) -> PoseResult {
    let driver = driver();
    let poses = [pose(&driver, "press", 1.0)];
    let plan = plan(&driver, &[layer], &poses, modelling, 1024).expect("a valid scene");
    plan.simulate(0, observer).expect("a valid scene")
}

#[test]
fn every_coupling_wrinkles_near_the_predicted_wavelength() {
    for (coupling, tolerance) in [
        (Coupling::Hybrid, 0.1),
        (Coupling::Elastic, 0.1),
        // Rows alone set the wavelength by their irregular spacing.
        (Coupling::Constraint, 0.4),
    ] {
        let result = run(coupling, &draft(), &mut Silent);
        let layer = &result.layers[0];
        assert!(result.converged, "{coupling:?}");
        assert_eq!(result.keys.len(), 2);
        // Six points to a wave bend too easily; the layer makes up for it.
        let modulus = layer.bending_ratio.unwrap();
        assert!(modulus > 0.85 && modulus < 0.99, "{modulus}");
        let ratio = layer.wavelength.unwrap() / layer.wavelength_predicted;
        assert!((ratio - 1.0).abs() < tolerance, "{coupling:?}: {ratio}");
        assert!(layer.amplitude > 0.2e-3 && layer.amplitude < 1.2e-3);
        let rows = layer.constraints;
        assert_eq!(rows == 0, coupling == Coupling::Elastic, "{rows} rows");
    }
}

/// The patch is pressed in x.
#[test]
fn output_edges_are_short_across_the_waves_and_longer_along_them() {
    let modelling = Modelling {
        points_per_wavelength: 12.0,
        ..draft()
    };
    let result = run(Coupling::Hybrid, &modelling, &mut Silent);
    let asked = result.layers[0].wavelength_predicted / 12.0;
    let [before, surface] = [0, 1].map(|key| &result.keys[key].layers[0]);
    // The mesh is made anew for the second key, and kept once.
    assert!(Arc::ptr_eq(&before.faces, &surface.faces));
    assert!(Arc::ptr_eq(&before.uvs, &surface.uvs) && Arc::ptr_eq(&before.artist, &surface.artist));
    let (mut across, mut along) = (Vec::new(), Vec::new());
    for corners in surface.uvs.iter() {
        let [a, b, c] = corners.map(|uv| patch::SIDE * uv);
        let middle = (a + b + c) / (3.0 * patch::SIDE);
        if (middle.x - 0.5).abs() < 0.2 {
            for edge in [b - a, c - b, a - c] {
                across.push(edge.x.abs());
                along.push(edge.y.abs());
            }
        }
    }
    let longest = across.iter().copied().fold(0.0, f64::max);
    assert!(longest < 1.3 * asked, "{longest} m for {asked} m");
    let [across, along] = [across, along].map(|all| all.iter().sum::<f64>() / all.len() as f64);
    assert!(along > 1.3 * across, "{along} m along, {across} m across");
}

#[test]
fn below_the_onset_the_layer_lies_on_the_driver() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let modelling = Modelling {
        region: ruga_stepper::Region::All,
        ..draft()
    };
    let poses = [pose(&driver, "press", 0.3)];
    let plan = plan(&driver, &layers, &poses, &modelling, 1024).unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    let surface = &result.keys[1].layers[0];
    for (x, p) in surface.positions.iter().zip(&surface.driver_positions) {
        assert!((x - p).norm() < 1e-6, "{}", (x - p).norm());
    }
    assert_eq!(result.layers[0].wavelength, None);
}

#[test]
fn nothing_to_wrinkle_gives_keys_without_layers() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let poses = [pose(&driver, "press", 0.1)];
    let plan = plan(&driver, &layers, &poses, &draft(), 1024).unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    assert!(result.converged && result.keys.iter().all(|k| k.layers.is_empty()));
}

#[test]
fn two_runs_give_the_same_bits() {
    let [a, b] = [0, 1].map(|_| run(Coupling::Hybrid, &draft(), &mut Silent));
    assert_eq!(a.keys[1].layers[0].positions, b.keys[1].layers[0].positions);
}

/// Properties painted with 1 give the same bits as no paint, though the material is then kept at every place.
#[test]
fn paint_of_ones_is_as_good_as_none() {
    let ones = PropertyImage {
        width: 1,
        height: 1,
        values: vec![1.0],
        range: [0.5, 1.0],
    };
    let paint = PropertyMap::new(
        Some(ones.clone()),
        Some(ones.clone()),
        Some(ones),
        Wrap::ClampToEdge,
    )
    .expect("a map");
    let plain = skin("forehead-furrow", Coupling::Hybrid);
    let painted = LayerSpec {
        map: Some(Arc::new(paint)),
        ..plain.clone()
    };
    let [plain, painted] = [plain, painted].map(|layer| {
        let result = run_layer(layer, &draft(), &mut Silent);
        result.keys[1].layers[0].positions.clone()
    });
    assert_eq!(plain, painted);
}

struct StopAt(usize);

impl Observer for StopAt {
    fn progress(&mut self, _: Progress) -> bool {
        true
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        assert!(frame.load > 0.0 && frame.layers.len() == 1);
        assert_eq!(frame.layers[0].face_states, None);
        self.0 += 1;
    }
}

/// Takes the largest strain ratio of every frame, and the energy of the last.
#[derive(Default)]
struct States {
    strain_ratios: Vec<f64>,
    energy: f64,
}

impl Observer for States {
    fn wants_face_states(&self) -> bool {
        true
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        let layer = &frame.layers[0];
        let states = layer.face_states.as_ref().expect("they are wanted");
        assert_eq!(states.len(), layer.faces.len());
        let ratios = states.iter().map(|state| state.strain_ratio);
        self.strain_ratios.push(ratios.fold(0.0, f64::max));
        let energies = states
            .iter()
            .zip(layer.uvs.iter())
            .map(|(state, [a, b, c])| {
                let area = 0.5 * (b - a).perp(&(c - a)).abs() * patch::SIDE * patch::SIDE;
                area * (state.membrane_energy + state.bending_energy + state.foundation_energy)
            });
        self.energy = energies.sum();
    }
}

#[test]
fn states_of_faces_grow_with_the_load_and_add_up_to_the_energy() {
    let mut states = States::default();
    let result = run(Coupling::Hybrid, &draft(), &mut states);
    assert!(
        states.strain_ratios.is_sorted(),
        "{:?}",
        states.strain_ratios
    );
    let last = states.strain_ratios.last().expect("some frames");
    assert!((1.0..10.0).contains(last), "{last}");
    // Means over corners are no sums: the output mesh has smaller triangles.
    let share = states.energy / result.layers[0].energy;
    assert!((share - 1.0).abs() < 0.1, "{share}");
}

struct StopAtOnce;

impl Observer for StopAtOnce {
    fn progress(&mut self, _: Progress) -> bool {
        false
    }
}

#[test]
fn the_observer_sees_frames_and_can_stop() {
    let mut counter = StopAt(0);
    let result = run(Coupling::Hybrid, &draft(), &mut counter);
    assert_eq!(counter.0, result.frames);
    let result = run(Coupling::Hybrid, &draft(), &mut StopAtOnce);
    assert!(result.interrupted && !result.converged && result.keys.is_empty());
}

/// Counts steps of the preparation and ends it with one of them.
struct StopInPreparation {
    steps: usize,
    last: usize,
    phases: Vec<Phase>,
}

impl Observer for StopInPreparation {
    fn preparing(&mut self, preparation: Preparation) -> bool {
        self.steps += 1;
        // A load step is prepared like the layer, and its steps are counted anew.
        let begins_anew = preparation.step == 1 && preparation.phase == Phase::Sampling;
        assert!(preparation.layer == 0 && (begins_anew || preparation.step == self.steps));
        if self.phases.last() != Some(&preparation.phase) {
            self.phases.push(preparation.phase);
        }
        self.steps < self.last
    }

    fn progress(&mut self, _: Progress) -> bool {
        false
    }
}

#[test]
fn a_run_can_be_ended_at_every_step_of_its_preparation() {
    let mut whole = StopInPreparation {
        steps: 0,
        last: usize::MAX,
        phases: Vec::new(),
    };
    run(Coupling::Hybrid, &draft(), &mut whole);
    let (sampling, remeshing) = (Phase::Sampling, Phase::Remeshing);
    assert_eq!(
        whole.phases,
        [sampling, remeshing, Phase::Constraints, sampling]
    );
    assert!(whole.steps >= 12, "{}", whole.steps);
    for last in 1..=whole.steps {
        let mut hasty = StopInPreparation {
            steps: 0,
            last,
            phases: Vec::new(),
        };
        let result = run(Coupling::Hybrid, &draft(), &mut hasty);
        assert_eq!(hasty.steps, last);
        assert!(result.interrupted && !result.converged && result.keys.is_empty());
        assert_eq!(result.layers[0].name, "skin");
    }
}

#[test]
fn states_of_a_method_that_knows_no_inertia_are_warned_of() {
    let modelling = Modelling {
        minimise: |objective, rhs, x, kkt, settings, keep_going| {
            let report = minimise(objective, rhs, x, kkt, settings, keep_going)?;
            Ok(SolveReport {
                inertia: None,
                ..report
            })
        },
        ..draft()
    };
    let result = run(Coupling::Hybrid, &modelling, &mut Silent);
    assert!(
        result.warnings.iter().any(|w| w.contains("cannot tell")),
        "{:?}",
        result.warnings
    );
}

/// Two triangles have no vertex inside.
#[test]
fn a_mesh_that_is_all_border_is_refused() {
    let square = [[0.0, 0.0], [0.02, 0.0], [0.02, 0.02], [0.0, 0.02]];
    let driver = Driver::new(&ArtistMesh {
        positions: square.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
        uvs: Some(
            square
                .map(|[x, y]| Vector2::new(50.0 * x, 50.0 * y))
                .to_vec(),
        ),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        shapes: vec![BlendShape {
            name: "press".into(),
            position_deltas: square
                .map(|[x, _]| Vector3::new(-0.1 * x, 0.0, 0.0))
                .to_vec(),
            normal_deltas: None,
        }],
        ..ArtistMesh::default()
    })
    .unwrap();
    let driver = Arc::new(driver);
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let modelling = Modelling {
        vertex_budget: 1,
        remesh: None,
        ..draft()
    };
    let spec = pose(&driver, "press", 1.0);
    let plan = plan(
        &driver,
        &layers,
        std::slice::from_ref(&spec),
        &modelling,
        1024,
    )
    .unwrap();
    let refused = plan.simulate(0, &mut Silent);
    assert!(
        matches!(refused, Err(StepperError::NoRoom { .. })),
        "{refused:?}"
    );
}
