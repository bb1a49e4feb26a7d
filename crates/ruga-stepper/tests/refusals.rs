//! Values that nothing can be planned or simulated with are refused at once, by name.

mod patch;

use std::sync::Arc;
use std::time::{Duration, Instant};

use patch::{draft, driver, pose, skin};
use ruga_blend::Driver;
use ruga_stepper::{
    Coupling, Dynamics, EdgeLimits, LayerSpec, Mask, Modelling, Motion, Plan, PoseSpec, Silent,
    StepperError, plan,
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

fn planned(
    driver: &Arc<Driver>,
    spec: &PoseSpec,
    modelling: &Modelling,
) -> Result<Plan, StepperError> {
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

/// Asserts that a pose is refused at once.
fn assert_pose_refused(spec: &PoseSpec, field: &str, found: &str) {
    let driver = driver();
    let since = Instant::now();
    assert_refused(planned(&driver, spec, &draft()), field, found);
    assert!(since.elapsed() < AT_ONCE, "{field}: {:?}", since.elapsed());
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

/// Asserts that a modelling is refused at once.
fn assert_modelling_refused(modelling: &Modelling, field: &str, found: &str) {
    let driver = driver();
    let spec = press(&driver);
    let since = Instant::now();
    assert_refused(planned(&driver, &spec, modelling), field, found);
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
    let patches = Modelling {
        whole_vertices: 0,
        ..draft()
    };
    assert_modelling_refused(&patches, "whole_vertices", "0");
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

#[test]
fn only_what_was_planned_is_simulated() {
    let driver = driver();
    let plan = planned(&driver, &press(&driver), &draft()).expect("a valid scene");
    let missing = plan.simulate(1, &mut Silent);
    assert!(
        matches!(missing, Err(StepperError::NoSuchPose { pose: 1, poses: 1 })),
        "{missing:?}"
    );
}

/// Without a body there is no handle that could move.
#[test]
fn a_pose_of_skin_has_no_motions() {
    let driver = driver();
    let mut moved = press(&driver);
    moved.motions = vec![Motion {
        of: "jaw".into(),
        keyframes: Vec::new(),
    }];
    let refused = planned(&driver, &moved, &draft());
    assert!(matches!(refused, Err(StepperError::UnknownMover { name, .. }) if name == "jaw"));
}
