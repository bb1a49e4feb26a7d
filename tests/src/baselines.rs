//! Methods of the papers that ruga is compared with: MINRES in place of a factorisation, and Newton's
//! method on the norm of the forces in place of the energy.

use ruga_solver::{
    Descent, Iteration, Kkt, LinearSolver, NewtonSettings, Objective, SolveReport, SolverError,
    minimise,
};

/// Newton's method on the energy with MINRES in place of a factorisation.
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
    let settings = NewtonSettings {
        linear: LinearSolver::minres(),
        ..settings.clone()
    };
    minimise(objective, rhs, x, kkt, &settings, keep_going)
}

/// Newton's method on the norm of the forces, with a factorisation.
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
    let settings = NewtonSettings {
        descent: Descent::Residual,
        ..settings.clone()
    };
    minimise(objective, rhs, x, kkt, &settings, keep_going)
}

/// Newton's method on the norm of the forces, with MINRES.
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
    let settings = NewtonSettings {
        descent: Descent::Residual,
        ..settings.clone()
    };
    by_minres(objective, rhs, x, kkt, &settings, keep_going)
}
