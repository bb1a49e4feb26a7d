//! Subdivides an octahedron and says how round it gets.
//!
//! `cargo run --release -p ruga-mesh --example smooth_ball`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use nalgebra::Vector3;
use ruga_mesh::{MeshError, PerVertex, TriMesh, limit_rows, subdivide};

fn main() -> Result<(), MeshError> {
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let control = [x, -x, y, -y, z, -z];
    let upper = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let lower = [[2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mesh = TriMesh::new(6, [upper, lower].concat())?;
    println!("level   faces   smallest and largest radius");
    for level in 0..=5 {
        let fine = subdivide(&mesh, level, &PerVertex::filled(6, false));
        let control = fine.fine_from_coarse.apply(&control);
        let limit = limit_rows(&fine.mesh, &fine.corners)
            .position
            .apply(&control);
        let radii = limit.iter().map(Vector3::norm);
        let (low, high) = radii.fold((f64::MAX, 0.0_f64), |(l, h), r| (l.min(r), h.max(r)));
        println!(
            "{level:5} {:7}   {low:.4} {high:.4}",
            fine.mesh.face_count()
        );
    }
    Ok(())
}
