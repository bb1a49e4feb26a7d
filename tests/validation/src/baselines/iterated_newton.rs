//! Newton's method on the energy with MINRES in place of a factorisation.

use ruga_solver::{Iteration, NewtonSettings, SolveReport, SolverError, StopRule};

use super::backtracking::shortened;
use super::minres::MinresStep;
use super::{
    LinearWork, MinresLimits, Problem, add_transposed_product, check_finite, dot, empty_report,
    largest,
};

/// Violation of a row that counts as none, over its sum of absolute weights times the length scale.
const FEASIBLE: f64 = 1e-9;

/// Restorations after which the constraints count as contradictory.
const MAX_RESTORATIONS: usize = 3;

/// Violation up to which the matrix of a restoration serves the step after it too.
const NEARLY_FEASIBLE: f64 = 1e-3;

/// Minimises the energy from `x` and leaves the result there.
///
/// Newton's method with an Armijo search, as far as the exact Hessian leads: MINRES solves with
/// indefinite matrices too, and a step that climbs is turned around. What it does not have is the
/// inertia, so it says of no state whether it is stable: from a flat start it stays on the saddle.
/// Settings of saddles, relaxation and the seed mean nothing to it.
///
/// # Errors
/// [`SolverError::NotFinite`] for derivatives that are not finite where the energy is.
pub fn minimise_iterated(
    problem: Problem<'_>,
    x: &mut [f64],
    settings: &NewtonSettings,
    limits: MinresLimits,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<(SolveReport, LinearWork), SolverError> {
    let mut newton = IteratedNewton::new(problem, limits)?;
    let stop = match newton.run(x, settings, keep_going) {
        Err(SolverError::Breakdown { .. }) => StopRule::Breakdown,
        other => other?,
    };
    newton.report.stop = stop;
    newton.report.converged = matches!(stop, StopRule::Decrement | StopRule::Residual);
    newton.report.infeasibility = newton.violation(x)?;
    newton.report.multipliers = newton.multipliers;
    Ok((newton.report, newton.work))
}

struct IteratedNewton<'a> {
    problem: Problem<'a>,
    minres: MinresStep,
    /// Whether the matrix of a restoration is to serve the next step.
    is_prepared: bool,
    gradient: Vec<f64>,
    /// `rhs - H x`.
    offset: Vec<f64>,
    step: Vec<f64>,
    multipliers: Vec<f64>,
    report: SolveReport,
    work: LinearWork,
}

impl<'a> IteratedNewton<'a> {
    fn new(problem: Problem<'a>, limits: MinresLimits) -> Result<Self, SolverError> {
        let (size, rows) = (problem.kkt.pattern().size(), problem.kkt.rows().count());
        Ok(Self {
            minres: MinresStep::new(problem.kkt, limits)?,
            problem,
            is_prepared: false,
            gradient: vec![0.0; size],
            offset: vec![0.0; rows],
            step: vec![0.0; size],
            multipliers: vec![0.0; rows],
            report: empty_report(),
            work: LinearWork::default(),
        })
    }

    fn run(
        &mut self,
        x: &mut [f64],
        settings: &NewtonSettings,
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<StopRule, SolverError> {
        for index in 0..settings.max_iterations {
            if !self.restore(x)? {
                return Ok(StopRule::Infeasible);
            }
            let energy = self.problem.objective.gradient(x, &mut self.gradient);
            self.report.energy = match energy.is_nan() {
                true => f64::INFINITY,
                false => energy,
            };
            if !energy.is_finite() {
                return Ok(StopRule::OutsideDomain);
            }
            check_finite("gradient", &self.gradient)?;
            let iteration = self.linearise(index, x, energy)?;
            if !keep_going(&iteration) {
                return Ok(StopRule::Interrupted);
            }
            if iteration.residual <= settings.residual_tolerance {
                return Ok(StopRule::Residual);
            }
            if iteration.decrement <= settings.energy_tolerance {
                self.take_last_step(x, energy);
                return Ok(StopRule::Decrement);
            }
            let slope = dot(&self.gradient, &self.step);
            match shortened(self.problem.objective, x, energy, &self.step, slope) {
                Some(there) => x.copy_from_slice(&there),
                None => return Ok(StopRule::LineSearch),
            }
        }
        Ok(StopRule::IterationLimit)
    }

    /// Moves `x` onto the constraints if it is off them; false when that is impossible.
    fn restore(&mut self, x: &mut [f64]) -> Result<bool, SolverError> {
        for _ in 0..MAX_RESTORATIONS {
            let violation = self.violation(x)?;
            if violation <= FEASIBLE {
                return Ok(true);
            }
            self.prepare(x)?;
            self.is_prepared = violation <= NEARLY_FEASIBLE;
            self.solve(&vec![0.0; x.len()])?;
            for (x, step) in x.iter_mut().zip(&self.step) {
                *x += step;
            }
        }
        Ok(self.violation(x)? <= FEASIBLE)
    }

    /// Writes `rhs - H x` and returns its largest entry, relative to weights and length scale.
    fn violation(&mut self, x: &[f64]) -> Result<f64, SolverError> {
        let rows = self.problem.kkt.rows();
        rows.mul(x, &mut self.offset)?;
        let mut worst = 0.0_f64;
        for (row, (offset, rhs)) in self.offset.iter_mut().zip(self.problem.rhs).enumerate() {
            *offset = rhs - *offset;
            let (columns, weights) = rows.row(row);
            let terms = columns.iter().zip(weights);
            let magnitude = rhs.abs() + terms.map(|(&c, w)| (w * x[c]).abs()).sum::<f64>();
            // What rounding leaves of a row far from the origin is no violation.
            let excess = (offset.abs() - 16.0 * f64::EPSILON * magnitude).max(0.0);
            let sum: f64 = weights.iter().map(|w| w.abs()).sum();
            let unit = if sum > 0.0 { sum } else { 1.0 };
            worst = worst.max(excess / (unit * self.problem.objective.length_scale()));
        }
        Ok(worst)
    }

    /// Sets up the exact Hessian at `x`, unless one is to be used again.
    fn prepare(&mut self, x: &[f64]) -> Result<(), SolverError> {
        if std::mem::take(&mut self.is_prepared) {
            return Ok(());
        }
        let Problem { objective, kkt, .. } = &self.problem;
        let mut exact = vec![0.0; kkt.pattern().entries()];
        let mut relaxed = exact.clone();
        objective.hessian(x, &mut exact, &mut relaxed);
        self.minres.prepare(kkt, &exact, objective.damping())
    }

    /// Solves for `step` and `multipliers`, and returns the iterations.
    fn solve(&mut self, force: &[f64]) -> Result<usize, SolverError> {
        let ends = (&mut self.step[..], &mut self.multipliers[..]);
        let solved = self
            .minres
            .solve(self.problem.kkt, (force, &self.offset), ends)?;
        self.work.add(&solved);
        Ok(solved.iterations)
    }

    /// Computes the Newton step at `x` and reports what it says about `x`.
    fn linearise(
        &mut self,
        index: usize,
        x: &[f64],
        energy: f64,
    ) -> Result<Iteration, SolverError> {
        self.prepare(x)?;
        let force: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        self.solve(&force)?;
        let objective = self.problem.objective;
        let mut residual = self.gradient.clone();
        let rows = self.problem.kkt.rows();
        add_transposed_product(rows, &self.multipliers, &mut residual);
        let slope = dot(&self.gradient, &self.step);
        if slope > 0.0 {
            // At a saddle the step may climb.
            self.step.iter_mut().for_each(|entry| *entry = -*entry);
        }
        let iteration = Iteration {
            index,
            energy,
            decrement: 0.5 * slope.abs() / objective.energy_scale(),
            residual: largest(&residual) / objective.force_scale(),
            relaxation: 0.0,
        };
        self.report.iterations = index + 1;
        self.report.residual = iteration.residual;
        self.report.decrement = iteration.decrement;
        Ok(iteration)
    }

    /// Takes the step that proved convergence, unless it climbs.
    fn take_last_step(&mut self, x: &mut [f64], energy: f64) {
        let there: Vec<f64> = x.iter().zip(&self.step).map(|(x, step)| x + step).collect();
        let reached = self.problem.objective.value(&there);
        if reached <= energy {
            x.copy_from_slice(&there);
            self.report.energy = reached;
        }
    }
}
