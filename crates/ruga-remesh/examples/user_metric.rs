//! Refines a mesh to a user's metric, without any physics: a square with fine, elongated
//! triangles along a circle. Writes the result as OBJ to standard output.
//!
//! `cargo run -p ruga-remesh --example user_metric > circle.obj`
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example's output is what it shows"
)]

use std::error::Error;

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{MaterialPoint, PerEdge, TriMesh};
use ruga_remesh::{
    PolyhedralSurface, RemeshSettings, SizeLimits, SurfaceMesh, remesh_to_metric, size_tensor,
};

/// Side of the square and radius of the circle, m.
const SIDE: f64 = 0.1;
const RADIUS: f64 = 0.03;

fn main() -> Result<(), Box<dyn Error>> {
    let base = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
    let corners = [[0.0, 0.0], [SIDE, 0.0], [SIDE, SIDE], [0.0, SIDE]];
    let positions = corners.map(|[x, y]| Vector3::new(x, y, 0.0));
    let seams = PerEdge::filled(base.edges().len(), false);
    let surface = PolyhedralSurface::new(&base, &positions, &seams)?;
    let mesh = SurfaceMesh::on_surface(base.clone(), surface.vertex_points()?, &surface)?;
    let settings = RemeshSettings {
        limits: SizeLimits {
            min_edge: 0.5e-3,
            max_edge: 8e-3,
            aspect: 3.0,
            ..SizeLimits::default()
        },
        ..RemeshSettings::default()
    };
    let metric = |_: MaterialPoint, p| circle_metric(p);
    let remeshed = remesh_to_metric(&mesh, &metric, &surface, &settings)?;
    eprintln!(
        "{} faces, {:.1} % of edges within 0.5 to 1.5 of the wanted length",
        remeshed.mesh.mesh.face_count(),
        100.0 * remeshed.report.share_met()
    );
    write_obj(&remeshed.mesh);
    Ok(())
}

/// Across the circle edges of 1 mm on it, growing with the distance; three times that along it.
fn circle_metric(p: Vector3<f64>) -> Matrix3<f64> {
    let radial = p - Vector3::new(SIDE / 2.0, SIDE / 2.0, 0.0);
    let across = 1e-3 + 0.3 * (radial.norm() - RADIUS).abs();
    // The centre has no radial direction.
    size_tensor(Vector3::z(), radial, across, 3.0 * across)
        .unwrap_or_else(|_| Matrix3::identity() / (across * across))
}

fn write_obj(mesh: &SurfaceMesh) {
    for (_, p) in mesh.positions.iter() {
        println!("v {} {} {}", p.x, p.y, p.z);
    }
    for (_, face) in mesh.mesh.faces().iter() {
        let [a, b, c] = face.map(|v| v.0 + 1);
        println!("f {a} {b} {c}");
    }
}
