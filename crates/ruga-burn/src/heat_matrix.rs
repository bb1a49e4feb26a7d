//! The implicit heat equation of one substep.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{MatMut, Side};

/// Iterations after which a factor of an earlier matrix is no longer worth keeping: a back-substitution
/// takes about a tenth of the time of a factorisation.
const MOST_ITERATIONS: u32 = 8;
/// Residual at which the heat equation counts as solved, as a share of the right-hand side. Temperatures are
/// then right to a hundred-millionth of a kelvin; that heat balances is seen to apart.
const TOLERANCE: f64 = 1e-13;
/// Residual that rounding of the temperatures alone makes, as a share of the matrix' diagonal times them. In
/// stiff steps it is more than [`TOLERANCE`].
const ROUNDING: f64 = 2e-15;
/// Imbalance of heat that is not worth mending, as a share of the whole.
const BALANCED: f64 = 1e-15;

/// The matrix `D + G` of capacities and losses `D` and conductances `G`, with a factor of it or of an
/// earlier one.
pub(crate) struct HeatMatrix {
    diagonal: Vec<f64>,
    ends: Vec<[u32; 2]>,
    conductances: Vec<f64>,
    symbolic: SymbolicLlt<usize>,
    factor: Llt<usize, f64>,
}

/// Work done for one solution.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SolveWork {
    pub(crate) iterations: u32,
    pub(crate) factorisations: u32,
}

impl HeatMatrix {
    /// Assembles and factorises; none where the matrix is not positive definite in floating point.
    pub(crate) fn new(
        diagonal: Vec<f64>,
        ends: Vec<[u32; 2]>,
        conductances: Vec<f64>,
    ) -> Option<Self> {
        let lower = lower_triangle(&diagonal, &ends, &conductances)?;
        let symbolic = SymbolicLlt::try_new(lower.symbolic(), Side::Lower).ok()?;
        let factor =
            Llt::try_new_with_symbolic(symbolic.clone(), lower.as_ref(), Side::Lower).ok()?;
        Some(Self {
            diagonal,
            ends,
            conductances,
            symbolic,
            factor,
        })
    }

    /// Replaces the conductances; the factor stays as a preconditioner.
    pub(crate) fn set_conductances(&mut self, conductances: Vec<f64>) {
        self.conductances = conductances;
    }

    /// Solves for `x`, starting from what it holds and leaving that where rounding prevents a solution.
    ///
    /// Conjugate gradients with the factor as preconditioner: with a factor of this very matrix one
    /// iteration is the back-substitution, and a second one, where the step is stiff, its refinement. From
    /// the difference to the old temperatures on, so that an even temperature stays even to the last digit.
    pub(crate) fn solve(&mut self, right: &[f64], x: &mut [f64]) -> Option<SolveWork> {
        let mut work = SolveWork::default();
        let mut solution = x.to_vec();
        if !self.iterate(right, &mut solution, &mut work.iterations) {
            let lower = lower_triangle(&self.diagonal, &self.ends, &self.conductances)?;
            let symbolic = self.symbolic.clone();
            self.factor = Llt::try_new_with_symbolic(symbolic, lower.as_ref(), Side::Lower).ok()?;
            work.factorisations = 1;
            solution.copy_from_slice(x);
            if !self.iterate(right, &mut solution, &mut work.iterations) {
                return None;
            }
        }
        self.balance(right, &mut solution);
        x.copy_from_slice(&solution);
        Some(work)
    }

    /// Iterates to the tolerance; false if that takes too long.
    fn iterate(&self, right: &[f64], x: &mut [f64], iterations: &mut u32) -> bool {
        let enough = TOLERANCE * dot(right, right).sqrt() + ROUNDING * self.diagonal_norm(x);
        if !enough.is_finite() {
            return false;
        }
        let mut residual = self.times(x);
        for (r, b) in residual.iter_mut().zip(right) {
            *r = b - *r;
        }
        let (mut direction, mut last) = (Vec::new(), 0.0);
        for iteration in 0..=MOST_ITERATIONS {
            let left = dot(&residual, &residual).sqrt();
            if left <= enough || iteration == MOST_ITERATIONS || left.is_nan() {
                return left <= enough;
            }
            *iterations += 1;
            let mut preconditioned = residual.clone();
            let size = preconditioned.len();
            let column = MatMut::from_column_major_slice_mut(&mut preconditioned, size, 1);
            self.factor.solve_in_place(column);
            let now = dot(&residual, &preconditioned);
            if iteration > 0 {
                add(&mut preconditioned, now / last, &direction);
            }
            (direction, last) = (preconditioned, now);
            let image = self.times(&direction);
            let way = now / dot(&direction, &image);
            add(x, way, &direction);
            add(&mut residual, -way, &image);
        }
        false
    }

    /// Shifts all temperatures so that none of the heat is lost: flows cancel, so that `D x` must sum to the
    /// right-hand side. In steps so stiff that one evens out the sheet, rounding of the flows hides this sum.
    fn balance(&self, right: &[f64], x: &mut [f64]) {
        let whole: f64 = right.iter().sum();
        let capacity: f64 = self.diagonal.iter().sum();
        let excess = whole - dot(&self.diagonal, x);
        if excess.abs() > BALANCED * whole.abs() {
            x.iter_mut().for_each(|x| *x += excess / capacity);
        }
    }

    /// Norm of the diagonal times a vector.
    fn diagonal_norm(&self, x: &[f64]) -> f64 {
        let mut sums = self.diagonal.clone();
        for (ends, conductance) in self.ends.iter().zip(&self.conductances) {
            ends.iter().for_each(|&v| sums[v as usize] += conductance);
        }
        let terms = sums.iter().zip(x).map(|(sum, x)| (sum * x).powi(2));
        terms.sum::<f64>().sqrt()
    }

    /// The matrix times a vector; flows along edges are equal and opposite, so that none is lost.
    fn times(&self, x: &[f64]) -> Vec<f64> {
        let diagonal = self.diagonal.iter().zip(x);
        let mut image: Vec<f64> = diagonal.map(|(d, x)| d * x).collect();
        for (&[a, b], conductance) in self.ends.iter().zip(&self.conductances) {
            let (a, b) = (a as usize, b as usize);
            let flow = conductance * (x[a] - x[b]);
            image[a] += flow;
            image[b] -= flow;
        }
        image
    }
}

fn lower_triangle(
    diagonal: &[f64],
    ends: &[[u32; 2]],
    conductances: &[f64],
) -> Option<SparseColMat<usize, f64>> {
    let mut sums = diagonal.to_vec();
    let mut entries = Vec::with_capacity(ends.len() + sums.len());
    for (&[a, b], &conductance) in ends.iter().zip(conductances) {
        let (a, b) = (a as usize, b as usize);
        sums[a] += conductance;
        sums[b] += conductance;
        entries.push(Triplet::new(a.max(b), a.min(b), -conductance));
    }
    let sums = sums.into_iter().enumerate();
    entries.extend(sums.map(|(v, sum)| Triplet::new(v, v, sum)));
    SparseColMat::try_new_from_triplets(diagonal.len(), diagonal.len(), &entries).ok()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    for (to, what) in to.iter_mut().zip(what) {
        *to += factor * what;
    }
}
