//! Two layers solved at once, and the composite that stands for them.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_material::preset;
use ruga_stepper::{LayerSpec, Mask, Modelling, PoseResult, Region, Stack};
use ruga_validation::{Skin, asset, findings};

/// The middle of the patch, 4.2 cm along the compression and 2 cm across: a little less than seven half waves of
/// the pair. Where a patch holds half of one more, small things decide between two numbers.
fn middle() -> Region {
    let side = 100;
    let inside = |i: usize| (29..71).contains(&(i % side)) && (40..60).contains(&(i / side));
    let values = (0..side * side).map(|i| if inside(i) { 1.0 } else { 0.0 });
    let mask = Mask::new(side as u32, side as u32, values.collect());
    Region::Mask(mask.expect("a square"))
}

/// The pair of the preset `face2`, its film five times as thick and a fifth as stiff: that keeps
/// the force it carries and makes a mesh for its wrinkles affordable.
fn pair(skin: &Skin) -> [LayerSpec; 2] {
    let mut film = preset("face2-epidermis").expect("a preset").layer;
    film.thickness *= 5.0;
    film.young /= 5.0;
    let upper = LayerSpec {
        name: "upper".to_owned(),
        material: film,
        substrate: skin.layer.material.as_substrate(),
        ..skin.layer.clone()
    };
    [skin.layer.clone(), upper]
}

fn run(skin: &Skin, stack: Stack, weight: f64) -> PoseResult {
    let modelling = Modelling {
        region: middle(),
        points_per_wavelength: 5.0,
        stack,
        ..Modelling::default()
    };
    let pose = skin.pose(&[("compress", weight)], 4);
    let result = skin.follow(&pair(skin), &pose, &modelling);
    for layer in &result.layers {
        println!("{stack:?}, {}", findings(layer));
    }
    assert!(result.converged, "{:?}", result.warnings);
    result
}

/// The large wave has the same length, height and onset; lengths come in steps of a half-wave in
/// the patch, onsets in those of the search for them.
#[test]
fn a_composite_does_what_both_layers_do_together() {
    let skin = Skin::new(&asset("forearm/forearm.glb"), "face2-dermis");
    let lower = |stack| run(&skin, stack, 0.7).layers[0].clone();
    let [joint, composite] = [Stack::Joint, Stack::Composite].map(lower);
    let ratio = |a: Option<f64>, b: Option<f64>| a.expect("wrinkles") / b.expect("wrinkles");
    let wavelength = ratio(composite.wavelength, joint.wavelength);
    assert!((wavelength - 1.0).abs() < 0.05, "wavelength {wavelength}");
    let onset = ratio(composite.onset_load, joint.onset_load);
    assert!((onset - 1.0).abs() < 0.1, "onset {onset}");
    let amplitude = composite.amplitude / joint.amplitude;
    assert!((amplitude - 1.0).abs() < 0.1, "amplitude {amplitude}");
}
