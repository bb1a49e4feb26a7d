//! Methods of the papers that ruga is compared with: MINRES in place of a factorisation, Newton's
//! method on the norm of the forces in place of the energy, and rows from
//! eigenfunctions of the surface ([`global_rows`]) or adjusted as printed ([`adjusted_as_printed`]) in
//! place of the product's averages.
//!
//! The first two solve what [`ruga_solver::minimise`] solves. The functions of its signature,
//! [`by_minres`], [`by_residual`] and [`by_residual_and_minres`], take its place in
//! [`Modelling::minimise`](ruga_stepper::Modelling::minimise).

mod backtracking;
mod global_rows;
mod iterated_newton;
mod minres;
mod printed_adjustment;
mod residual_descent;

pub use global_rows::{global_rows, lowest_eigenfunctions};
pub use iterated_newton::minimise_iterated;
pub use printed_adjustment::adjusted_as_printed;
pub use residual_descent::descend_residual;

use ruga_solver::{
    ConstraintRows, Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError, StopRule,
};

/// Solver of the linear system of a Newton step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinearSolver {
    /// The product's factorisation.
    Ldlt,
    /// MINRES, preconditioned with the diagonal blocks of `K` and `H G^-1 H'`.
    Minres(MinresLimits),
}

impl LinearSolver {
    /// MINRES with its usual limits.
    pub fn minres() -> Self {
        Self::Minres(MinresLimits::default())
    }
}

/// Where MINRES stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinresLimits {
    /// Relative preconditioned residual, in (0, 1).
    pub tolerance: f64,
    /// Iterations of one linear solve after which it counts as stalled.
    pub max_iterations: usize,
}

impl Default for MinresLimits {
    /// A residual of 1e-8 in at most 2000 iterations.
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            max_iterations: 2000,
        }
    }
}

/// Work of MINRES in one solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearWork {
    /// Iterations, all linear systems together.
    pub iterations: usize,
    /// Linear systems in which MINRES missed its tolerance.
    pub stalls: usize,
}

impl LinearWork {
    fn add(&mut self, outcome: &minres::MinresOutcome) {
        self.iterations += outcome.iterations;
        self.stalls += usize::from(!outcome.converged);
    }
}

/// A problem that [`ruga_solver::minimise`] could be given: an energy, and rows with their targets.
pub struct Problem<'a> {
    /// The energy.
    pub objective: &'a dyn Objective,
    /// What the rows of `kkt` are to be, m.
    pub rhs: &'a [f64],
    /// Pattern and rows, with a factorisation of them.
    pub kkt: &'a mut Kkt,
}

/// [`minimise_iterated`] in the place of [`ruga_solver::minimise`].
///
/// # Errors
/// As [`ruga_solver::minimise`].
pub fn by_minres(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let problem = Problem {
        objective,
        rhs,
        kkt,
    };
    let limits = MinresLimits::default();
    Ok(minimise_iterated(problem, x, settings, limits, keep_going)?.0)
}

/// [`descend_residual`] with a factorisation in the place of [`ruga_solver::minimise`].
///
/// # Errors
/// As [`ruga_solver::minimise`].
pub fn by_residual(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let problem = Problem {
        objective,
        rhs,
        kkt,
    };
    let linear = LinearSolver::Ldlt;
    Ok(descend_residual(problem, x, settings, linear, keep_going)?.0)
}

/// [`descend_residual`] with MINRES in the place of [`ruga_solver::minimise`].
///
/// # Errors
/// As [`ruga_solver::minimise`].
pub fn by_residual_and_minres(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let problem = Problem {
        objective,
        rhs,
        kkt,
    };
    let linear = LinearSolver::minres();
    Ok(descend_residual(problem, x, settings, linear, keep_going)?.0)
}

/// The report of a solve that has not begun.
fn empty_report() -> SolveReport {
    SolveReport {
        converged: false,
        stop: StopRule::IterationLimit,
        iterations: 0,
        factorizations: 0,
        energy: f64::INFINITY,
        residual: f64::INFINITY,
        decrement: f64::INFINITY,
        infeasibility: 0.0,
        inertia: None,
        relaxation_used: 0.0,
        first_relaxation: 0.0,
        shift_used: 0.0,
        left_saddle: false,
        multipliers: Vec::new(),
    }
}

fn check_finite(what: &'static str, values: &[f64]) -> Result<(), SolverError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(SolverError::NotFinite { what, index }),
    }
}

/// `product += H' multipliers`.
fn add_transposed_product(rows: &ConstraintRows, multipliers: &[f64], product: &mut [f64]) {
    for (row, multiplier) in multipliers.iter().enumerate() {
        let (columns, weights) = rows.row(row);
        for (&column, weight) in columns.iter().zip(weights) {
            product[column] += weight * multiplier;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn largest(vector: &[f64]) -> f64 {
    let sizes = vector.iter().map(|entry| entry.abs());
    sizes.fold(0.0, f64::max)
}
