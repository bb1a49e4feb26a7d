//! A plain Newton solver, and springs that hold points of a lattice.
#![allow(dead_code, reason = "each test file uses its own part")]

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{MatMut, Side};
use nalgebra::Vector3;
use ruga_lattice::{Embedding, LatticeEnergy};

/// Springs of one stiffness (N/m) that pull embedded points towards targets.
pub(crate) struct Springs {
    pub(crate) points: Embedding,
    pub(crate) targets: Vec<Vector3<f64>>,
    pub(crate) stiffness: f64,
}

/// Elastic energy, springs and a constant force on every node; no node pinned.
pub(crate) struct Problem {
    pub(crate) energy: LatticeEnergy,
    pub(crate) springs: Vec<Springs>,
    pub(crate) forces: Vec<Vector3<f64>>,
    /// Added to the diagonal of the Hessian, N/m.
    pub(crate) floor: f64,
}

impl Problem {
    pub(crate) fn value(&self, q: &[Vector3<f64>]) -> f64 {
        let work: f64 = self.forces.iter().zip(q).map(|(f, q)| f.dot(q)).sum();
        let springs = self.springs.iter().map(|springs| {
            let pulls = springs.pulls(q);
            0.5 * springs.stiffness * pulls.iter().map(Vector3::norm_squared).sum::<f64>()
        });
        self.energy.value(q) + springs.sum::<f64>() - work
    }

    pub(crate) fn gradient(&self, q: &[Vector3<f64>]) -> Vec<f64> {
        let mut gradient = vec![0.0; self.energy.dof_count()];
        self.energy.gradient(q, &mut gradient);
        let mut add = |forces: &[Vector3<f64>], factor: f64| {
            for (g, f) in gradient.iter_mut().zip(forces.iter().flatten()) {
                *g += factor * f;
            }
        };
        add(&self.forces, -1.0);
        for springs in &self.springs {
            add(
                &springs.points.pull_back(&springs.pulls(q)),
                springs.stiffness,
            );
        }
        gradient
    }

    /// Solves the relaxed Newton system for a step.
    pub(crate) fn step(&self, q: &[Vector3<f64>], gradient: &[f64]) -> Vec<f64> {
        let mut exact = vec![0.0; self.energy.pattern().1.len()];
        let mut relaxed = exact.clone();
        self.energy.hessian(q, &mut exact, Some(&mut relaxed));
        let (starts, rows) = self.energy.pattern();
        let size = self.energy.dof_count();
        let mut entries = Vec::new();
        for column in 0..size {
            entries.push(Triplet::new(column, column, self.floor));
            for k in starts[column]..starts[column + 1] {
                entries.push(Triplet::new(rows[k] as usize, column, relaxed[k]));
            }
        }
        for springs in &self.springs {
            springs.add_stiffness(&mut entries);
        }
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries)
            .expect("entries within the matrix");
        let factors = matrix.sp_cholesky(Side::Lower).expect("positive definite");
        let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
        factors.solve_in_place(MatMut::from_column_major_slice_mut(&mut step, size, 1));
        step
    }

    /// Newton steps with a line search on energy until the gradient is below `force` (N); how many
    /// it took, `None` when `limit` did not do.
    pub(crate) fn minimise(
        &self,
        q: &mut [Vector3<f64>],
        force: f64,
        limit: usize,
    ) -> Option<usize> {
        for iteration in 0..limit {
            let gradient = self.gradient(q);
            if gradient.iter().all(|g| g.abs() < force) {
                return Some(iteration);
            }
            let step = self.step(q, &gradient);
            let slope: f64 = gradient.iter().zip(&step).map(|(g, p)| g * p).sum();
            let (start, before) = (self.energy.unknowns(q), self.value(q));
            let mut share = 1.0;
            while share > 1e-12 {
                let moved: Vec<f64> = start
                    .iter()
                    .zip(&step)
                    .map(|(x, p)| x + share * p)
                    .collect();
                self.energy.set_unknowns(&moved, q);
                // Rounding of the energy must not stop the last steps.
                if self.value(q) <= before + 1e-4 * share * slope + 1e-15 * before.abs() {
                    break;
                }
                share *= 0.5;
            }
        }
        None
    }
}

impl Springs {
    fn pulls(&self, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let positions = self.points.positions(q);
        positions
            .iter()
            .zip(&self.targets)
            .map(|(x, t)| x - t)
            .collect()
    }

    fn add_stiffness(&self, entries: &mut Vec<Triplet<usize, usize, f64>>) {
        for point in 0..self.points.point_count() {
            let row: Vec<(u32, f64)> = self.points.rows().row(point).collect();
            for &(i, a) in &row {
                for &(j, b) in row.iter().filter(|other| other.0 <= i) {
                    for k in 0..3 {
                        let value = self.stiffness * a * b;
                        entries.push(Triplet::new(3 * i as usize + k, 3 * j as usize + k, value));
                    }
                }
            }
        }
    }
}
