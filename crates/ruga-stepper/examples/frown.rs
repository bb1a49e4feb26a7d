//! Wrinkles a square of skin that a blend shape compresses.
//!
//! `cargo run --release -p ruga-stepper --example frown`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use std::error::Error;
use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_material::preset;
use ruga_stepper::{LayerSpec, Modelling, PoseSpec, Silent, plan};

fn main() -> Result<(), Box<dyn Error>> {
    let square = [[0.0, 0.0], [0.04, 0.0], [0.04, 0.04], [0.0, 0.04]];
    let driver = Arc::new(Driver::new(&ArtistMesh {
        positions: square.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
        uvs: Some(
            square
                .map(|[x, y]| Vector2::new(25.0 * x, 25.0 * y))
                .to_vec(),
        ),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        shapes: vec![BlendShape {
            name: "compress".into(),
            position_deltas: square
                .map(|[x, _]| Vector3::new(-0.1 * x, 0.0, 0.0))
                .to_vec(),
            normal_deltas: None,
        }],
        ..ArtistMesh::default()
    })?);
    let skin = preset("forehead-furrow").ok_or("no such preset")?;
    let layers = [LayerSpec::from_preset(skin, 1)?];
    let poses = [PoseSpec {
        name: "frown".into(),
        weights: driver.weights([("compress", 1.0)])?,
        keys: vec![0.25, 0.5, 0.75, 1.0],
        steps: 4,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }];
    let plan = plan(&driver, &layers, &poses, &Modelling::draft(), 1024)?;
    for warning in &plan.warnings {
        println!("{warning}");
    }
    let result = plan.simulate(0, &mut Silent)?;
    let layer = &result.layers[0];
    println!(
        "{} vertices, wrinkles {:.2} mm deep",
        layer.vertices,
        1e3 * layer.amplitude
    );
    Ok(())
}
