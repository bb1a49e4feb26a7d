//! Newton's method as the papers have it: on the forces, whatever the energy does.

use ruga_solver::{Iteration, NewtonSettings, SolveReport, SolverError, StopRule};

use super::minres::MinresStep;
use super::{
    LinearSolver, LinearWork, Problem, add_transposed_product, check_finite, dot, empty_report,
    largest,
};

/// Share by which a step has to lower the norm, per unit of its length (Armijo).
const SUFFICIENT: f64 = 1e-4;

/// Lengths that are tried.
const TRIALS: usize = 30;

/// Solves `g + H' y = 0`, `H x = rhs` from `x` by Newton steps, shortened until the norm of both falls
/// (Rémillard and Kry 2013, section 6.1), and leaves the result in `x`.
///
/// A saddle or a maximum is as good to it as a minimum: it stops at any with [`StopRule::Residual`], and
/// the inertia in the report tells, if the linear solver knows one. Settings of saddles, of the
/// decrement, of relaxation and the seed mean nothing to it.
///
/// # Errors
/// [`SolverError::NotFinite`] for derivatives that are not finite where the energy is.
pub fn descend_residual(
    problem: Problem<'_>,
    x: &mut [f64],
    settings: &NewtonSettings,
    linear: LinearSolver,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<(SolveReport, LinearWork), SolverError> {
    let mut search = Search::new(problem, linear)?;
    let stop = match search.run(x, settings, keep_going) {
        Err(SolverError::Breakdown { .. }) => StopRule::Breakdown,
        other => other?,
    };
    search.report.stop = stop;
    search.report.converged = stop == StopRule::Residual;
    search.report.multipliers = search.multipliers;
    Ok((search.report, search.work))
}

struct Search<'a> {
    problem: Problem<'a>,
    minres: Option<MinresStep>,
    values: Vec<f64>,
    multipliers: Vec<f64>,
    report: SolveReport,
    work: LinearWork,
}

/// What is out of balance somewhere.
struct Imbalance {
    energy: f64,
    gradient: Vec<f64>,
    /// `rhs - H x`.
    offset: Vec<f64>,
    /// Largest residual force over the force scale.
    force: f64,
    /// Largest entry of `offset` over the length scale.
    way: f64,
    /// Root mean square of forces and ways over their scales.
    norm: f64,
}

impl<'a> Search<'a> {
    fn new(problem: Problem<'a>, linear: LinearSolver) -> Result<Self, SolverError> {
        let kkt = &*problem.kkt;
        let minres = match linear {
            LinearSolver::Ldlt => None,
            LinearSolver::Minres(limits) => Some(MinresStep::new(kkt, limits)?),
        };
        Ok(Self {
            minres,
            values: vec![0.0; kkt.pattern().entries()],
            multipliers: vec![0.0; kkt.rows().count()],
            report: empty_report(),
            work: LinearWork::default(),
            problem,
        })
    }

    fn run(
        &mut self,
        x: &mut [f64],
        settings: &NewtonSettings,
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<StopRule, SolverError> {
        for index in 0..settings.max_iterations {
            let here = self.imbalance(x, &self.multipliers);
            self.report.energy = match here.energy.is_nan() {
                true => f64::INFINITY,
                false => here.energy,
            };
            self.report.infeasibility = here.way;
            if !here.energy.is_finite() {
                return Ok(StopRule::OutsideDomain);
            }
            check_finite("gradient", &here.gradient)?;
            let (step, wanted, iteration) = self.linearise(index, x, &here)?;
            self.record(&iteration);
            if !keep_going(&iteration) {
                return Ok(StopRule::Interrupted);
            }
            if here.force.max(here.way) <= settings.residual_tolerance {
                return Ok(StopRule::Residual);
            }
            let Some((there, multipliers)) = self.search(x, &here, [&step, &wanted]) else {
                return Ok(StopRule::LineSearch);
            };
            x.copy_from_slice(&there);
            self.multipliers = multipliers;
        }
        Ok(StopRule::IterationLimit)
    }

    /// The Newton step, and the multipliers at its end.
    fn linearise(
        &mut self,
        index: usize,
        x: &[f64],
        here: &Imbalance,
    ) -> Result<(Vec<f64>, Vec<f64>, Iteration), SolverError> {
        let objective = self.problem.objective;
        let kkt = &mut *self.problem.kkt;
        let damping = objective.damping();
        let mut relaxed = vec![0.0; self.values.len()];
        objective.hessian(x, &mut self.values, &mut relaxed);
        let force: Vec<f64> = here.gradient.iter().map(|g| -g).collect();
        let (mut step, mut wanted) = (vec![0.0; x.len()], vec![0.0; self.multipliers.len()]);
        match &mut self.minres {
            None => {
                self.report.factorizations += 1;
                self.report.inertia = Some(kkt.factorize(&self.values, damping)?);
                kkt.solve_step(&force, &here.offset, &mut step, &mut wanted)?;
            }
            Some(minres) => {
                minres.prepare(kkt, &self.values, damping)?;
                let ends = (&mut step[..], &mut wanted[..]);
                self.work
                    .add(&minres.solve(kkt, (&force, &here.offset), ends)?);
            }
        }
        let slope = dot(&here.gradient, &step);
        let iteration = Iteration {
            index,
            energy: here.energy,
            decrement: 0.5 * slope.abs() / objective.energy_scale(),
            residual: here.force,
            relaxation: 0.0,
        };
        Ok((step, wanted, iteration))
    }

    fn record(&mut self, iteration: &Iteration) {
        let report = &mut self.report;
        report.iterations = iteration.index + 1;
        report.residual = iteration.residual;
        report.decrement = iteration.decrement;
    }

    /// The first end of a shortened step at which the norm has fallen enough, with its multipliers.
    /// After the whole and the half step, lengths are where a parabola through the squared norms of
    /// the last two and of the start is lowest, within .1 and .5 of the last one.
    fn search(
        &self,
        x: &[f64],
        here: &Imbalance,
        [step, wanted]: [&[f64]; 2],
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut length = 1.0;
        let mut before: Option<[f64; 2]> = None;
        for _ in 0..TRIALS {
            let ends = x.iter().zip(step);
            let there: Vec<f64> = ends.map(|(x, step)| x + length * step).collect();
            let ends = self.multipliers.iter().zip(wanted);
            let multipliers: Vec<f64> = ends.map(|(y, end)| y + length * (end - y)).collect();
            let Imbalance { energy, norm, .. } = self.imbalance(&there, &multipliers);
            if energy.is_finite() && norm < (1.0 - SUFFICIENT * length) * here.norm {
                return Some((there, multipliers));
            }
            let tried = [length, norm * norm];
            length = shorter(here.norm * here.norm, before, tried);
            before = Some(tried);
        }
        None
    }

    fn imbalance(&self, x: &[f64], multipliers: &[f64]) -> Imbalance {
        let mut gradient = vec![0.0; x.len()];
        let Problem {
            objective,
            rhs,
            kkt,
        } = &self.problem;
        let energy = objective.gradient(x, &mut gradient);
        let rows = kkt.rows();
        let mut force = gradient.clone();
        add_transposed_product(rows, multipliers, &mut force);
        let mut offset = vec![0.0; rows.count()];
        rows.mul(x, &mut offset).expect("sizes match");
        for (offset, rhs) in offset.iter_mut().zip(*rhs) {
            *offset = rhs - *offset;
        }
        let [force_scale, length_scale] = [objective.force_scale(), objective.length_scale()];
        let squares = dot(&force, &force) / force_scale.powi(2)
            + dot(&offset, &offset) / length_scale.powi(2);
        Imbalance {
            energy,
            force: largest(&force) / force_scale,
            way: largest(&offset) / length_scale,
            norm: (squares / x.len() as f64).sqrt(),
            gradient,
            offset,
        }
    }
}

/// The length to try after `[length, squared norm]` of the last one and of the one before.
fn shorter(start: f64, before: Option<[f64; 2]>, [length, last]: [f64; 2]) -> f64 {
    let Some([longer, first]) = before else {
        return 0.5 * length;
    };
    let [rise, first_rise] = [(last - start) / length, (first - start) / longer];
    let bend = (first_rise - rise) / (longer - length);
    let lowest = -0.5 * (rise - bend * length) / bend;
    if bend > 0.0 && lowest.is_finite() {
        lowest.clamp(0.1 * length, 0.5 * length)
    } else {
        0.5 * length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_after_two_is_where_their_parabola_is_lowest() {
        let norm = |s: f64| 3.0 - 0.8 * s + 2.0 * s * s;
        let next = shorter(norm(0.0), Some([1.0, norm(1.0)]), [0.5, norm(0.5)]);
        assert!((next - 0.2).abs() < 1e-12, "{next}");
        let nowhere = shorter(norm(0.0), Some([1.0, f64::NAN]), [0.5, norm(0.5)]);
        assert_eq!(nowhere, 0.25);
    }
}
