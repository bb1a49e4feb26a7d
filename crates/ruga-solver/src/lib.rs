//! Minimises an energy under linear constraints: sparse KKT factorisation, Newton, MINRES.

mod constraint_rows;
mod convexify;
mod error;
mod kkt;
mod line_search;
mod load_steps;
mod lower_pattern;
mod minres;
mod newton;
mod objective;
mod ordering;
mod permuted_system;
mod report;
mod soft_modes;

pub use constraint_rows::ConstraintRows;
pub use error::SolverError;
pub use kkt::{FactorCost, Inertia, Kkt};
pub use load_steps::{LoadSettings, LoadStepper, Outcome, Trial, Verdict};
pub use lower_pattern::LowerPattern;
pub use newton::minimise;
pub use objective::Objective;
pub use report::{AtSaddle, Iteration, LinearSolver, NewtonSettings, SolveReport, StopRule};
pub use soft_modes::{SoftMode, inertia_at, softest_mode};
