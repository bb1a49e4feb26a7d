//! Pairs of layers that the tests share, and how numbers are compared.
#![allow(dead_code, reason = "no test uses all of it")]

use ruga_material::{JointMode, LayerMaterial, StackLayer, StackPair, Substrate, WavelengthModel};

/// Skin in MPa and mm, as the notes print it.
pub(crate) fn skin(young: f64, thickness: f64) -> LayerMaterial {
    LayerMaterial {
        young: young * 1e6,
        poisson: 0.48,
        thickness: thickness * 1e-3,
        density: 1100.0,
    }
}

/// Layers, bottom first, each on the one below.
pub(crate) fn stack(layers: &[LayerMaterial], substrate: Substrate) -> Vec<StackLayer> {
    let mut below = substrate;
    let mut found = Vec::new();
    for layer in layers {
        let placed = StackLayer::new(*layer, &below, WavelengthModel::Layer);
        found.push(placed.expect("valid materials"));
        below = layer.as_substrate();
    }
    found
}

/// `(E2, h2, E1, h1, E_s, H)` in MPa and mm.
pub(crate) fn pair(values: [f64; 6]) -> StackPair {
    let [young2, height2, young1, height1, young, height] = values;
    let layers = stack(
        &[skin(young1, height1), skin(young2, height2)],
        skin(young, height).as_substrate(),
    );
    StackPair::new(&layers[0], &layers[1]).expect("valid materials")
}

pub(crate) const LK: [f64; 6] = [600.0, 0.12, 4.0, 1.3, 0.5, 15.0];
pub(crate) const THIN_FILM: [f64; 6] = [200.0, 0.04, 4.0, 1.3, 0.5, 15.0];
pub(crate) const FACE2: [f64; 6] = [14.0, 0.05, 0.3, 1.0, 0.024, 8.0];
pub(crate) const MIDDLE: [f64; 6] = [12.0, 0.05, 2.0, 1.0, 0.05, 10.0];
pub(crate) const WEAK: [f64; 6] = [6.0, 0.03, 2.0, 1.0, 0.05, 10.0];

/// The large wave of a pair that has one.
pub(crate) fn joint(pair: &StackPair) -> JointMode {
    pair.joint.expect("a large wave")
}

pub(crate) fn assert_prints(found: f64, printed: f64, digit: f64, what: &str) {
    assert!(
        (found - printed).abs() <= 0.5 * digit,
        "{what}: {found}, printed {printed}"
    );
}

pub(crate) fn assert_close(found: f64, expected: f64, relative: f64, what: &str) {
    assert!(
        (found / expected - 1.0).abs() < relative,
        "{what}: {found}, expected {expected}"
    );
}
