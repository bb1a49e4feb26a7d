//! Values that nothing can be planned or simulated with are refused at once, by name.

mod patch;

use std::time::{Duration, Instant};

use nalgebra::{Vector2, Vector3};
use patch::{draft, driver, pose, skin};
use ruga_blend::{ArtistMesh, Driver};
use ruga_stepper::{
    Coupling, Dynamics, EdgeLimits, LayerSpec, Mask, Modelling, Plan, PoseResult, PoseSpec, Silent,
    Stack, StepperError, plan, simulate,
};

/// A refusal is a look at numbers and takes microseconds; the work that some of these values asked
/// for took half a minute.
const AT_ONCE: Duration = Duration::from_secs(10);

fn press(driver: &Driver) -> PoseSpec {
    pose(driver, "press", 1.0)
}

fn layer() -> LayerSpec {
    skin("forehead-furrow", Coupling::Hybrid)
}

fn planned(driver: &Driver, spec: &PoseSpec, modelling: &Modelling) -> Result<Plan, StepperError> {
    let poses = std::slice::from_ref(spec);
    plan(driver, &[layer()], poses, modelling, 1024)
}

/// Asserts that `result` is an error about `field` that says what was found and what is accepted.
fn assert_refused<T>(result: Result<T, StepperError>, field: &str, found: &str) {
    let Err(error) = result else {
        panic!("{field} = {found} was accepted");
    };
    let text = error.to_string();
    assert!(matches!(error, StepperError::Setting { .. }), "{text}");
    for word in [&format!("`{field}` is {found}"), "accepted: "] {
        assert!(text.contains(word), "{text}");
    }
}

/// Asserts that a pose is refused both by the planner and by the simulation, the latter with a plan
/// that was made for the pose as it should be.
fn assert_pose_refused(spec: &PoseSpec, field: &str, found: &str) {
    let driver = driver();
    let since = Instant::now();
    assert_refused(planned(&driver, spec, &draft()), field, found);
    assert!(since.elapsed() < AT_ONCE, "{field}: {:?}", since.elapsed());
    let good = press(&driver);
    let plan = planned(&driver, &good, &draft()).expect("a valid scene");
    let run = simulate(&driver, &plan, 0, spec, &draft(), &mut Silent);
    assert_refused(run, field, found);
}

#[test]
fn poses_without_meaning_are_refused() {
    let good = press(&driver());
    let keys = |keys: &[f64]| PoseSpec {
        keys: keys.to_vec(),
        ..good.clone()
    };
    assert_pose_refused(&keys(&[]), "keys", "an empty list");
    assert_pose_refused(&keys(&[0.5, f64::NAN]), "keys[1]", "NaN");
    assert_pose_refused(&keys(&[0.0, 1.0]), "keys[0]", "0");
    assert_pose_refused(&keys(&[0.5, 1.5]), "keys[1]", "1.5");
    assert_pose_refused(&keys(&[1.0, 0.5]), "keys[1]", "0.5");
    assert_pose_refused(&keys(&[0.5, 0.5]), "keys[1]", "0.5");
    let steps = |steps: u32| PoseSpec {
        steps,
        ..good.clone()
    };
    assert_pose_refused(&steps(0), "steps", "0");
    assert_pose_refused(&steps(u32::MAX), "steps", "4294967295");
    // The driver itself refuses weights that are no numbers.
    let huge = PoseSpec {
        weights: good.weights.scaled(1e200),
        ..good.clone()
    };
    assert_pose_refused(&huge, "weights[0]", "1");
}

/// Asserts that a modelling is refused both by the planner and by the simulation, at once.
fn assert_modelling_refused(modelling: &Modelling, field: &str, found: &str) {
    let driver = driver();
    let spec = press(&driver);
    let since = Instant::now();
    assert_refused(planned(&driver, &spec, modelling), field, found);
    assert!(since.elapsed() < AT_ONCE, "{field}: {:?}", since.elapsed());
    let plan = planned(&driver, &spec, &draft()).expect("a valid scene");
    let since = Instant::now();
    let run = simulate(&driver, &plan, 0, &spec, modelling, &mut Silent);
    assert_refused(run, field, found);
    assert!(since.elapsed() < AT_ONCE, "{field}: {:?}", since.elapsed());
}

#[test]
fn modelling_without_meaning_is_refused_at_once() {
    for (points, found) in [(-6.0, "-6"), (1e9, "1000000000"), (f64::NAN, "NaN")] {
        let modelling = Modelling {
            points_per_wavelength: points,
            ..draft()
        };
        assert_modelling_refused(&modelling, "points_per_wavelength", found);
    }
    let edges = |min_edge: f64, max_edge: f64, aspect: f64| Modelling {
        remesh: Some(EdgeLimits {
            min_edge,
            max_edge,
            aspect,
        }),
        ..draft()
    };
    assert_modelling_refused(&edges(0.0, 1.0, f64::NAN), "remesh.aspect", "NaN");
    assert_modelling_refused(&edges(0.0, 1.0, 0.5), "remesh.aspect", "0.5");
    assert_modelling_refused(&edges(f64::NAN, 1.0, 4.0), "remesh.min_edge", "NaN");
    assert_modelling_refused(&edges(-0.1, 1.0, 4.0), "remesh.min_edge", "-0.1");
    assert_modelling_refused(&edges(0.0, f64::NAN, 4.0), "remesh.max_edge", "NaN");
    assert_modelling_refused(&edges(0.5, 0.5, 4.0), "remesh.max_edge", "0.5");
    let tolerance = Modelling {
        tolerance: f64::NAN,
        ..draft()
    };
    assert_modelling_refused(&tolerance, "tolerance", "NaN");
    let budget = Modelling {
        vertex_budget: 0,
        ..draft()
    };
    assert_modelling_refused(&budget, "vertex_budget", "0");
    let moving = |time_step: f64, damping: f64| Modelling {
        dynamics: Some(Dynamics { time_step, damping }),
        ..draft()
    };
    assert_modelling_refused(&moving(0.0, 0.0), "dynamics.time_step", "0");
    assert_modelling_refused(&moving(0.01, f64::NAN), "dynamics.damping", "NaN");
}

#[test]
fn layers_and_maps_without_meaning_are_refused() {
    let driver = driver();
    let poses = [press(&driver)];
    for (share, found) in [(9.0, "9"), (f64::NAN, "NaN"), (-0.1, "-0.1")] {
        let layers = [LayerSpec {
            bending_transfer: Some(share),
            ..layer()
        }];
        let refused = plan(&driver, &layers, &poses, &draft(), 1024);
        assert_refused(refused, "bending_transfer", found);
    }
    assert_refused(
        plan(&driver, &[layer()], &poses, &draft(), 0),
        "map_size",
        "0",
    );
}

#[test]
fn masks_whose_pixels_do_not_fill_them_are_refused() {
    assert_refused(Mask::new(0, 4, Vec::new()), "width", "0");
    assert_refused(Mask::new(4, 0, Vec::new()), "height", "0");
    assert_refused(Mask::new(2, 2, vec![1.0; 3]), "values", "a list of 3");
    // The product of these sides is no 32-bit number.
    let side = u32::MAX;
    assert_refused(Mask::new(side, side, vec![1.0]), "values", "a list of 1");
    assert_refused(Mask::new(2, 1, vec![1.0, f32::NAN]), "values[1]", "NaN");
    assert_refused(Mask::new(2, 1, vec![-0.5, 1.0]), "values[0]", "-0.5");
    assert!(Mask::new(2, 1, vec![0.0, 1.0]).is_ok());
}

fn triangle() -> Driver {
    let corners = [[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]];
    Driver::new(&ArtistMesh {
        positions: corners.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
        uvs: Some(corners.map(Vector2::from).to_vec()),
        triangles: vec![[0, 1, 2]],
        ..ArtistMesh::default()
    })
    .expect("a triangle")
}

fn assert_other_plan(run: Result<PoseResult, StepperError>, words: &[&str]) {
    let error = run.expect_err("not what was planned");
    let text = error.to_string();
    assert!(matches!(error, StepperError::OtherPlan { .. }), "{text}");
    for word in words {
        assert!(text.contains(word), "{text}");
    }
}

#[test]
fn only_what_was_planned_is_simulated() {
    let driver = driver();
    let good = press(&driver);
    let plan = planned(&driver, &good, &draft()).expect("a valid scene");
    let run =
        |pose: usize, spec: &PoseSpec| simulate(&driver, &plan, pose, spec, &draft(), &mut Silent);
    let missing = run(1, &good);
    assert!(
        matches!(missing, Err(StepperError::NoSuchPose { pose: 1, poses: 1 })),
        "{missing:?}"
    );
    let other = pose(&driver, "squeeze", 1.0);
    assert_other_plan(run(0, &other), &["'press'", "'squeeze'"]);
    let weaker = pose(&driver, "press", 0.5);
    assert_other_plan(run(0, &weaker), &["'press'", "(1, 1.0)", "(1, 0.5)"]);
    let finer = Modelling {
        points_per_wavelength: 8.0,
        ..draft()
    };
    let run = simulate(&driver, &plan, 0, &good, &finer, &mut Silent);
    let (planned, found) = ("points_per_wavelength = 6.0", "points_per_wavelength = 8.0");
    assert_other_plan(run, &[planned, found]);
    let composite = Modelling {
        stack: Stack::Composite,
        ..draft()
    };
    let run = simulate(&driver, &plan, 0, &good, &composite, &mut Silent);
    assert_other_plan(run, &["stack = Nominal", "stack = Composite"]);
    let triangle = triangle();
    let run = simulate(&triangle, &plan, 0, &good, &draft(), &mut Silent);
    assert_other_plan(run, &["169 vertices", "3 vertices"]);
}
