//! Painted maps: every place wrinkles by its own thickness and stiffness.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use std::f64::consts::TAU;
use std::sync::Arc;

use ruga_material::{PropertyImage, PropertyMap, RelativeProperties, Wrap, local_wrinkling};
use ruga_stepper::{LayerSurface, Modelling};
use ruga_validation::{Skin, asset};

/// The forearm's patch, 10 cm wide, under one layer with a map.
fn painted_forearm(map: PropertyMap) -> Skin {
    let mut skin = Skin::new(&asset("forearm/forearm.glb"), "forehead-furrow");
    skin.layer.map = Some(Arc::new(map));
    skin
}

fn compressed(skin: &Skin) -> LayerSurface {
    let mut pose = skin.pose(&[("compress", 1.0)], 6);
    pose.keys = vec![1.0];
    let draft = Modelling {
        points_per_wavelength: 8.0,
        ..Modelling::default()
    };
    let mut result = skin.simulate(&pose, &draft);
    assert!(result.converged, "{:?}", result.warnings);
    result.keys.remove(0).layers.remove(0)
}

/// One row of texels.
fn image(values: Vec<f32>, range: [f64; 2]) -> Option<PropertyImage> {
    Some(PropertyImage {
        width: values.len(),
        height: 1,
        values,
        range,
    })
}

/// `2 pi sqrt(int w² / int |w_u|²)` over the triangles in a window of U, away from the pinned
/// borders, m.
fn local_wavelength(layer: &LayerSurface, window: [f64; 2]) -> f64 {
    let (mut squares, mut slopes) = (0.0, 0.0);
    for (face, uvs) in layer.faces.iter().zip(layer.uvs.iter()) {
        let centre = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
        let inside = (window[0]..window[1]).contains(&centre.x) && (0.2..0.8).contains(&centre.y);
        if !inside {
            continue;
        }
        let [a, b, c] = face.map(|v| {
            let v = v as usize;
            let deviation = layer.positions[v] - layer.driver_positions[v];
            layer.driver_normals[v].dot(&deviation)
        });
        let (p, q) = (uvs[1] - uvs[0], uvs[2] - uvs[0]);
        let twice_area = p.perp(&q);
        // The patch is 10 cm wide.
        let slope = ((b - a) * q.y - (c - a) * p.y) / twice_area / 0.1;
        squares += twice_area.abs() / 12.0 * ((a + b + c).powi(2) + a * a + b * b + c * c);
        slopes += twice_area.abs() * slope * slope;
    }
    TAU * (squares / slopes).sqrt()
}

fn check(name: &str, skin: &Skin, layer: &LayerSurface, window: [f64; 2], at: RelativeProperties) {
    let predicted = local_wrinkling(
        &skin.layer.material,
        &skin.layer.substrate,
        skin.layer.model,
        &at,
    )
    .expect("a material")
    .wavelength;
    let ratio = local_wavelength(layer, window) / predicted;
    println!(
        "{name}: {:.2} mm predicted, ratio {ratio:.3}",
        1e3 * predicted
    );
    assert!((ratio - 1.0).abs() < 0.1, "{name}: {ratio}");
}

/// Thin on the left, as thick as the layer says on the right.
fn step(sharp: bool) -> Skin {
    let halves = (0..64).map(|i| if i < 32 { 0.0 } else { 1.0 }).collect();
    let thickness = image(halves, [0.5, 1.0]);
    let map = PropertyMap::new(None, None, thickness, Wrap::ClampToEdge).expect("a map");
    let mut skin = painted_forearm(map);
    skin.layer.sharp = sharp;
    skin
}

fn check_step(skin: &Skin) {
    let layer = compressed(skin);
    let thin = RelativeProperties {
        thickness: 0.5,
        ..RelativeProperties::default()
    };
    check("thin", skin, &layer, [0.15, 0.43], thin);
    check(
        "thick",
        skin,
        &layer,
        [0.57, 0.85],
        RelativeProperties::default(),
    );
}

#[test]
fn a_step_of_thickness_makes_two_wavelengths() {
    check_step(&step(false));
}

/// The same with edges along the step.
#[test]
fn a_sharp_step_of_thickness_makes_two_wavelengths() {
    check_step(&step(true));
}

#[test]
fn a_ramp_of_stiffness_stretches_the_wrinkles() {
    // A pattern that ends left and right at the pinned border, eight times as stiff at the right.
    let young = image(vec![0.0, 1.0], [1.0, 8.0]);
    let map = PropertyMap::new(None, young, None, Wrap::ClampToEdge).expect("a map");
    let skin = painted_forearm(map);
    let layer = compressed(&skin);
    for [from, to] in [[0.25, 0.5], [0.5, 0.75]] {
        // Between the centres of the two texels, at 1/4 and 3/4, the map is linear.
        let young = 1.0 + 7.0 * (0.5 * (from + to) - 0.25) / 0.5;
        let at = RelativeProperties {
            young,
            ..RelativeProperties::default()
        };
        check(
            &format!("{young:.2} times as stiff"),
            &skin,
            &layer,
            [from, to],
            at,
        );
    }
}
