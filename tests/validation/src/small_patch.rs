//! The smallest skin that wrinkles as the product has it: a second each, for loads that no artist
//! should ask for.

use std::sync::Arc;

use ruga_blend::Driver;
use ruga_stepper::{LayerSpec, Modelling, Plan, PoseResult, Silent, StepperError, plan};

use crate::{EveryFrame, Patch, skin_layer};

/// A flat patch of skin of four by two wavelengths, as the product takes it.
pub fn patch(compression: f64) -> Patch {
    Patch {
        length: 0.04,
        width: 0.02,
        compression,
    }
}

/// The skin on it: the preset `forehead-furrow`.
pub fn skin() -> LayerSpec {
    skin_layer("skin", "forehead-furrow")
}

/// Draft quality: six points per wavelength.
pub fn draft() -> Modelling {
    Modelling {
        points_per_wavelength: 6.0,
        ..Modelling::default()
    }
}

/// What the planner says of a patch.
///
/// # Panics
/// When it refuses the patch.
pub fn planned(patch: &Patch, layer: &LayerSpec, modelling: &Modelling) -> Plan {
    let driver = patch.driver();
    let poses = [patch.pose(&driver, 1)];
    let layers = std::slice::from_ref(layer);
    plan(&driver, layers, &poses, modelling, 1024).expect("a patch that can be planned")
}

/// Equilibrium of a patch that is followed from load to load.
///
/// # Panics
/// When the stepper refuses the patch.
pub fn followed(patch: &Patch, layer: &LayerSpec, steps: u32) -> PoseResult {
    let driver = patch.driver();
    let pose = patch.pose(&driver, steps);
    let (layers, poses) = (std::slice::from_ref(layer), std::slice::from_ref(&pose));
    let plan = plan(&driver, layers, poses, &draft(), 1024).expect("a patch that can be planned");
    plan.simulate(0, &mut EveryFrame).expect("a patch")
}

/// What the stepper makes of a patch at its key, in `steps` steps in time if it moves.
///
/// # Panics
/// When it refuses the patch.
pub fn simulated(
    patch: &Patch,
    layer: &LayerSpec,
    modelling: &Modelling,
    steps: u32,
) -> PoseResult {
    simulated_on(&patch.driver(), layer, modelling, steps).expect("a patch")
}

/// What the stepper makes of a driver with the blend shape of every patch, in `steps` steps in time if it
/// moves.
///
/// # Errors
/// What planner and stepper refuse.
pub fn simulated_on(
    driver: &Arc<Driver>,
    layer: &LayerSpec,
    modelling: &Modelling,
    steps: u32,
) -> Result<PoseResult, StepperError> {
    let pose = patch(0.0).pose(driver, steps);
    let (layers, poses) = (std::slice::from_ref(layer), std::slice::from_ref(&pose));
    let plan = plan(driver, layers, poses, modelling, 1024)?;
    plan.simulate(0, &mut Silent)
}
