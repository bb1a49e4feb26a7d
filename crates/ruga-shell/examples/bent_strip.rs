//! The energy of a strip rolled to a cylinder, against the plate's.
//!
//! `cargo run --release -p ruga-shell --example bent_strip`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use nalgebra::Vector3;
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters, ShellError};

/// Length and width of the strip, and the radius it is rolled to, m.
const LENGTH: f64 = 0.02;
const WIDTH: f64 = 0.01;
const RADIUS: f64 = 0.05;

fn main() -> Result<(), ShellError> {
    let skin = FaceParameters {
        young: 4e6,
        poisson: 0.3,
        thickness: 1e-3,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let stiffness = skin.young * skin.thickness.powi(3) / 12.0 / (1.0 - skin.poisson.powi(2));
    let plate = 0.5 * stiffness * LENGTH * WIDTH / RADIUS.powi(2);
    for cells in [4_u32, 8, 16, 32] {
        let row = 2 * cells + 1;
        let edge = WIDTH / f64::from(cells);
        let rest: Vec<Vector3<f64>> = (0..row * (cells + 1))
            .map(|i| Vector3::new(f64::from(i % row), f64::from(i / row), 0.0) * edge)
            .collect();
        let quads = (0..2 * cells * cells).map(|i| i / (2 * cells) * row + i % (2 * cells));
        let faces: Vec<[u32; 3]> = quads
            .flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]])
            .collect();
        let parameters = LayerParameters::uniform(skin, faces.len(), 0.0, rest.len());
        let layer = LayerEnergy::new(&rest, &faces, parameters, &vec![false; rest.len()])?;
        let rolled = |p: &Vector3<f64>| {
            let angle = p.x / RADIUS;
            Vector3::new(RADIUS * angle.sin(), p.y, RADIUS * (1.0 - angle.cos()))
        };
        let rolled: Vec<_> = rest.iter().map(rolled).collect();
        let bending = layer.energy_parts(&rolled).bending;
        println!(
            "{cells:3} cells: {:.3} of the plate's energy",
            bending / plate
        );
    }
    Ok(())
}
