//! Lists the presets with the wrinkles that they make, and designs a layer for wrinkles of 5 mm.
//!
//! `cargo run --release -p ruga-material --example presets`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use ruga_material::{MaterialError, PRESETS, WavelengthModel, design_layer, wrinkling};

fn main() -> Result<(), MaterialError> {
    for preset in &PRESETS {
        let wave = wrinkling(&preset.layer, &preset.substrate, WavelengthModel::Layer)?;
        println!(
            "{:20} {:6.2} mm from a compression of {:4.1} %",
            preset.name,
            1e3 * wave.wavelength,
            1e2 * wave.critical_strain
        );
    }
    let below = PRESETS[0].substrate;
    let layer = design_layer(5e-3, 0.04, 0.48, 1100.0, &below)?;
    println!(
        "5 mm at 4 % on {:.1} MPa: {:.1} MPa, {:.2} mm thick",
        below.young / 1e6,
        layer.young / 1e6,
        1e3 * layer.thickness
    );
    Ok(())
}
