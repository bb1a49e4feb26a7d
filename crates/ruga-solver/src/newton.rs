//! Newton's method under linear constraints.

mod bent_step;
mod overshot;
mod predicted;
mod stopping;

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use overshot::Overshot;
use predicted::Predicted;

use crate::convexify::{Convexifier, Hessian};
use crate::error::{check_finite, check_length};
use crate::line_search::line_search;
use crate::objective::check_pattern;
use crate::soft_modes::{Point, dot, largest, search_curvature};
use crate::{
    AtSaddle, Inertia, Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError,
    StopRule,
};

/// Violation of a row that counts as none, over its sum of absolute weights times the length
/// scale.
const FEASIBLE: f64 = 1e-9;

/// Restorations before the constraints count as contradictory; the first one is exact up to
/// rounding when they agree.
const MAX_RESTORATIONS: usize = 3;

/// Violation up to which restoring it changes the Hessian so little that one factor serves both
/// the restoration and the step after it. What a layer carried along with its base violates is
/// a tenth of this; half of a wrinkled frame's factorisations would go into it.
const NEARLY_FEASIBLE: f64 = 1e-3;

/// Lengths below this share of a Newton step are tried along a parabola.
const SHORT: f64 = 0.6;
/// Lengths below this share of a Newton step are not bent: something else than a bend stops them.
const LEAST: f64 = 1e-3;

/// Energy that a Newton step at a saddle has to gain, in energy scales, or the direction of negative
/// curvature is sought as well. The relaxed Hessian is soft in just that direction, so that a step which
/// has some force to begin with follows it: of 49 steps at the saddles of a smile only one, which gained
/// 2e-7, was outdone by the search.
const LITTLE_GAIN: f64 = 1e-5;

/// Signature of [`minimise`], for callers that let another method take its place.
pub type Minimise = fn(
    &dyn Objective,
    &[f64],
    &mut [f64],
    &mut Kkt,
    &NewtonSettings,
    &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError>;

/// Minimises `objective` subject to `H x = rhs`, starting from `x` and leaving the result there.
///
/// `H` is [`kkt.rows()`](Kkt::rows). `x` may start infeasible: the first step restores the
/// constraints at full length with the least elastic energy, then every step stays within
/// `H p = 0` and is shortened until the energy falls, or with [`NewtonSettings::overshoot`] every two; of an
/// objective that [predicts its stresses](Objective::prediction) the energy may rise for some steps.
/// Where the Hessian is indefinite on that space, only what the objective relaxes is left out, such as
/// the compressive stress stiffness, and where that step gains hardly any energy the direction of negative
/// curvature is searched as well; the solve stops as converged only where the exact Hessian has the
/// inertia of a minimum, but for saddles that may be [passed](AtSaddle::Pass). `keep_going` sees every
/// iteration and ends the solve by returning `false`; an iteration takes at most some 30 factorisations, where the
/// Hessian's inertia is hard to mend, or twice as many where predicted stresses have to make way for those that are
/// there. Same input, same bits.
///
/// # Errors
/// [`SolverError::PatternMismatch`], [`SizeMismatch`](SolverError::SizeMismatch),
/// [`Setting`](SolverError::Setting), [`NotFinite`](SolverError::NotFinite) for bad input or an
/// objective with derivatives that are not finite where its energy is. `x` is then left at the last
/// iterate.
pub fn minimise(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    settings.check()?;
    check_pattern(objective, kkt)?;
    check_length("x", kkt.pattern().size(), x.len())?;
    check_length("constraint right-hand side", kkt.rows().count(), rhs.len())?;
    check_finite("x", x)?;
    check_finite("constraint right-hand side", rhs)?;
    let mut newton = Newton::new(objective, rhs, kkt, settings)?;
    let ending = newton.run(x, keep_going);
    // The solve ended on a whole step before the next one could make up for it.
    if let Some(overshot) = newton.overshot.take() {
        newton.go_back(x, &overshot);
    }
    newton.end_prediction(x);
    let stop = match ending {
        // A Hessian that nothing mends is no mistake in the input, so it is reported as data.
        Err(SolverError::Breakdown { .. }) => StopRule::Breakdown,
        other => other?,
    };
    newton.report.stop = stop;
    newton.report.converged = matches!(stop, StopRule::Decrement | StopRule::Residual);
    newton.report.infeasibility = newton.violation(x);
    newton.report.factorizations = newton.convexifier.factorizations;
    newton.report.multipliers = newton.multipliers;
    Ok(newton.report)
}

struct Newton<'a> {
    objective: &'a dyn Objective,
    rhs: &'a [f64],
    kkt: &'a mut Kkt,
    settings: &'a NewtonSettings,
    convexifier: Convexifier,
    generator: Pcg64Mcg,
    gradient: Vec<f64>,
    exact: Vec<f64>,
    relaxed: Vec<f64>,
    /// Right-hand side of the step's force equation, then residual forces.
    force: Vec<f64>,
    /// `rhs - H x`.
    offset: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    multipliers: Vec<f64>,
    indefinite_iterations: usize,
    /// Most modes of negative curvature that an iteration has found.
    most_modes: usize,
    /// Iterations in a row whose Hessian only a diagonal mended.
    shifted_iterations: usize,
    /// A relaxation that may do for the first step.
    hint: Option<f64>,
    /// Energy before the last step, where that was one that had to lower it (J).
    before: Option<f64>,
    /// Inertia and relaxation of a factor that a small restoration left usable.
    at_hand: Option<Factored>,
    /// The shortened step to go back to from one that was taken whole.
    overshot: Option<Overshot>,
    predicted: Predicted,
    report: SolveReport,
}

/// Inertia that a factorisation found, and the relaxation that it took.
#[derive(Clone, Copy)]
struct Factored {
    /// Signs of the exact Hessian's pivots.
    inertia: Inertia,
    relaxation: f64,
}

impl<'a> Newton<'a> {
    fn new(
        objective: &'a dyn Objective,
        rhs: &'a [f64],
        kkt: &'a mut Kkt,
        settings: &'a NewtonSettings,
    ) -> Result<Self, SolverError> {
        let (size, rows) = (kkt.pattern().size(), kkt.rows().count());
        Ok(Self {
            objective,
            rhs,
            settings,
            convexifier: Convexifier::new(kkt, settings.any_minimum),
            generator: Pcg64Mcg::seed_from_u64(settings.seed),
            gradient: vec![0.0; size],
            exact: vec![0.0; kkt.pattern().entries()],
            relaxed: vec![0.0; kkt.pattern().entries()],
            force: vec![0.0; size],
            offset: vec![0.0; rows],
            step: vec![0.0; size],
            trial: vec![0.0; size],
            multipliers: vec![0.0; rows],
            kkt,
            indefinite_iterations: 0,
            most_modes: 0,
            shifted_iterations: 0,
            hint: Some(settings.first_relaxation).filter(|&hint| hint > 0.0),
            before: None,
            at_hand: None,
            overshot: None,
            predicted: Predicted::default(),
            report: SolveReport::empty(),
        })
    }

    fn run(
        &mut self,
        x: &mut [f64],
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<StopRule, SolverError> {
        for index in 0..self.settings.max_iterations {
            // In every iteration: a step keeps the rows only to the residual of its solve, and many
            // steps add up.
            if !self.restore(x)? {
                return Ok(StopRule::Infeasible);
            }
            let energy = self.objective.gradient(x, &mut self.gradient);
            // Infinity compares as worse than every energy, NaN as nothing.
            self.report.energy = if energy.is_nan() {
                f64::INFINITY
            } else {
                energy
            };
            if !energy.is_finite() {
                return Ok(StopRule::OutsideDomain);
            }
            check_finite("gradient", &self.gradient)?;
            let (mut iteration, mut inertia) = self.linearise(index, x, energy)?;
            // Only the exact Hessian proves a minimum, or knows the way down from a saddle.
            if self.is_predicted()
                && (self.stop(&iteration, inertia).is_some() || iteration.decrement <= LITTLE_GAIN)
            {
                (iteration, inertia) = self.linearise(index, x, energy)?;
            }
            if let Some(overshot) = self.overshot.take() {
                // No stop rule is asked: this state is kept only as the start of a step that makes
                // up for it.
                self.report.iterations = index + 1;
                self.redeem(x, energy, &overshot);
                if !keep_going(&iteration) {
                    return Ok(StopRule::Interrupted);
                }
                continue;
            }
            self.record(&iteration, inertia);
            if !keep_going(&iteration) {
                return Ok(StopRule::Interrupted);
            }
            let stop = self.stop(&iteration, inertia);
            if let Some(stop) = stop.filter(|stop| self.may_stop(*stop, energy)) {
                if stop == StopRule::Decrement {
                    self.take_last_step(x, energy);
                }
                return Ok(stop);
            }
            if !self.advance(x, energy, &iteration, inertia)? {
                return Ok(StopRule::LineSearch);
            }
        }
        Ok(StopRule::IterationLimit)
    }

    /// Moves `x` onto the constraints if it is off them; false when that is impossible.
    fn restore(&mut self, x: &mut [f64]) -> Result<bool, SolverError> {
        for _ in 0..MAX_RESTORATIONS {
            let violation = self.violation(x);
            if violation <= FEASIBLE {
                return Ok(true);
            }
            if violation <= NEARLY_FEASIBLE {
                self.at_hand = Some(self.factorize(x)?);
            } else {
                self.at_hand = None;
                self.factorize_relaxed(x)?;
            }
            // No force on the right: the way onto the rows is the one of least energy, not a
            // descent.
            self.force.fill(0.0);
            self.solve()?;
            for (x, step) in x.iter_mut().zip(&self.step) {
                // At full length whatever the energy: any shorter step would still violate the
                // rows.
                *x += step;
            }
        }
        Ok(self.violation(x) <= FEASIBLE)
    }

    /// Writes `rhs - H x` and returns its largest entry, relative to weights and length scale.
    fn violation(&mut self, x: &[f64]) -> f64 {
        self.offset.fill(0.0);
        self.kkt.rows().add_product(x, &mut self.offset);
        let mut worst = 0.0_f64;
        for (row, (offset, rhs)) in self.offset.iter_mut().zip(self.rhs).enumerate() {
            *offset = rhs - *offset;
            let (columns, weights) = self.kkt.rows().row(row);
            let (mut sum, mut magnitude) = (0.0, rhs.abs());
            for (&column, weight) in columns.iter().zip(weights) {
                sum += weight.abs();
                magnitude += (weight * x[column]).abs();
            }
            // What rounding leaves of a row far from the origin is no violation.
            let excess = (offset.abs() - 16.0 * f64::EPSILON * magnitude).max(0.0);
            // No `x` changes a row of zeros; its right-hand side is then compared with a length.
            let unit = if sum > 0.0 { sum } else { 1.0 };
            worst = worst.max(excess / (unit * self.objective.length_scale()));
        }
        worst
    }

    /// Factorises the Hessian at `x`, relaxed as needed; takes the factor at hand if there is
    /// one.
    fn factorize(&mut self, x: &[f64]) -> Result<Factored, SolverError> {
        if let Some(at_hand) = self.at_hand.take() {
            return Ok(at_hand);
        }
        self.write_hessian(x);
        let hint = self.hint.take();
        let hessian = Hessian {
            exact: &self.exact,
            relaxed: &self.relaxed,
            damping: self.objective.damping(),
        };
        let outcome = self.convexifier.factorize(self.kkt, hessian, hint)?;
        self.report.shift_used = self.report.shift_used.max(outcome.shift);
        self.shifted_iterations = match outcome.shift > 0.0 {
            true => self.shifted_iterations + 1,
            false => 0,
        };
        Ok(Factored {
            inertia: outcome.exact,
            relaxation: outcome.relaxation,
        })
    }

    /// Factorises the fully relaxed Hessian at `x`, for a restoration: its inertia need not be
    /// searched for, and a mode about to buckle would be moved most by a restoration that knows
    /// of the compression.
    fn factorize_relaxed(&mut self, x: &[f64]) -> Result<(), SolverError> {
        self.objective
            .hessian(x, &mut self.exact, &mut self.relaxed);
        let hessian = Hessian {
            exact: &self.exact,
            relaxed: &self.relaxed,
            damping: self.objective.damping(),
        };
        let shift = self.convexifier.shift(self.kkt, hessian)?;
        self.report.shift_used = self.report.shift_used.max(shift);
        Ok(())
    }

    /// Solves for `step` and `multipliers` with `force` and `offset` on the right.
    fn solve(&mut self) -> Result<(), SolverError> {
        if self.kkt.is_turned() {
            return self.kkt.solve_once(&self.force, &mut self.step);
        }
        self.kkt.solve_step(
            &self.force,
            &self.offset,
            &mut self.step,
            &mut self.multipliers,
        )?;
        Ok(())
    }

    /// Computes the Newton step at `x` and what it says about `x`, with the inertia of the exact
    /// Hessian.
    fn linearise(
        &mut self,
        index: usize,
        x: &[f64],
        energy: f64,
    ) -> Result<(Iteration, Inertia), SolverError> {
        let Factored {
            inertia,
            relaxation,
        } = self.factorize(x)?;
        for (force, gradient) in self.force.iter_mut().zip(&self.gradient) {
            *force = -gradient;
        }
        self.solve()?;
        // What this step's multipliers do not balance, which vanishes with the step: with the
        // matrix as factorised it is `-K p`.
        self.force.copy_from_slice(&self.gradient);
        self.kkt
            .rows()
            .add_transposed_product(&self.multipliers, &mut self.force);
        let slope = dot(&self.gradient, &self.step);
        let iteration = Iteration {
            index,
            energy,
            // Rounding may turn the sign of a slope that should be zero.
            decrement: 0.5 * slope.abs() / self.objective.energy_scale(),
            residual: largest(&self.force) / self.objective.force_scale(),
            relaxation,
        };
        Ok((iteration, inertia))
    }

    fn record(&mut self, iteration: &Iteration, inertia: Inertia) {
        let indefinite = !inertia.is_minimum();
        self.indefinite_iterations += usize::from(indefinite);
        self.most_modes = self.most_modes.max(inertia.excess());
        let report = &mut self.report;
        report.iterations = iteration.index + 1;
        report.residual = iteration.residual;
        report.decrement = iteration.decrement;
        report.inertia = Some(inertia);
        report.relaxation_used = report.relaxation_used.max(iteration.relaxation);
        if iteration.index == 0 {
            report.first_relaxation = iteration.relaxation;
        }
        report.left_saddle |= indefinite;
    }

    /// The step that proved convergence is already paid for: takes it unless it climbs.
    fn take_last_step(&mut self, x: &mut [f64], energy: f64) {
        for ((trial, x), step) in self.trial.iter_mut().zip(&*x).zip(&self.step) {
            *trial = x + step;
        }
        let reached = self.objective.value(&self.trial);
        if reached <= energy {
            x.copy_from_slice(&self.trial);
            self.report.energy = reached;
        }
    }

    /// Takes the Newton step or, at a saddle where that gains little, the curvature step if it is better.
    fn advance(
        &mut self,
        x: &mut [f64],
        energy: f64,
        iteration: &Iteration,
        inertia: Inertia,
    ) -> Result<bool, SolverError> {
        self.before = None;
        if self.predicts(iteration, inertia) && self.advance_predicted(x, energy) {
            return Ok(true);
        }
        let slope = dot(&self.gradient, &self.step);
        let newton = line_search(
            self.objective,
            x,
            energy,
            &self.step,
            slope,
            &mut self.trial,
        );
        let at_saddle = !inertia.is_minimum();
        // A whole step needs another iteration to make up for it.
        let is_last = iteration.index + 1 == self.settings.max_iterations;
        // Bending solves with the factor for the second derivative of the path, which needs the
        // exact Hessian in it: not at a saddle.
        let newton = match newton {
            Some(accepted) if !at_saddle && (LEAST..SHORT).contains(&accepted.length) => {
                if self.settings.overshoot && !is_last && self.overshoot(x, accepted) {
                    return Ok(true);
                }
                Some(self.bend(x, accepted)?)
            }
            other => other.map(|accepted| accepted.energy),
        };
        self.before = Some(energy);
        let gain = energy - newton.unwrap_or(energy);
        let is_slow = gain <= LITTLE_GAIN * self.objective.energy_scale();
        if at_saddle && is_slow && self.settings.at_saddle != AtSaddle::Stop {
            let point = Point {
                x,
                energy,
                gradient: &self.gradient,
                exact: &self.exact,
                relaxed: &self.relaxed,
            };
            let curvature =
                search_curvature(self.objective, self.kkt, &mut self.generator, &point)?;
            // The better of the two, not one after the other: that saved a tenth of the iterations,
            // but made an unstructured film choose another number of waves.
            if let Some(curvature) = curvature
                && newton.is_none_or(|reached| curvature.energy < reached)
            {
                for (x, step) in x.iter_mut().zip(&curvature.step) {
                    *x += step;
                }
                return Ok(true);
            }
        }
        if newton.is_some() {
            x.copy_from_slice(&self.trial);
        }
        // Where nothing descends at a saddle that was only guessed, the next iteration looks.
        Ok(newton.is_some() || self.convexifier.has_guessed())
    }
}
