//! Where nothing wrinkles, maps are neutral: on flat and curved, made and scanned meshes.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use std::f64::consts::FRAC_PI_3;
use std::sync::Arc;

use nalgebra::{Rotation3, Vector3};
use ruga_blend::{BlendShape, Driver};
use ruga_stepper::{Modelling, PoseSpec, Region};
use ruga_validation::{Skin, asset, shared_data, tilts};

/// Largest strain of the scaled poses, in critical strains.
const DEMAND: f64 = 0.45;
/// Largest tilt of a neutral map, degrees.
const TILT: f64 = 0.1;
/// Largest height of a neutral map, m.
const HEIGHT: f64 = 1e-6;

/// Everything, at the coarsest resolution that still resolves a wrinkle.
fn everywhere(points_per_wavelength: f64) -> Modelling {
    Modelling {
        region: Region::All,
        points_per_wavelength,
        ..Modelling::default()
    }
}

/// The pose with weights such that the largest strain is [`DEMAND`].
fn scaled(skin: &Skin, pose: PoseSpec, modelling: &Modelling) -> PoseSpec {
    let plan = skin.plan(&pose, modelling);
    let levels = plan.poses[0].layers[0].levels;
    let wanted = DEMAND * plan.wrinkling()[0].critical_strain;
    let mut weights = pose.weights.clone();
    // Strain is not linear in the weights, so three steps towards it.
    for _ in 0..3 {
        let found = skin.largest_strain(&weights, levels, modelling);
        weights = weights.scaled(wanted / found);
    }
    let found = skin.largest_strain(&weights, levels, modelling);
    assert!((found / wanted - 1.0).abs() < 0.05, "{found} for {wanted}");
    PoseSpec { weights, ..pose }
}

/// Worst tilt (degrees) and height (m) of the pose's map.
fn worst(name: &str, skin: &Skin, pose: &PoseSpec, modelling: &Modelling) -> [f64; 2] {
    let result = skin.simulate(pose, modelling);
    assert!(result.converged, "{name}: {:?}", result.warnings);
    let map = skin.bake(pose, &result.keys[0], 512);
    let tilt = tilts(&map).fold(0.0, f64::max);
    let height = map.heights.iter().map(|h| f64::from(h.abs()));
    let height = height.fold(0.0, f64::max);
    let report = &result.layers[0];
    println!(
        "{name}: {} vertices, tilt {tilt:.4} degrees, height {:.4} um, {} iterations, {} folded",
        report.vertices,
        1e6 * height,
        report.newton_iterations,
        map.folded_samples,
    );
    [tilt, height]
}

fn check(name: &str, skin: &Skin, pose: PoseSpec, points_per_wavelength: f64) {
    let modelling = everywhere(points_per_wavelength);
    let pose = scaled(skin, pose, &modelling);
    let automatic = worst(name, skin, &pose, &Modelling::default());
    assert_eq!(automatic, [0.0; 2], "{name}: nothing is simulated");
    let [tilt, height] = worst(name, skin, &pose, &modelling);
    assert!(tilt < TILT, "{name}: tilt {tilt} degrees");
    assert!(height < HEIGHT, "{name}: height {height} m");
}

#[test]
fn forearm_below_critical() {
    let skin = Skin::new(&asset("forearm/forearm.glb"), "forehead-furrow");
    let pose = skin.pose(&[("pinch", 1.0)], 1);
    check("forearm", &skin, pose, 6.0);
}

#[test]
fn finger_below_critical() {
    let skin = Skin::new(&asset("finger/finger.glb"), "forehead-furrow");
    let pose = skin.pose(&[("flex", 1.0)], 1);
    check("finger", &skin, pose, 6.0);
}

#[test]
fn face_below_critical() {
    let Some(path) = shared_data("ict-facekit/ict_face_arkit.glb") else {
        return;
    };
    let skin = Skin::new(&path, "reference-dermis");
    let pose = skin.pose(&[("browInnerUp_L", 1.0), ("browInnerUp_R", 1.0)], 1);
    check("face", &skin, pose, 4.0);
}

#[test]
fn hand_below_critical() {
    let Some(path) = shared_data("makehuman-hand/mh_hand_forearm.glb") else {
        return;
    };
    let skin = Skin::new(&path, "reference-dermis").cut_out("fingersFlex");
    let pose = skin.pose(&[("fingersFlex", 1.0)], 1);
    check("hand", &skin, pose, 4.0);
}

/// A turn by 60 degrees, the whole mesh with it.
#[test]
fn turned_finger() {
    let mut skin = Skin::new(&asset("finger/finger.glb"), "forehead-furrow");
    let axis = Vector3::new(1.0, 2.0, 3.0).normalize();
    let turn = Rotation3::new(axis * FRAC_PI_3);
    let rest = &skin.file.mesh.positions;
    skin.file.mesh.shapes = vec![BlendShape {
        name: "turn".to_owned(),
        position_deltas: rest.iter().map(|p| turn * p - p).collect(),
        normal_deltas: None,
    }];
    skin.driver = Arc::new(Driver::new(&skin.file.mesh).expect("the finger"));
    let pose = skin.pose(&[("turn", 1.0)], 1);
    let [tilt, height] = worst("turned finger", &skin, &pose, &everywhere(6.0));
    assert!(tilt < TILT, "tilt {tilt} degrees");
    assert!(height < HEIGHT, "height {height} m");
}
