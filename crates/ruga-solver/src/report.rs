//! Settings of a solve and what it tells about itself.

use crate::{Inertia, SolverError};

/// What to do at a stationary point that is a saddle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AtSaddle {
    /// Follow the negative curvature down to a minimum.
    Leave,
    /// Follow it until the last step has gained, and the next one promises, less than the tolerance of the energy: for
    /// a state that is only the start of the next solve. Where a pattern can slide along a flat valley its softest
    /// modes change sign again and again, and the way to the next minimum is long and worth nothing.
    Pass,
    /// Like [`Pass`](Self::Pass), but only once at most a tenth is left of the most modes of negative curvature that
    /// one iteration of this solve has found: for a solve in which a pattern begins, whose start is a saddle without
    /// any decrement. What is left is for the caller to find with another solve.
    PassFew,
    /// Stop there with [`StopRule::Saddle`]: a probe for the onset of buckling.
    Stop,
}

/// Settings of [`minimise`](crate::minimise). The tolerances are relative to the objective's
/// scales.
#[derive(Debug, Clone, PartialEq)]
pub struct NewtonSettings {
    /// What to do at a saddle. Default: leave it.
    pub at_saddle: AtSaddle,
    /// Newton steps after which the solve gives up, at least 1. Default 100; a cold start far
    /// beyond the onset takes 10 to 25.
    pub max_iterations: usize,
    /// Stop when the Newton decrement is below this times the energy scale. Default 1e-6. The
    /// sliding mode of a pattern converges no further in reasonable time, and energies and
    /// amplitudes no longer change.
    pub energy_tolerance: f64,
    /// Stop when the largest residual force is below this times the force scale. Default 1e-7.
    pub residual_tolerance: f64,
    /// Share of the compressive stress stiffness to leave out of the first step if its Hessian is
    /// indefinite, from the [`SolveReport::first_relaxation`] of a similar solve: spares the search
    /// for the least that will do. That search picks the mode that buckles first; a pattern that is
    /// there already and only moved does not need it. In [0, 1]; 0, the default, searches.
    pub first_relaxation: f64,
    /// Whether a step that the energy would shorten is taken whole, and kept if the next one ends
    /// lower than the shortened one. Saves iterations where obstacles push from one side only: ten of
    /// 24 in the step in which a cushion lands. Default: no, and the shortened step is bent.
    pub overshoot: bool,
    /// Whether any minimum nearby will do, without rows: negative pivots of a Hessian with few of them are turned
    /// positive then, which takes no other factorisation, but depends on the order of elimination and so keeps no
    /// symmetry. Default: no, and the mode that buckles first is sought.
    pub any_minimum: bool,
    /// Seed of the vectors that negative curvature is searched from. Default 1.
    pub seed: u64,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self {
            at_saddle: AtSaddle::Leave,
            max_iterations: 100,
            energy_tolerance: 1e-6,
            residual_tolerance: 1e-7,
            first_relaxation: 0.0,
            overshoot: false,
            any_minimum: false,
            seed: 1,
        }
    }
}

impl NewtonSettings {
    pub(crate) fn check(&self) -> Result<(), SolverError> {
        let refuse = |setting, value| Err(SolverError::Setting { setting, value });
        if self.max_iterations == 0 {
            return refuse("max_iterations", 0.0);
        }
        // Zero is legal and leaves the decision to the other rule.
        if self.energy_tolerance.is_nan() || self.energy_tolerance < 0.0 {
            return refuse("energy_tolerance", self.energy_tolerance);
        }
        if self.residual_tolerance.is_nan() || self.residual_tolerance < 0.0 {
            return refuse("residual_tolerance", self.residual_tolerance);
        }
        if !(0.0..=1.0).contains(&self.first_relaxation) {
            return refuse("first_relaxation", self.first_relaxation);
        }
        Ok(())
    }
}

/// Why a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopRule {
    /// The Newton decrement fell below its tolerance at a minimum, or at a saddle that may be
    /// [passed](AtSaddle::Pass): converged.
    Decrement,
    /// The residual fell below its tolerance at a minimum: converged.
    Residual,
    /// A saddle was found and [`AtSaddle::Stop`] was asked for.
    Saddle,
    /// Too many iterations.
    IterationLimit,
    /// No step along the search direction lowers the energy any more.
    LineSearch,
    /// The constraints contradict each other: no `x` satisfies them.
    Infeasible,
    /// No relaxation and no diagonal shift gives the Hessian the inertia of a minimum: stiffnesses lie
    /// too far apart for the factorisation.
    Breakdown,
    /// The start, moved onto the constraints, has no finite energy.
    OutsideDomain,
    /// The caller asked to stop.
    Interrupted,
}

/// One Newton iteration, as told to the caller while it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// Count from 0.
    pub index: usize,
    /// Energy before the step (J).
    pub energy: f64,
    /// Newton decrement `-g.p / 2` over the energy scale.
    pub decrement: f64,
    /// Largest residual force over the force scale.
    pub residual: f64,
    /// Share of the compressive stress stiffness left out of this step, 0 to 1.
    pub relaxation: f64,
}

/// How a solve went. Not converging is data, not an error.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveReport {
    /// Whether a tolerance was met, at a minimum or at a saddle that may be [passed](AtSaddle::Pass).
    pub converged: bool,
    /// Why the solve ended.
    pub stop: StopRule,
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorisations of the KKT matrix.
    pub factorizations: usize,
    /// Energy at the end (J).
    pub energy: f64,
    /// Largest residual force over the force scale, at the last linearisation.
    pub residual: f64,
    /// Newton decrement over the energy scale, at the last linearisation.
    pub decrement: f64,
    /// Largest violation of a constraint row over (length scale x sum of its absolute weights).
    pub infeasibility: f64,
    /// Signs of the exact Hessian's pivots at the last linearisation; `None` where there was none, or
    /// where a method in the place of [`minimise`](crate::minimise) does not know them.
    pub inertia: Option<Inertia>,
    /// Largest share of the compressive stress stiffness that had to be left out, 0 to 1.
    pub relaxation_used: f64,
    /// Share of the compressive stress stiffness left out of the first step, 0 to 1.
    pub first_relaxation: f64,
    /// Largest diagonal shift, relative to the median diagonal, that was needed on top of full
    /// relaxation; 0 nearly always.
    pub shift_used: f64,
    /// Whether the Hessian was indefinite somewhere on the way.
    pub left_saddle: bool,
    /// Lagrange multipliers (N per unit of a row), one per row: reactions of the constraints.
    pub multipliers: Vec<f64>,
}

impl SolveReport {
    /// The report of a solve without unknowns, which is solved as it is.
    pub fn nothing_to_solve() -> Self {
        Self {
            converged: true,
            stop: StopRule::Residual,
            energy: 0.0,
            residual: 0.0,
            decrement: 0.0,
            ..Self::empty()
        }
    }

    /// The report of a solve that the caller has stopped before it began.
    pub fn interrupted() -> Self {
        Self {
            stop: StopRule::Interrupted,
            ..Self::empty()
        }
    }

    /// The report of a solve that has not begun.
    pub(crate) fn empty() -> Self {
        Self {
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
}
