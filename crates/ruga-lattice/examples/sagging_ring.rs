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

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{MatMut, Side};
use nalgebra::Vector3;
use ruga_lattice::{Embedding, Lattice, LatticeEnergy, LatticeSpec, SolidMaterial};
use ruga_mesh::{MeshError, TriMesh};

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

    let mut q = lattice.rest_positions().to_vec();
    sag(&energy, &weights, &mut q)?;

    let surface = Embedding::of_vertices(&lattice)?;
    let positions = surface.positions(&q);
    let lowest = positions.iter().map(|p| p.z).fold(0.0, f64::min);
    eprintln!("lowest point {:.1} mm below the middle", -1e3 * lowest);
    write_obj(&mesh, &positions, &surface.normals(&q));
    Ok(())
}

/// Newton's method on elastic energy and weight, with a line search.
fn sag(
    energy: &LatticeEnergy,
    weights: &[Vector3<f64>],
    q: &mut [Vector3<f64>],
) -> Result<(), Box<dyn Error>> {
    let load = energy.unknowns(weights);
    let work = |x: &[f64]| load.iter().zip(x).map(|(f, x)| f * x).sum::<f64>();
    let total: f64 = weights.iter().map(Vector3::norm).sum();
    for round in 0..50 {
        let mut gradient = vec![0.0; energy.dof_count()];
        energy.gradient(q, &mut gradient);
        gradient.iter_mut().zip(&load).for_each(|(g, f)| *g -= f);
        let residual = gradient.iter().fold(0.0_f64, |a, g| a.max(g.abs()));
        let start = energy.unknowns(q);
        let before = energy.value(q) - work(&start);
        eprintln!(
            "round {round}: energy {before:.6e} J, residual {:.1e} of the weight",
            residual / total
        );
        if residual < 1e-9 * total {
            break;
        }
        let step = newton_step(energy, q, &gradient)?;
        let mut share = 1.0;
        while share > 1e-9 {
            let moved: Vec<f64> = start
                .iter()
                .zip(&step)
                .map(|(x, p)| x + share * p)
                .collect();
            energy.set_unknowns(&moved, q);
            if energy.value(q) - work(&moved) <= before {
                break;
            }
            share *= 0.5;
        }
    }
    Ok(())
}

/// With the exact Hessian where it is positive definite, and the relaxed one elsewhere.
fn newton_step(
    energy: &LatticeEnergy,
    q: &[Vector3<f64>],
    gradient: &[f64],
) -> Result<Vec<f64>, Box<dyn Error>> {
    let (starts, rows) = energy.pattern();
    let (mut exact, mut relaxed) = (vec![0.0; rows.len()], vec![0.0; rows.len()]);
    energy.hessian(q, &mut exact, Some(&mut relaxed));
    let size = energy.dof_count();
    let factorise = |values: &[f64]| {
        let mut entries = Vec::with_capacity(rows.len());
        for column in 0..size {
            let range = starts[column]..starts[column + 1];
            entries.extend(range.map(|k| Triplet::new(rows[k], column, values[k])));
        }
        SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries)
            .ok()
            .and_then(|matrix| matrix.sp_cholesky(Side::Lower).ok())
    };
    let factors = factorise(&exact).or_else(|| factorise(&relaxed));
    let factors = factors.ok_or("the lattice is not held")?;
    let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
    factors.solve_in_place(MatMut::from_column_major_slice_mut(&mut step, size, 1));
    Ok(step)
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
