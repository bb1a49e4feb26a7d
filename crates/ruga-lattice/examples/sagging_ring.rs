//! A ring of soft foam, held at one side, sags under its own weight. Writes the surface as OBJ to
//! standard output, and what was solved to standard error.
//!
//! `cargo run -p ruga-lattice --example sagging_ring > ring.obj`
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example's output is what it shows"
)]

use std::error::Error;
use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_lattice::{
    Embedding, Lattice, LatticeEnergy, LatticeObjective, LatticeSpec, SolidMaterial,
};
use ruga_mesh::{MeshError, TriMesh};
use ruga_solver::{ConstraintRows, Kkt, NewtonSettings, Objective, minimise};

/// Radii of the ring and of its tube, m.
const RING: f64 = 0.2;
const TUBE: f64 = 0.05;

const FOAM: SolidMaterial = SolidMaterial {
    young: 1e5,
    poisson: 0.3,
};
/// kg/m³.
const DENSITY: f64 = 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, rest) = ring(96, 32)?;
    let spec = LatticeSpec {
        cells: 8,
        ..LatticeSpec::default()
    };
    let lattice = Lattice::build(&mesh, &rest, &spec)?;
    let pinned: Vec<bool> = (lattice.rest_positions().iter())
        .map(|node| node.x < -RING)
        .collect();
    let energy = LatticeEnergy::new(&lattice, &FOAM, &pinned)?;
    let weights = lattice.gravity_load(DENSITY, &Vector3::new(0.0, 0.0, -9.81))?;
    eprintln!(
        "{} faces, {} elements, {} degrees of freedom, {:.3} kg",
        mesh.face_count(),
        lattice.element_count(),
        energy.dof_count(),
        lattice.volume() * DENSITY
    );

    let objective = LatticeObjective::new(&energy, lattice.rest_positions(), &weights, TUBE)?;
    let unheld = ConstraintRows::none(energy.dof_count());
    let mut kkt = Kkt::new(objective.pattern(), &unheld, 3)?;
    let mut x = energy.unknowns(lattice.rest_positions());
    let settings = NewtonSettings::default();
    let report = minimise(&objective, &[], &mut x, &mut kkt, &settings, &mut |_| true)?;
    eprintln!(
        "{} iterations, residual {:.1e} of the weight of a node",
        report.iterations, report.residual
    );
    let q = objective.nodes(&x);

    let surface = Embedding::of_vertices(&lattice)?;
    let positions = surface.positions(&q);
    let lowest = positions.iter().map(|p| p.z).fold(0.0, f64::min);
    eprintln!("lowest point {:.1} mm below the middle", -1e3 * lowest);
    write_obj(&mesh, &positions, &surface.normals(&q));
    Ok(())
}

/// A torus around z.
fn ring(around: u32, across: u32) -> Result<(TriMesh, Vec<Vector3<f64>>), MeshError> {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            let [a, b] = [(i, around), (j, across)].map(|(k, n)| TAU * f64::from(k) / f64::from(n));
            let radius = RING + TUBE * b.cos();
            positions.push(Vector3::new(
                radius * a.cos(),
                radius * a.sin(),
                TUBE * b.sin(),
            ));
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[p, q, r], [p, r, s]]);
        }
    }
    Ok((TriMesh::new(positions.len(), faces)?, positions))
}

fn write_obj(mesh: &TriMesh, positions: &[Vector3<f64>], normals: &[Vector3<f64>]) {
    for p in positions {
        println!("v {} {} {}", p.x, p.y, p.z);
    }
    for n in normals {
        println!("vn {} {} {}", n.x, n.y, n.z);
    }
    for (_, face) in mesh.faces().iter() {
        let [a, b, c] = face.map(|v| v.0 + 1);
        println!("f {a}//{a} {b}//{b} {c}//{c}");
    }
}
