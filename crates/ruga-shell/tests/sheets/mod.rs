//! Flat rectangular sheets of any triangle, and the equilibrium of a layer under dead loads.
#![allow(dead_code, reason = "each test file uses its own part")]

use faer::MatMut;
use faer::Side;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use nalgebra::Vector3;
use ruga_shell::LayerEnergy;

use crate::meshes::{Mesh, rng, symmetric};

/// Columns of vertices at `start + k dx` along x, staggered by half of `dy`, with straight edges at
/// 0 and `rows dy`. Inner vertices move by up to `jitter` of the spacings.
pub(crate) struct Sheet {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) dx: f64,
    pub(crate) dy: f64,
    pub(crate) start: f64,
    pub(crate) jitter: f64,
}

impl Sheet {
    pub(crate) fn mesh(&self, seed: u64) -> Mesh {
        let mut rng = rng(seed);
        let mut lattice = Vec::new();
        for column in 0..=self.columns {
            for k in 0..=self.rows + column % 2 {
                let y = if column % 2 == 0 {
                    k as f64
                } else {
                    (k as f64 - 0.5).clamp(0.0, self.rows as f64)
                };
                // The first columns stay where a clamp has to be.
                let inner = column > 2 && column < self.columns && y > 0.0 && y < self.rows as f64;
                let by = if inner { self.jitter } else { 0.0 };
                let shift = [symmetric(&mut rng), symmetric(&mut rng)].map(|s| by * s);
                lattice.push([column as f64 + shift[0], y + shift[1]]);
            }
        }
        let points: Vec<_> = lattice
            .iter()
            .map(|&[x, y]| delaunator::Point {
                x: x * 0.75_f64.sqrt(),
                y,
            })
            .collect();
        let triangles = delaunator::triangulate(&points).triangles;
        let area = |t: &[usize]| {
            let [a, b, c] = [0, 1, 2].map(|k| lattice[t[k]]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        Mesh {
            faces: triangles
                .chunks_exact(3)
                // Rounding can leave a flat triangle on a straight edge.
                .filter(|t| area(t).abs() > 1e-9)
                .map(|t| [t[0] as u32, t[2] as u32, t[1] as u32])
                .collect(),
            positions: lattice
                .iter()
                .map(|&[x, y]| Vector3::new(self.start + x * self.dx, y * self.dy, 0.0))
                .collect(),
        }
    }
}

/// Forces on vertices, of the free coordinates.
pub(crate) fn free_forces(layer: &LayerEnergy, force: &[Vector3<f64>]) -> Vec<f64> {
    let free = layer.free_vertices().iter();
    free.flat_map(|&v| force[v as usize].iter().copied().collect::<Vec<_>>())
        .collect()
}

/// Factor of the exact Hessian at `x`, if it is positive definite.
pub(crate) fn factor(layer: &LayerEnergy, x: &[Vector3<f64>]) -> Option<Llt<usize, f64>> {
    let mut exact = vec![0.0; layer.pattern().1.len()];
    layer.hessian(x, &mut exact, None);
    factor_values(layer, &exact)
}

fn factor_relaxed(layer: &LayerEnergy, x: &[Vector3<f64>]) -> Option<Llt<usize, f64>> {
    let mut exact = vec![0.0; layer.pattern().1.len()];
    let mut relaxed = exact.clone();
    layer.hessian(x, &mut exact, Some(&mut relaxed));
    factor_values(layer, &relaxed)
}

fn factor_values(layer: &LayerEnergy, values: &[f64]) -> Option<Llt<usize, f64>> {
    let (starts, rows) = layer.pattern();
    let size = layer.dof_count();
    let mut entries = Vec::with_capacity(rows.len());
    for column in 0..size {
        let range = starts[column]..starts[column + 1];
        entries.extend(range.map(|k| Triplet::new(rows[k] as usize, column, values[k])));
    }
    SparseColMat::try_new_from_triplets(size, size, &entries)
        .expect("a valid pattern")
        .sp_cholesky(Side::Lower)
        .ok()
}

/// The free coordinates' solution for a right-hand side.
pub(crate) fn solve(factor: &Llt<usize, f64>, mut right: Vec<f64>) -> Vec<f64> {
    let size = right.len();
    factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut right, size, 1));
    right
}

/// `x` with the free vertices moved by `scale` times a step.
pub(crate) fn moved(
    layer: &LayerEnergy,
    x: &[Vector3<f64>],
    step: &[f64],
    scale: f64,
) -> Vec<Vector3<f64>> {
    let mut y = x.to_vec();
    for (&v, step) in layer.free_vertices().iter().zip(step.chunks_exact(3)) {
        y[v as usize] += Vector3::new(step[0], step[1], step[2]) * scale;
    }
    y
}

/// Minimises energy less work by Newton steps with halving; panics if that does not settle.
pub(crate) fn equilibrium(
    layer: &LayerEnergy,
    mut x: Vec<Vector3<f64>>,
    force: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let dead = free_forces(layer, force);
    let potential = |x: &[Vector3<f64>]| {
        layer.value(x) - x.iter().zip(force).map(|(x, f)| x.dot(f)).sum::<f64>()
    };
    let norm = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let mut gradient = vec![0.0; layer.dof_count()];
    for _ in 0..100 {
        layer.gradient(&x, &mut gradient);
        let residual: Vec<_> = dead.iter().zip(&gradient).map(|(f, g)| f - g).collect();
        // The membrane is a million times as stiff as bending: this is as far as rounding lets it.
        if norm(&residual) < 1e-5 * norm(&dead) {
            return x;
        }
        let factor = factor(layer, &x)
            .or_else(|| factor_relaxed(layer, &x))
            .expect("bending and membrane hold every free vertex");
        let step = solve(&factor, residual.clone());
        let slope: f64 = step.iter().zip(&residual).map(|(s, r)| s * r).sum();
        let start = potential(&x);
        let mut scale = 1.0;
        let goal = |scale: f64| start - 1e-4 * scale * slope + 1e-13 * start.abs();
        while scale > 1e-6 && potential(&moved(layer, &x, &step, scale)) > goal(scale) {
            scale *= 0.5;
        }
        x = moved(layer, &x, &step, scale);
    }
    panic!("no equilibrium");
}
