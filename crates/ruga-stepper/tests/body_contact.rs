//! A soft block that a ball, a button or a plate is pressed into.

mod bodies;

use bodies::{free_body, layer, modelling, pose, push, slab, top};
use nalgebra::Vector3;
use ruga_stepper::{Handle, Obstacle, ObstacleShape, PoseResult, Silent, plan_body};

const SIZE: Vector3<f64> = Vector3::new(0.04, 0.04, 0.02);

/// The block on its floor with something pressed into its top by `depth` (m).
fn pressed(shape: ObstacleShape, depth: f64, steps: u32) -> PoseResult {
    let driver = slab(SIZE, [8, 8, 4], |p| p);
    let mut body = free_body(4);
    body.handles = vec![Handle::new(
        "floor",
        [Vector3::repeat(-1.0), Vector3::new(1.0, 1.0, 0.01)],
    )];
    body.obstacles = vec![Obstacle {
        name: "press".into(),
        shape,
    }];
    let mut modelling = modelling(6.0);
    modelling.region = top();
    let poses = [pose(
        vec![push("press", Vector3::z() * -depth)],
        &[1.0],
        steps,
    )];
    let plan = plan_body(&driver, &[layer(50.0)], &body, &poses, &modelling, 1024);
    let run = plan.expect("a closed block").simulate(0, &mut Silent);
    run.expect("a run")
}

/// Deepest way into the obstacle in thicknesses of the layer; less than 0 outside.
fn depth(result: &PoseResult, into: impl Fn(&Vector3<f64>) -> f64) -> f64 {
    let x = &result.keys[0].layers[0].computed.positions;
    let deepest = x.iter().map(into).fold(f64::NEG_INFINITY, f64::max);
    deepest / layer(50.0).material.thickness
}

#[test]
fn a_ball_is_kept_out() {
    let (centre, radius) = (Vector3::new(0.02, 0.02, 0.0301), 0.01);
    let result = pressed(ObstacleShape::Sphere { centre, radius }, 0.004, 2);
    assert!(result.converged, "{:?}", result.warnings);
    let centre: Vector3<f64> = centre - Vector3::z() * 0.004;
    let depth = depth(&result, |x: &Vector3<f64>| radius - (x - centre).norm());
    // It touches, and sinks in by less than a tenth of the thickness.
    assert!((-0.05..0.1).contains(&depth), "{depth}");
}

#[test]
fn a_plate_presses_the_top_flat_and_the_sides_out() {
    let plate = ObstacleShape::Plane {
        point: Vector3::new(0.0, 0.0, 0.0201),
        normal: -Vector3::z(),
    };
    let result = pressed(plate, 0.003, 2);
    assert!(result.converged, "{:?}", result.warnings);
    let depth = depth(&result, |x: &Vector3<f64>| x.z - 0.0171);
    assert!((-0.05..0.1).contains(&depth), "{depth}");
    let shown = &result.keys[0].layers[0].driver_positions;
    // Without friction the block may lean to either side; it gets wider all the same.
    let ends = shown.iter().fold([f64::MAX, f64::MIN], |[low, high], x| {
        [low.min(x.x), high.max(x.x)]
    });
    let width = ends[1] - ends[0];
    assert!(width > SIZE.x + 2e-3, "{width}");
}

#[test]
fn a_button_is_kept_out_along_its_rim() {
    let (low, radius) = (Vector3::new(0.02, 0.02, 0.0201), 0.008);
    let shape = ObstacleShape::Cylinder {
        from: low,
        to: low + Vector3::z() * 0.01,
        radius,
    };
    let result = pressed(shape, 0.0015, 1);
    assert!(result.converged, "{:?}", result.warnings);
    // Under the middle of its end; the rim is looked at by the run itself, which would warn.
    let inside = |x: &Vector3<f64>| (x - low).xy().norm() < 0.8 * radius;
    let depth = depth(
        &result,
        |x: &Vector3<f64>| if inside(x) { x.z - 0.0186 } else { f64::MIN },
    );
    assert!((-0.05..0.1).contains(&depth), "{depth}");
    let warnings = &result.warnings;
    assert!(
        !warnings.iter().any(|w| w.contains("inside an obstacle")),
        "{warnings:?}"
    );
}
