//! The largest eigenvalue of a pencil of two sparse matrices.

use faer::MatMut;
use faer::linalg::solvers::Solve;
use faer::sparse::SparseColMat;
use faer::sparse::linalg::solvers::Llt;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Share of a new direction outside the space so far at which that is as good as whole: a coarse
/// mesh has few modes.
const EXHAUSTED: f64 = 1e-12;

/// Relative change of the critical force, over [`CHECK_EVERY`] Lanczos steps, at which it is
/// accepted.
const FORCE_TOLERANCE: f64 = 1e-6;
// Each check solves a dense eigenproblem, whose cost grows with the cube of the steps.
const CHECK_EVERY: usize = 5;
/// Ten wavelengths square need 75 steps, and the number grows with the side.
const MAX_STEPS: usize = 300;

/// The largest eigenvalue, its vector, and the steps that it took.
pub(super) struct Extreme {
    pub(super) eigenvalue: f64,
    pub(super) vector: Vec<f64>,
    pub(super) steps: usize,
    pub(super) converged: bool,
}

/// Largest eigenvalue of `stiffness^-1 load` by Lanczos in the inner product of the stiffness.
pub(super) fn largest_eigenvalue(
    factor: &Llt<usize, f64>,
    load: &SparseColMat<usize, f64>,
) -> Option<Extreme> {
    let mut basis = Lanczos::default();
    let mut image = starting_vector(load.ncols());
    let (mut eigenvalue, mut converged) = (0.0, false);
    while !converged && basis.alphas.len() < MAX_STEPS {
        if !basis.extend(factor, image) {
            // The space is exhausted: what has been found is exact.
            converged = true;
            break;
        }
        image = basis.apply(load);
        if basis.alphas.len().is_multiple_of(CHECK_EVERY) {
            let last = std::mem::replace(&mut eigenvalue, basis.top()?.0);
            converged = (eigenvalue - last).abs() <= FORCE_TOLERANCE * eigenvalue;
        }
    }
    let (eigenvalue, weights) = basis.top()?;
    let mut vector = vec![0.0; load.ncols()];
    for (v, weight) in basis.vectors.iter().zip(weights) {
        axpy(&mut vector, weight, v);
    }
    (eigenvalue > 0.0 && eigenvalue.is_finite()).then_some(Extreme {
        eigenvalue,
        vector,
        steps: basis.alphas.len(),
        converged,
    })
}

/// Vectors `v_i` with `v_i^T A v_j = delta_ij`, and the images `A v_i`, which come free of charge
/// because each `v_i` is the solution of `A v = image`.
#[derive(Default)]
struct Lanczos {
    vectors: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    alphas: Vec<f64>,
    betas: Vec<f64>,
}

impl Lanczos {
    /// Adds the direction `A^-1 image`, as far as it is new; false if it lies in the space already.
    ///
    /// Full reorthogonalisation, twice: the basis is short, and ghost eigenvalues would spoil the
    /// convergence test.
    fn extend(&mut self, factor: &Llt<usize, f64>, mut image: Vec<f64>) -> bool {
        let whole = dot(&image, &image);
        for _ in 0..2 {
            for (v, av) in self.vectors.iter().zip(&self.images) {
                let overlap = dot(&image, v);
                axpy(&mut image, -overlap, av);
            }
        }
        if dot(&image, &image) <= EXHAUSTED * EXHAUSTED * whole {
            return false;
        }
        // Solved for last: what cancellation leaves of an earlier solution is not the solution of what
        // it leaves of the image, and some moduli came out a thousand times too small.
        let mut vector = image.clone();
        let size = vector.len();
        factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut vector, size, 1));
        // The norm is that of the stiffness; the image saves multiplying by the matrix.
        let norm = dot(&vector, &image).sqrt();
        if norm.is_nan() || norm == 0.0 {
            return false;
        }
        if !self.vectors.is_empty() {
            self.betas.push(norm);
        }
        vector.iter_mut().for_each(|v| *v /= norm);
        image.iter_mut().for_each(|v| *v /= norm);
        self.vectors.push(vector);
        self.images.push(image);
        true
    }

    /// `load` times the newest vector.
    fn apply(&mut self, load: &SparseColMat<usize, f64>) -> Vec<f64> {
        let Some(vector) = self.vectors.last() else {
            return Vec::new();
        };
        let product = multiply(load, vector);
        self.alphas.push(dot(vector, &product));
        product
    }

    /// Largest eigenvalue in the space and its coordinates.
    fn top(&self) -> Option<(f64, Vec<f64>)> {
        let size = self.alphas.len();
        if size == 0 {
            return None;
        }
        let mut matrix = DMatrix::from_diagonal(&DVector::from_column_slice(&self.alphas));
        for i in 1..size {
            matrix[(i, i - 1)] = self.betas[i - 1];
            matrix[(i - 1, i)] = self.betas[i - 1];
        }
        let eigen = SymmetricEigen::new(matrix);
        let top = eigen.eigenvalues.imax();
        let weights = eigen.eigenvectors.column(top).iter().copied().collect();
        Some((eigen.eigenvalues[top], weights))
    }
}

/// Deterministic and without symmetry, so that it overlaps every mode.
fn starting_vector(size: usize) -> Vec<f64> {
    let golden = 0.618_033_988_749_894_9;
    (0..size)
        .map(|i| ((i + 1) as f64 * golden).fract() - 0.5)
        .collect()
}

fn multiply(matrix: &SparseColMat<usize, f64>, vector: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; vector.len()];
    for (column, &value) in vector.iter().enumerate() {
        let entries = matrix.row_idx_of_col(column).zip(matrix.val_of_col(column));
        for (row, entry) in entries {
            product[row] += entry * value;
        }
    }
    product
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // One sum would wait for each of its additions.
    let mut sums = [0.0; 8];
    let ((first, first_left), (second, second_left)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in first.iter().zip(second) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let left = first_left.iter().zip(second_left).map(|(a, b)| a * b);
    sums.iter().sum::<f64>() + left.sum::<f64>()
}

fn axpy(target: &mut [f64], scale: f64, source: &[f64]) {
    for (target, source) in target.iter_mut().zip(source) {
        *target += scale * source;
    }
}
