//! What the solves of all patches took together.

use ruga_solver::{Inertia, Iteration, NewtonSettings, SolveReport, StopRule};

/// What the solves of all patches took together, each counted by its share of the layer.
#[derive(Clone, Default)]
pub(super) struct Work {
    iterations: f64,
    factorizations: f64,
    relaxation: f64,
    first_relaxation: f64,
    shift: f64,
    left_saddle: bool,
}

impl Work {
    pub(super) fn add(&mut self, report: &SolveReport, share: f64) {
        self.iterations += share * report.iterations as f64;
        self.factorizations += share * report.factorizations as f64;
        self.relaxation = self.relaxation.max(report.relaxation_used);
        self.first_relaxation = self.first_relaxation.max(report.first_relaxation);
        self.shift = self.shift.max(report.shift_used);
        self.left_saddle |= report.left_saddle;
    }

    /// For those who watch: only the count is of the whole.
    pub(super) fn iteration(&self, settings: &NewtonSettings) -> Iteration {
        Iteration {
            index: self.iterations as usize,
            energy: f64::NAN,
            decrement: settings.energy_tolerance,
            residual: f64::NAN,
            relaxation: self.relaxation,
        }
    }

    /// The report of all, from the last one of every patch; `stop` is why the sweeps ended early.
    pub(super) fn report(
        self,
        last: &[Option<SolveReport>],
        stop: Option<StopRule>,
    ) -> SolveReport {
        let last = || last.iter().flatten();
        let failed = last().find(|report| !report.converged);
        let most = |of: fn(&SolveReport) -> f64| last().map(of).fold(0.0, f64::max);
        let inertias: Option<Vec<Inertia>> = last().map(|report| report.inertia).collect();
        SolveReport {
            converged: stop.is_none() && failed.is_none(),
            stop: stop.unwrap_or(failed.map_or(StopRule::Decrement, |report| report.stop)),
            iterations: self.iterations.ceil() as usize,
            factorizations: self.factorizations.ceil() as usize,
            energy: last().map(|report| report.energy).sum(),
            residual: most(|report| report.residual),
            decrement: last().map(|report| report.decrement).sum(),
            infeasibility: most(|report| report.infeasibility),
            inertia: inertias.map(|all| Inertia {
                negative: all.iter().map(Inertia::excess).sum(),
                rows: 0,
            }),
            relaxation_used: self.relaxation,
            first_relaxation: self.first_relaxation,
            shift_used: self.shift,
            left_saddle: self.left_saddle,
            multipliers: Vec::new(),
        }
    }
}
