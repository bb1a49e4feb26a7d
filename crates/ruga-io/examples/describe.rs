//! Says what a mesh file holds.
//!
//! `cargo run --release -p ruga-io --example describe -- face.glb`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use std::env;
use std::path::PathBuf;

use ruga_io::{IoError, ObjOptions, read_mesh};

fn main() -> Result<(), IoError> {
    let forearm = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/forearm/forearm.glb"
    );
    let path = env::args_os()
        .nth(1)
        .map_or_else(|| forearm.into(), PathBuf::from);
    let file = read_mesh(&path, None, &ObjOptions::default())?;
    let mesh = &file.mesh;
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    println!("{}: {vertices} vertices, {triangles} triangles", mesh.name);
    for shape in &mesh.shapes {
        let lengths = shape.position_deltas.iter().map(|delta| delta.norm());
        println!(
            "  {}: moves up to {:.1} mm",
            shape.name,
            1e3 * lengths.fold(0.0, f64::max)
        );
    }
    for warning in &file.warnings {
        println!("  {warning}");
    }
    Ok(())
}
