//! The papers' search for the least residual, and their MINRES: where they stop, and what they say.

use ruga_solver::{
    ConstraintRows, Kkt, LowerPattern, Minimise, NewtonSettings, Objective, SolveReport, StopRule,
    minimise,
};
use ruga_validation::baselines::{by_minres, by_residual, by_residual_and_minres};

/// `y^2 + x^4/4 - x^2/2`: a saddle at the origin between two minima; or, with a wall, none of it from
/// `x = 1.2` on.
struct Wells {
    pattern: LowerPattern,
    wall: bool,
}

impl Objective for Wells {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        match self.wall && x[0] > 1.2 {
            true => f64::INFINITY,
            false => 0.25 * x[0].powi(4) - 0.5 * x[0] * x[0] + x[1] * x[1],
        }
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.copy_from_slice(&[x[0].powi(3) - x[0], 2.0 * x[1]]);
        self.value(x)
    }
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        exact.copy_from_slice(&[3.0 * x[0] * x[0] - 1.0, 2.0]);
        relaxed.copy_from_slice(&[3.0 * x[0] * x[0], 2.0]);
    }
    fn force_scale(&self) -> f64 {
        1.0
    }
}

fn solve(method: Minimise, wall: bool, x: &mut [f64; 2], row: Option<f64>) -> SolveReport {
    let pattern = LowerPattern::new(vec![0, 1, 2], vec![0, 1]).unwrap();
    let rows = match row {
        None => ConstraintRows::none(2),
        Some(_) => ConstraintRows::new(vec![0, 2], vec![0, 1], vec![1.0, 1.0], 2).unwrap(),
    };
    let mut kkt = Kkt::new(&pattern, &rows, 1).unwrap();
    let settings = NewtonSettings::default();
    let targets: Vec<f64> = row.into_iter().collect();
    let wells = Wells { pattern, wall };
    method(&wells, &targets, x, &mut kkt, &settings, &mut |_| true).unwrap()
}

#[test]
fn it_stops_at_a_saddle_that_the_energy_leaves() {
    let methods: [(Minimise, bool); 2] = [(by_residual, true), (by_residual_and_minres, false)];
    for (method, knows) in methods {
        let mut x = [0.3, 0.5];
        let report = solve(method, false, &mut x, None);
        assert!(report.converged && report.stop == StopRule::Residual);
        assert!(x[0].abs() < 1e-6 && x[1].abs() < 1e-6, "{x:?}");
        assert_eq!(report.inertia.is_some_and(|it| !it.is_minimum()), knows);
        assert_eq!(report.factorizations > 0, knows);
    }
    let mut x = [0.3, 0.5];
    let report = solve(minimise, false, &mut x, None);
    assert!(report.converged && (x[0].abs() - 1.0).abs() < 1e-3, "{x:?}");
}

#[test]
fn minres_stays_on_a_saddle_without_noticing() {
    let mut x = [0.0, 0.5];
    let report = solve(by_minres, false, &mut x, None);
    assert!(report.converged && report.inertia.is_none(), "{report:?}");
    assert!(x[0] == 0.0 && x[1].abs() < 1e-9, "{x:?}");
}

#[test]
fn constraints_hold_and_multipliers_balance_the_forces() {
    let methods: [Minimise; 3] = [by_residual, by_residual_and_minres, by_minres];
    for method in methods {
        let mut x = [2.0, 2.0];
        let report = solve(method, false, &mut x, Some(3.0));
        assert!(report.converged, "{report:?}");
        assert!((x[0] + x[1] - 3.0).abs() < 1e-6);
        let forces = [x[0].powi(3) - x[0], 2.0 * x[1]];
        for force in forces {
            assert!((force + report.multipliers[0]).abs() < 1e-6, "{report:?}");
        }
    }
}

#[test]
fn steps_stay_where_the_energy_is_finite() {
    // Close to where the Hessian is singular the first step leads far beyond the wall.
    let mut x = [0.6, 0.0];
    let report = solve(by_residual, true, &mut x, None);
    assert!(report.converged && report.energy.is_finite(), "{report:?}");
    assert!((x[0] - 1.0).abs() < 1e-6, "{x:?}");
    let mut outside = [2.0, 0.0];
    let methods: [Minimise; 2] = [by_residual, by_minres];
    for method in methods {
        let report = solve(method, true, &mut outside, None);
        assert_eq!(report.stop, StopRule::OutsideDomain);
    }
}
