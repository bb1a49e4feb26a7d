//! Layers on layers: small wrinkles on large ones, by themselves or as one composite.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_material::{LayerMaterial, preset};
use ruga_stepper::{Coupling, LayerSpec, Mask, Modelling, PoseResult, Region, Stack, plan};
use ruga_validation::{Skin, asset, findings};

/// The middle of the patch, 4 by 3 cm.
fn middle() -> Region {
    let (width, height) = (20, 20);
    let inside = |i: usize| (6..14).contains(&(i % 20)) && (7..13).contains(&(i / 20));
    let values = (0..400).map(|i| if inside(i) { 1.0 } else { 0.0 });
    Region::Mask(Mask::new(width, height, values.collect()).expect("a square"))
}

fn on(lower: &LayerSpec, material: LayerMaterial) -> LayerSpec {
    LayerSpec {
        name: "upper".to_owned(),
        material,
        substrate: lower.material.as_substrate(),
        ..lower.clone()
    }
}

/// The forearm's compression, `weight` times as strong, under two layers.
fn run(skin: &Skin, upper: &LayerSpec, weight: f64, stack: Stack) -> PoseResult {
    let layers = [skin.layer.clone(), upper.clone()];
    let modelling = Modelling {
        region: middle(),
        points_per_wavelength: 6.0,
        stack,
        ..Modelling::default()
    };
    let pose = skin.pose(&[("compress", weight)], 4);
    let result = skin.simulate_stack(&layers, &pose, &modelling);
    for layer in &result.layers {
        println!("{stack:?}, {}", findings(layer));
    }
    assert!(result.converged, "{:?}", result.warnings);
    result
}

/// The thesis' dermis and epidermis beyond the onset of both: each has its own wavelength.
#[test]
fn nominal_layers_have_two_wavelengths() {
    let skin = Skin::new(&asset("forearm/forearm.glb"), "reference-dermis");
    let epidermis = preset("reference-epidermis").expect("a preset").layer;
    let upper = on(&skin.layer, epidermis);
    let result = run(&skin, &upper, 1.5, Stack::Nominal);
    for layer in &result.layers {
        let ratio = layer.wavelength.expect("wrinkles") / layer.wavelength_predicted;
        assert!((ratio - 1.0).abs() < 0.15, "{}: {ratio}", layer.name);
    }
    let top = result.keys[0].layers.last().expect("two layers");
    let thickness = skin.layer.material.thickness + upper.material.thickness;
    assert!((top.offset - 0.5 * thickness).abs() < 1e-12);
}

/// A pair that is solved as one composite wrinkles sooner and wider below.
#[test]
fn a_composite_wrinkles_as_the_pair_does_together() {
    let mut skin = Skin::new(&asset("forearm/forearm.glb"), "face2-dermis");
    skin.layer.coupling = Coupling::Hybrid;
    let epidermis = preset("face2-epidermis").expect("a preset").layer;
    let mut upper = on(&skin.layer, epidermis);
    // Ten times the fine wavelength keeps the fine mesh small; only the lower layer is looked at.
    upper.material.thickness *= 3.0;
    upper.material.young /= 3.0;
    let layers = [skin.layer.clone(), upper.clone()];
    let poses = [skin.pose(&[("compress", 1.0)], 4)];
    let modelling = Modelling {
        stack: Stack::Composite,
        ..Modelling::default()
    };
    let plan = plan(&skin.driver, &layers, &poses, &modelling, 1024).expect("a plan");
    let joint = plan.pairs()[0].joint.expect("a joint wave");
    let lower = &plan.poses[0].layers[0];
    assert!((lower.wavelength / joint.wavelength - 1.0).abs() < 1e-6);
    assert!((lower.critical_strain / joint.critical_strain - 1.0).abs() < 1e-6);
    let result = run(&skin, &upper, 0.8, Stack::Composite);
    let lower = &result.layers[0];
    let ratio = lower.wavelength.expect("wrinkles") / lower.wavelength_predicted;
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
}
