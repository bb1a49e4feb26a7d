//! Stretches a strip of skin and lists energy and force.
//!
//! `cargo run --release -p ruga-shell --example stretched_strip`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use nalgebra::Vector3;
use ruga_mesh::TriMesh;
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 40 mm long and 10 mm wide, in cells of 10 mm; the left end is held.
    let place = |i: u32| Vector3::new(f64::from(i % 5), f64::from(i / 5), 0.0) * 0.01;
    let rest: Vec<Vector3<f64>> = (0..10).map(place).collect();
    let faces = (0..4).flat_map(|a| [[a, a + 1, a + 6], [a, a + 6, a + 5]]);
    let mesh = TriMesh::new(rest.len(), faces.collect())?;
    let skin = FaceParameters {
        young: 4e6,
        poisson: 0.3,
        thickness: 1e-3,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let parameters = LayerParameters::uniform(skin, mesh.face_count(), 0.0, rest.len());
    let held: Vec<bool> = rest.iter().map(|p| p.x == 0.0).collect();
    let layer = LayerEnergy::new(&mesh, &rest, parameters, &held)?;
    println!("stretch    energy     force");
    for percent in [-10, -5, 0, 5, 10] {
        let stretch = 1.0 + f64::from(percent) / 100.0;
        let x: Vec<_> = (rest.iter())
            .map(|p| Vector3::new(stretch * p.x, p.y, p.z))
            .collect();
        let mut gradient = vec![0.0; layer.dof_count()];
        layer.gradient(&x, &mut gradient);
        let ends = layer.free_vertices().iter().zip(gradient.chunks(3));
        let force: f64 = ends
            .filter(|(vertex, _)| *vertex % 5 == 4)
            .map(|(_, along)| along[0])
            .sum();
        println!(
            "{percent:+5} % {:7.3} mJ {force:7.3} N",
            1e3 * layer.value(&x)
        );
    }
    Ok(())
}
