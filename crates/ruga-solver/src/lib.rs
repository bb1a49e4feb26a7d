//! Minimises an energy of many unknowns under linear constraints: an [`Objective`] and rows
//! `H x = b` go in, a minimum (a saddle only where [`AtSaddle`] allows one) and a [`SolveReport`] come out.
//!
//! An [`Objective`] gives energy, gradient and Hessian in a [`LowerPattern`]; [`Kkt`] analyses
//! that pattern together with the [`ConstraintRows`] once and factorises it in place;
//! [`minimise`] runs Newton's method on it. [`LoadStepper`] chooses the loads that lead through
//! the onset of buckling, [`inertia_at`] and [`softest_mode`] tell where that is.
//!
//! Each Newton step solves
//!
//! ```text
//! [ K  H' ] [ p ]   [ -g      ]
//! [ H  0  ] [ y ] = [ b - H x ]
//! ```
//!
//! by an `L D L'` factorisation of the quasi-definite regularisation of the matrix
//! (Vanderbei 1995). The signs of `D` are its inertia: as many negative pivots as rows mean a
//! minimum, more mean a saddle (Gould 1985), from which negative curvature leads down. All threads of
//! the rayon pool that it is called in factorise, with the same bits on any number of them.
//!
//! Unknowns are lengths in m, energies in J, forces in N, stiffnesses in N/m; all tolerances
//! are relative to the scales of the objective. The crate knows no mesh and no load.
//!
//! ```
//! use ruga_solver::{ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, minimise};
//!
//! /// `(x0^2 + 3 x1^2) / 2`
//! struct Bowl(LowerPattern);
//!
//! impl Objective for Bowl {
//!     fn pattern(&self) -> &LowerPattern {
//!         &self.0
//!     }
//!     fn value(&self, x: &[f64]) -> f64 {
//!         0.5 * (x[0] * x[0] + 3.0 * x[1] * x[1])
//!     }
//!     fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
//!         gradient.copy_from_slice(&[x[0], 3.0 * x[1]]);
//!         self.value(x)
//!     }
//!     fn hessian(&self, _: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
//!         exact.copy_from_slice(&[1.0, 3.0]);
//!         relaxed.copy_from_slice(&[1.0, 3.0]);
//!     }
//! }
//!
//! # fn main() -> Result<(), ruga_solver::SolverError> {
//! let bowl = Bowl(LowerPattern::new(vec![0, 1, 2], vec![0, 1])?);
//! let rows = ConstraintRows::new(vec![0, 2], vec![0, 1], vec![1.0, 1.0], 2)?;
//! let mut kkt = Kkt::new(bowl.pattern(), &rows, 1)?;
//! let mut x = [5.0, -7.0];
//! let settings = NewtonSettings::default();
//! let report = minimise(&bowl, &[4.0], &mut x, &mut kkt, &settings, &mut |_| true)?;
//! assert!(report.converged);
//! assert!((x[0] - 3.0).abs() < 1e-9 && (x[1] - 1.0).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```

mod newton;

mod objective;
mod pinned;

mod fronts;
mod kkt;

mod constraint_rows;
mod lower_pattern;

mod load_steps;
mod soft_modes;

mod report;

mod convexify;
mod error;
mod line_search;
mod ordering;
mod permuted_system;

pub use newton::{Minimise, minimise};
pub use objective::{Objective, StressPrediction};
pub use pinned::Pinned;

pub use kkt::{FactorCost, Inertia, Kkt};
pub use ordering::EliminationOrder;

pub use constraint_rows::ConstraintRows;
pub use lower_pattern::LowerPattern;

pub use load_steps::{LoadSettings, LoadStepper, Outcome, Trial, Verdict};
pub use soft_modes::{SoftMode, inertia_at, softest_mode};

pub use error::SolverError;
pub use report::{AtSaddle, Iteration, NewtonSettings, SolveReport, StopRule};
