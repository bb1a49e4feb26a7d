//! Layers on layers, painted layers, and meshes that change: one program, whose long tests run side
//! by side.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_stepper::{LayerSpec, Modelling, PoseResult};
use ruga_validation::{Skin, findings};

mod crests;
mod joint;
mod painted;
mod remeshing;
mod stack;

/// The skin's shape `compress`, `weight` times as strong, under two layers.
fn compressed(
    skin: &Skin,
    layers: &[LayerSpec; 2],
    weight: f64,
    modelling: &Modelling,
) -> PoseResult {
    let pose = skin.pose(&[("compress", weight)], 4);
    let result = skin.simulate_stack(layers, &pose, modelling);
    for layer in &result.layers {
        println!("{:?}, {}", modelling.stack, findings(layer));
    }
    assert!(result.converged, "{:?}", result.warnings);
    result
}
