//! MINRES against the factorisation where both work, and its stalls.

use ruga_solver::{
    ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, SolveReport, minimise,
};
use ruga_validation::baselines::{LinearWork, MinresLimits, Problem, minimise_iterated};

const VERTICES: usize = 40;
const UNKNOWNS: usize = 3 * VERTICES;

/// A hanging chain of springs on a soft foundation, with a quartic that keeps it convex.
struct Chain {
    pattern: LowerPattern,
}

fn chain() -> Chain {
    let stencils: Vec<Vec<usize>> = (0..VERTICES - 1)
        .map(|v| (3 * v..3 * v + 6).collect())
        .collect();
    let lists = stencils.iter().map(Vec::as_slice);
    Chain {
        pattern: LowerPattern::from_stencils(UNKNOWNS, lists).unwrap(),
    }
}

impl Objective for Chain {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        let links = x.iter().zip(&x[3..]).map(|(a, b)| {
            let stretch = b - a;
            0.5 * stretch.powi(2) + 0.25 * stretch.powi(4)
        });
        let ground = x.iter().map(|x| 0.005 * x * x + 0.01 * x);
        links.sum::<f64>() + ground.sum::<f64>()
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        for (gradient, x) in gradient.iter_mut().zip(x) {
            *gradient = 0.01 * x + 0.01;
        }
        for i in 0..UNKNOWNS - 3 {
            let stretch = x[i + 3] - x[i];
            let force = stretch + stretch.powi(3);
            gradient[i] -= force;
            gradient[i + 3] += force;
        }
        self.value(x)
    }
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        exact.fill(0.0);
        let mut add = |row, column, value| {
            exact[self.pattern.position(row, column).unwrap()] += value;
        };
        for i in 0..UNKNOWNS {
            add(i, i, 0.01);
        }
        for i in 0..UNKNOWNS - 3 {
            let stiffness = 1.0 + 3.0 * (x[i + 3] - x[i]).powi(2);
            add(i, i, stiffness);
            add(i + 3, i + 3, stiffness);
            add(i + 3, i, -stiffness);
        }
        relaxed.copy_from_slice(exact);
    }
    fn force_scale(&self) -> f64 {
        1.0
    }
}

/// Means of the first and the last third, per coordinate.
fn rows() -> (ConstraintRows, Vec<f64>) {
    let third = VERTICES / 3;
    let (mut starts, mut columns) = (vec![0], Vec::new());
    for first in [0, VERTICES - third] {
        for coordinate in 0..3 {
            columns.extend((first..first + third).map(|v| 3 * v + coordinate));
            starts.push(columns.len());
        }
    }
    let weights = vec![1.0 / third as f64; columns.len()];
    let rows = ConstraintRows::new(starts, columns, weights, UNKNOWNS).unwrap();
    (rows, vec![1.0, 0.0, -1.0, 2.0, 0.5, 0.0])
}

/// Solves with a factorisation, or by MINRES within `limits`.
fn solve(limits: Option<MinresLimits>) -> (Vec<f64>, SolveReport, LinearWork) {
    let objective = chain();
    let (rows, rhs) = rows();
    let mut kkt = Kkt::new(objective.pattern(), &rows, 3).unwrap();
    let settings = NewtonSettings {
        energy_tolerance: 0.0,
        residual_tolerance: 1e-9,
        ..Default::default()
    };
    let mut x = vec![0.0; UNKNOWNS];
    let Some(limits) = limits else {
        let report = minimise(&objective, &rhs, &mut x, &mut kkt, &settings, &mut |_| true);
        return (x, report.unwrap(), LinearWork::default());
    };
    let problem = Problem {
        objective: &objective,
        rhs: &rhs,
        kkt: &mut kkt,
    };
    let solved = minimise_iterated(problem, &mut x, &settings, limits, &mut |_| true);
    let (report, work) = solved.unwrap();
    (x, report, work)
}

#[test]
fn both_solvers_find_the_minimum_of_a_convex_energy() {
    let (direct, direct_report, _) = solve(None);
    let limits = MinresLimits {
        tolerance: 1e-12,
        max_iterations: 500,
    };
    let (iterative, iterative_report, work) = solve(Some(limits));
    assert!(direct_report.converged && iterative_report.converged);
    assert!(work.iterations > 10);
    assert_eq!(work.stalls, 0);
    assert_eq!(iterative_report.inertia, None);
    for (a, b) in direct.iter().zip(&iterative) {
        assert!((a - b).abs() < 1e-7);
    }
    for (a, b) in direct_report
        .multipliers
        .iter()
        .zip(&iterative_report.multipliers)
    {
        assert!((a - b).abs() < 1e-7);
    }
}

#[test]
fn stalls_are_counted() {
    let limits = MinresLimits {
        tolerance: 1e-12,
        max_iterations: 4,
    };
    let (x, report, work) = solve(Some(limits));
    assert!(work.stalls > 0);
    assert!(!report.converged);
    assert!(x.iter().all(|entry| entry.is_finite()));
}
