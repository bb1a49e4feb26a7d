//! Creases that are anchored in a soft body.

mod bodies;

use std::sync::Arc;

use bodies::{free_body, layer, modelling, pose, slab, slice, top};
use nalgebra::{Vector2, Vector3};
use ruga_blend::Driver;
use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, LineTracer};
use ruga_stepper::{
    CreaseAnchor, CreaseReport, CreaseSpec, FoldSense, Keyframe, Motion, Silent, plan_body,
};

const SIZE: Vector3<f64> = Vector3::new(0.08, 0.02, 0.02);

/// Where the line crosses the bar's top.
const LINE: f64 = 0.48 * 0.08;

/// A soft line across the top, which nothing but an anchor draws.
fn line_across(driver: &Driver, width: f64, anchor: Option<CreaseAnchor>) -> CreaseSpec {
    let tracer = LineTracer::new(driver.topology(), driver.rest()).with_uvs(driver.uvs());
    let line = tracer.trace(&LineInput::Uv {
        points: [0.05, 0.95].map(|v| Vector2::new(0.24, v)).to_vec(),
        is_closed: false,
        corners: Corners::Keep,
    });
    CreaseSpec {
        name: "line".into(),
        line: line.expect("a line on the top"),
        law: LineLaw {
            width,
            stiffness: 0.01,
            angle: 0.0,
            fade: [2e-3; 2],
        },
        is_ridge: false,
        sense: FoldSense::Valley,
        drive: Drive::Load,
        anchor,
        memory: CreaseMemory::default(),
    }
}

/// Turns a handle about the middle line of its end of the bar.
fn turn(of: &str, at: f64, angle: f64) -> Motion {
    Motion {
        of: of.into(),
        keyframes: vec![Keyframe {
            at: 1.0,
            translation: Vector3::zeros(),
            turn: Vector3::y() * angle,
            about: Vector3::new(at, 0.0, 0.5 * SIZE.z),
        }],
    }
}

/// A bar whose ends turn upwards until its top is compressed by about `strain`; its crease, and where along the bar
/// the skin is deepest below the flesh.
fn bent(anchor: Option<CreaseAnchor>, strain: f64) -> (CreaseReport, f64) {
    let driver: Arc<Driver> = slab(SIZE, [16, 4, 4], |p| p);
    let mut skin = layer(150.0);
    skin.creases = vec![line_across(&driver, skin.material.thickness, anchor)];
    let mut body = free_body(6);
    body.handles = vec![slice("left", -1.0, 0.01), slice("right", 0.07, 1.0)];
    let mut modelling = modelling(6.0);
    modelling.region = top();
    // 6 cm between the handles: a curvature of strain over half the height.
    let angle = 0.5 * 0.06 * strain / (0.5 * SIZE.z);
    let motions = vec![turn("left", 0.01, angle), turn("right", 0.07, -angle)];
    let poses = [pose(motions, &[1.0], 2)];
    let plan = plan_body(&driver, &[skin], &body, &poses, &modelling, 2048).expect("a bar");
    let result = plan.simulate(0, &mut Silent).expect("a run");
    assert!(result.converged, "{:?}", result.warnings);
    let surface = &result.keys[0].layers[0];
    let places = surface.driver_positions.iter().zip(&surface.positions);
    let depths = places.map(|(p, x)| (p.x, p.z - x.z));
    let deepest = depths.max_by(|a, b| a.1.total_cmp(&b.1)).expect("vertices");
    println!(
        "{anchor:?}: {:?}, deepest at {deepest:?}",
        result.layers[0].creases[0]
    );
    (result.layers[0].creases[0].clone(), deepest.0)
}

/// A bar that is bent until its top would just not wrinkle by itself folds at a line that is anchored in the flesh.
#[test]
fn a_bar_folds_at_an_anchored_line() {
    let anchor = CreaseAnchor {
        depth: 1e-3,
        stiffness: 20.0,
    };
    let (free, _) = bent(None, 0.01);
    let (held, deepest) = bent(Some(anchor), 0.01);
    assert!(
        held.fold > 0.2 && free.fold < 0.02,
        "{} {}",
        held.fold,
        free.fold
    );
    assert!((0.6e-3..1.0e-3).contains(&held.depth), "{}", held.depth);
    assert!((deepest - LINE).abs() < 1e-3, "{deepest}");
}
