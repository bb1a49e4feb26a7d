//! A valley that bends: the way down it is long, and straight steps hardly follow.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use ruga_solver::{
    ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, SolveReport, StressPrediction,
    minimise,
};

/// `k/4 (x^2 + y^2 - 1)^2 - e x`: a circular valley that slopes gently towards (1, 0).
struct Valley {
    stiffness: f64,
    slope: f64,
    pattern: LowerPattern,
    /// Whether its stresses can be predicted.
    predicts: bool,
}

impl Valley {
    /// Both Hessians at `x` where the spring is stretched by so much.
    fn write(&self, x: &[f64], excess: f64, exact: &mut [f64], relaxed: &mut [f64]) {
        let k = self.stiffness;
        for (values, excess) in [(exact, excess), (relaxed, excess.max(0.0))] {
            values[0] = k * (excess + 2.0 * x[0] * x[0]);
            values[1] = 2.0 * k * x[0] * x[1];
            values[2] = k * (excess + 2.0 * x[1] * x[1]);
        }
    }
}

impl StressPrediction for Valley {
    fn reach(&self, x: &[f64], step: &[f64]) -> f64 {
        let [length, radius] = [step, x].map(|v| v[0].hypot(v[1]));
        (0.5 * radius / length).min(1.0)
    }

    fn hessian(&self, x: &[f64], from: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let along = from[0] * (x[0] - from[0]) + from[1] * (x[1] - from[1]);
        let excess = from[0] * from[0] + from[1] * from[1] - 1.0 + 2.0 * along;
        self.write(x, excess, exact, relaxed);
    }
}

impl Objective for Valley {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        let excess = x[0] * x[0] + x[1] * x[1] - 1.0;
        0.25 * self.stiffness * excess * excess - self.slope * x[0]
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let excess = x[0] * x[0] + x[1] * x[1] - 1.0;
        gradient[0] = self.stiffness * excess * x[0] - self.slope;
        gradient[1] = self.stiffness * excess * x[1];
        self.value(x)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let excess = x[0] * x[0] + x[1] * x[1] - 1.0;
        self.write(x, excess, exact, relaxed);
    }

    fn prediction(&self) -> Option<&dyn StressPrediction> {
        self.predicts.then_some(self)
    }

    fn damping(&self) -> &[f64] {
        &[1e-9, 1e-9]
    }

    fn energy_scale(&self) -> f64 {
        self.slope
    }

    fn force_scale(&self) -> f64 {
        self.slope
    }
}

fn solve(predicts: bool) -> (SolveReport, [f64; 2]) {
    let valley = Valley {
        stiffness: 100.0,
        slope: 1e-2,
        pattern: LowerPattern::from_stencils(2, [[0, 1].as_slice()]).unwrap(),
        predicts,
    };
    let mut kkt = Kkt::new(&valley.pattern, &ConstraintRows::none(2), 1).unwrap();
    let mut x = [2f64.cos(), 2f64.sin()];
    let settings = NewtonSettings::default();
    let mut keep_going = |_: &_| true;
    let report = minimise(&valley, &[], &mut x, &mut kkt, &settings, &mut keep_going).unwrap();
    (report, x)
}

/// Straight steps alone take 80.
#[test]
fn bent_steps_follow_the_valley() {
    let (report, x) = solve(false);
    assert!(report.converged, "{report:?}");
    assert!((x[0] - 1.0).abs() < 1e-3 && x[1].abs() < 0.05, "{x:?}");
    assert!(report.iterations < 60, "{} iterations", report.iterations);
}

#[test]
fn predicted_stresses_follow_the_valley_in_fewer_steps() {
    let (report, x) = solve(true);
    assert!(report.converged, "{report:?}");
    assert!((x[0] - 1.0).abs() < 1e-3 && x[1].abs() < 0.05, "{x:?}");
    assert!(report.iterations < 30, "{} iterations", report.iterations);
}
