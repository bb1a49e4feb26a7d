//! Load steps that grow the strain instead of the weights, where weights would lead astray.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{Rotation3, Vector3};
use ruga_blend::{BlendShape, Driver};
use ruga_stepper::{LoadPath, Modelling, PoseResult};
use ruga_validation::{Skin, asset};

fn draft() -> Modelling {
    Modelling {
        points_per_wavelength: 6.0,
        ..Modelling::default()
    }
}

/// The forearm with one more shape: `compress`, turned by a third of a circle.
fn turning_forearm() -> Skin {
    let mut skin = Skin::new(&asset("forearm/forearm.glb"), "forehead-furrow");
    let mesh = &mut skin.file.mesh;
    let compress = mesh.shapes.iter().find(|shape| shape.name == "compress");
    let deltas = &compress.expect("a shape of the asset").position_deltas;
    let turn = Rotation3::new(Vector3::y() * (TAU / 3.0));
    let moved = mesh.positions.iter().zip(deltas);
    let turned = BlendShape {
        name: "turn".to_owned(),
        position_deltas: moved.map(|(p, d)| turn * (p + d) - p).collect(),
        normal_deltas: None,
    };
    mesh.shapes.push(turned);
    skin.driver = Arc::new(Driver::new(mesh).expect("a mesh as good as before"));
    skin
}

/// Simulates a pose at its keys alone, then from load to load.
fn run(skin: &Skin, shape: &str, path: LoadPath, keys: &[f64]) -> [PoseResult; 2] {
    let mut pose = skin.pose(&[(shape, 1.0)], 4);
    pose.keys = keys.to_vec();
    assert_eq!(skin.plan(&pose, &draft()).poses[0].path, path, "{shape}");
    let layers = std::slice::from_ref(&skin.layer);
    let results = [
        skin.simulate(&pose, &draft()),
        skin.follow(layers, &pose, &draft()),
    ];
    for result in &results {
        assert!(result.converged, "{shape}: {:?}", result.warnings);
        let report = &result.layers[0];
        println!(
            "{shape}: onset {:?}, amplitude {:.4} mm, wavelength {:.3} mm, {} iterations",
            report.onset_load,
            1e3 * report.amplitude,
            1e3 * report.wavelength.unwrap_or(0.0),
            report.newton_iterations
        );
    }
    results
}

/// Half way the turning shape is half as wide as at its ends, and would wrinkle all over.
#[test]
fn a_turning_shape_wrinkles_as_one_that_does_not_turn() {
    let skin = turning_forearm();
    let plain = run(&skin, "compress", LoadPath::Weight, &[1.0]);
    let keys = [0.02, 1.0];
    let turned = run(&skin, "turn", LoadPath::Strain, &keys);
    // From load to load each key has a sequence of its own.
    let frames = [0, 1].map(|i| turned[i].frames);
    assert!(frames[0] == 2 && frames[1] >= 8, "{frames:?} frames");
    for result in &turned {
        let reached: Vec<f64> = result.keys.iter().map(|key| key.load).collect();
        assert_eq!(reached, keys);
    }
    // One skin, whatever the way to it.
    let [reference, others @ ..] = [&plain[0], &plain[1], &turned[0], &turned[1]];
    let reference = &reference.layers[0];
    for other in others.map(|result| &result.layers[0]) {
        let amplitude = other.amplitude / reference.amplitude - 1.0;
        assert!(amplitude.abs() < 0.02, "amplitude {amplitude}");
        let energy = other.energy / reference.energy - 1.0;
        assert!(energy.abs() < 0.01, "energy {energy}");
        let wavelengths = [reference, other].map(|layer| layer.wavelength.expect("wrinkles"));
        let wavelength = wavelengths[1] / wavelengths[0] - 1.0;
        assert!(wavelength.abs() < 0.03, "wavelength {wavelength}");
    }
}
