//! What averaging constraints see of waves: long ones, and not the wrinkles.
//!
//! `cargo run --release -p ruga-constraint --example averages`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use std::error::Error;
use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
use ruga_mesh::{MaterialPoint, PerVertex, TriMesh, subdivide, vertex_normals};

fn main() -> Result<(), Box<dyn Error>> {
    // A square of 16 cm, constraints every 15 mm: beside a foundation, for wrinkles of 10 mm.
    let coarse = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
    let fine = subdivide(&coarse, 7, &PerVertex::filled(4, true));
    let square = [[0.0, 0.0], [0.16, 0.0], [0.16, 0.16], [0.0, 0.16]];
    let positions = fine
        .fine_from_coarse
        .apply(&square.map(|[x, y]| Vector3::new(x, y, 0.0)));
    let normals = vertex_normals(&fine.mesh, &positions);
    let spacing = PerVertex::filled(positions.len(), 0.015);
    let everywhere: Vec<_> = spacing.ids().collect();
    let settings = ClusterSettings::default();
    let centres = cluster_centres(&fine.mesh, &positions, &spacing, &everywhere, &settings)?;
    let places = centres
        .iter()
        .filter_map(|&v| MaterialPoint::of_vertex(&fine.mesh, v));
    let places: Vec<_> = places.collect();
    let kernels = vec![Kernel::beside_foundation(0.015); places.len()];
    let sampling = Sampling::Quadrature;
    let set = constraint_rows(
        &fine.mesh, &positions, &normals, &places, &kernels, sampling,
    )?;

    println!("{} averages", set.rows.len());
    for wavelength in [0.16, 0.08, 0.04, 0.02, 0.01] {
        let field: Vec<f64> = positions
            .iter()
            .map(|p| (TAU * p.x / wavelength).sin())
            .collect();
        let largest = set
            .averages(&field)
            .into_iter()
            .map(f64::abs)
            .fold(0.0, f64::max);
        println!(
            "a wave of {:3.0} mm is seen at {:5.1} %",
            1e3 * wavelength,
            1e2 * largest
        );
    }
    Ok(())
}
