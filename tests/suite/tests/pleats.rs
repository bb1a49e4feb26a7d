//! The pleated card among the assets, against spherical trigonometry: flat panels between lines that run to one point.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use nalgebra::Vector3;
use ruga_scene::Scene;
use ruga_stepper::{PoseResult, Silent};
use ruga_validation::asset;

/// Angle of a panel, degrees, and number of panels; inner and outer radius, m.
const PANEL: f64 = 12.0;
const PANELS: i32 = 23;
const INNER: f64 = 0.04;
const RADIUS: f64 = 0.1;

/// Fold angles of mountains and valleys, degrees.
const FOLDS: [f64; 2] = [110.0, 84.0];

/// The scene on a coarse mesh: flat panels need no better one.
fn folded() -> (Scene, PoseResult) {
    let mut scene = Scene::read(&asset("paper/pleats.toml")).unwrap();
    scene.sheet.as_mut().unwrap().edge = Some(8e-3);
    let plan = scene.plan().unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    (scene, result)
}

/// Angle from a mountain to the next, seen along the axis of the cone, degrees: that of the turn by a panel, a
/// mountain, a panel and a valley.
fn pair_angle() -> f64 {
    let half = (0.5 * PANEL).to_radians();
    let [sum, difference] = [FOLDS[0] + FOLDS[1], FOLDS[0] - FOLDS[1]].map(f64::to_radians);
    let cosine =
        half.cos().powi(2) * (0.5 * difference).cos() - half.sin().powi(2) * (0.5 * sum).cos();
    2.0 * cosine.acos().to_degrees()
}

/// Outer ends of the borders and of the creases between them, odd ones mountains, where the sheet has taken them.
fn rim(scene: &Scene, result: &PoseResult) -> Vec<Vector3<f64>> {
    let places = result.keys.last().unwrap().artist_positions.as_ref();
    let end = |crease: i32| {
        let azimuth = (PANEL * (f64::from(crease) - 0.5 * f64::from(PANELS))).to_radians();
        let rest = Vector3::new(azimuth.sin(), -azimuth.cos(), 0.0) * RADIUS;
        let is_it = |p: &Vector3<f64>| (p - rest).norm() < 1e-8;
        let vertex = scene.driver.rest().iter().position(is_it).unwrap();
        places.unwrap()[vertex]
    };
    (0..=PANELS).map(end).collect()
}

/// Bending energy (J) of the card without creases when each panel bends evenly by the angle of a crease.
fn uncreased_energy(scene: &Scene) -> f64 {
    let material = &scene.layers[0].material;
    let modulus = material.young * material.thickness.powi(3) / 12.0;
    let angle = (0.5 * (FOLDS[0] + FOLDS[1])).to_radians();
    // Per length along the line, over the width of a panel, which is largest at the rim.
    let width = PANEL.to_radians() * RADIUS;
    0.5 * modulus * angle.powi(2) / width * (RADIUS - INNER) * f64::from(PANELS - 1)
}

#[test]
fn pleats_fold_to_their_angles_and_close_to_a_cone() {
    let (scene, result) = folded();
    assert!(result.converged, "{:?}", result.warnings);
    let report = &result.layers[0];
    assert_eq!(report.creases.len(), 22);
    assert_eq!(report.intersections, Some(0));
    for crease in &report.creases {
        let wanted = match crease.name.starts_with("mountain") {
            true => -FOLDS[0],
            false => FOLDS[1],
        };
        for fold in [crease.fold, crease.largest_fold] {
            let error = (fold.to_degrees() - wanted).abs();
            assert!(error < 0.05, "{}: {error}", crease.name);
        }
    }
    let energy = report.energy / uncreased_energy(&scene);
    assert!(energy < 1e-5, "{energy}");
    let rim = rim(&scene, &result);
    for ends in rim.windows(3) {
        // The clip's turn sets the axis upright.
        assert!((ends[2].z - ends[0].z).abs() < 1e-4, "{ends:?}");
        let [a, b] = [ends[0].xy(), ends[2].xy()];
        let turn = a.perp(&b).atan2(a.dot(&b)).to_degrees();
        assert!((turn - pair_angle()).abs() < 0.05, "{turn}");
    }
    // Once around, but for a slit between the two borders.
    let [first, last] = [rim[0].xy(), rim[rim.len() - 1].xy()];
    let slit = last.perp(&first).atan2(last.dot(&first)).to_degrees();
    let around = 0.5 * f64::from(PANELS) * pair_angle();
    assert!((slit - (360.0 - around)).abs() < 0.2, "{slit}");
    assert!((slit - 10.6).abs() < 0.2, "{slit}");
}
