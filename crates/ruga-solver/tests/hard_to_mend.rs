//! Hessians that relaxation hardly mends, or not at all: every solve comes to an end.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use ruga_solver::{
    AtSaddle, ConstraintRows, Iteration, Kkt, LoadSettings, LoadStepper, LowerPattern,
    NewtonSettings, Objective, Outcome, SolveReport, StopRule, minimise,
};

/// `d x^4/4 + a x^2/2 + c y^2/2 + b x y`, with what is left of it when relaxed.
struct Quartic {
    /// `d`, `a`, `c`, `b`.
    energy: [f64; 4],
    /// Diagonal entries and the one beside them.
    relaxed: [f64; 3],
    pattern: LowerPattern,
}

impl Quartic {
    fn new(energy: [f64; 4], relaxed: [f64; 3]) -> Self {
        Self {
            energy,
            relaxed,
            pattern: LowerPattern::from_stencils(2, [[0, 1].as_slice()]).unwrap(),
        }
    }
}

impl Objective for Quartic {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        let [d, a, c, b] = self.energy;
        0.25 * d * x[0].powi(4) + 0.5 * a * x[0] * x[0] + 0.5 * c * x[1] * x[1] + b * x[0] * x[1]
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let [d, a, c, b] = self.energy;
        gradient[0] = d * x[0].powi(3) + a * x[0] + b * x[1];
        gradient[1] = c * x[1] + b * x[0];
        self.value(x)
    }
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let [d, a, c, b] = self.energy;
        exact.copy_from_slice(&[3.0 * d * x[0] * x[0] + a, b, c]);
        let [first, second, beside] = self.relaxed;
        relaxed.copy_from_slice(&[first, beside, second]);
    }
    fn force_scale(&self) -> f64 {
        1.0
    }
}

/// Factorisations that a single iteration may take: the search for a relaxation, then for a shift.
const MOST_PER_ITERATION: usize = 35;

fn solve(quartic: &Quartic, at_saddle: AtSaddle) -> (SolveReport, [f64; 2]) {
    let mut kkt = Kkt::new(&quartic.pattern, &ConstraintRows::none(2), 1).unwrap();
    let mut x = [0.0; 2];
    let settings = NewtonSettings {
        at_saddle,
        ..NewtonSettings::default()
    };
    let mut asked = 0;
    let mut keep_going = |_: &Iteration| {
        asked += 1;
        true
    };
    let report = minimise(quartic, &[], &mut x, &mut kkt, &settings, &mut keep_going).unwrap();
    assert_eq!(asked, report.iterations, "{report:?}");
    let most = MOST_PER_ITERATION * report.iterations.max(1);
    assert!(report.factorizations <= most, "{report:?}");
    (report, x)
}

/// From the saddle at the origin to `x^2 = 2`, `y = -x`, whatever full relaxation leaves.
#[test]
fn a_relaxed_hessian_without_full_rank_is_enough() {
    let double_well = [1.0, -1.0, 1.0, 1.0];
    for relaxed in [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 1.0],
        [1e-12, 1e-12, 0.0],
        [0.0, 1.0, 1.0],
    ] {
        let (report, x) = solve(&Quartic::new(double_well, relaxed), AtSaddle::Leave);
        assert!(
            report.converged && report.left_saddle,
            "{relaxed:?} {report:?}"
        );
        assert!((x[0].abs() - 2f64.sqrt()).abs() < 1e-3, "{relaxed:?} {x:?}");
        assert!((x[0] + x[1]).abs() < 1e-3, "{relaxed:?} {x:?}");
        let (report, _) = solve(&Quartic::new(double_well, relaxed), AtSaddle::Stop);
        assert_eq!(report.stop, StopRule::Saddle, "{relaxed:?}");
    }
}

/// Where the last step gained less than the tolerance and the next one promises no more, the solve ends at a saddle,
/// else it goes on.
#[test]
fn a_saddle_is_passed_where_little_is_to_be_gained() {
    // Wells at x = 1 and -1, .25 deep; with so much stiffness left that every step is a short one.
    let stiff = [20.0, 1.0, 0.0];
    let (report, _) = passed(stiff, 0.3, 0.05);
    assert!(report.converged && !report.inertia.unwrap().is_minimum());
    assert_eq!(report.stop, StopRule::Decrement);
    // The first step has to show that there is nothing to gain. What was too little for it is not tried again.
    assert_eq!((report.iterations, report.factorizations), (2, 5));

    let (report, x) = passed(stiff, 0.3, 1e-8);
    assert!(report.converged && report.inertia.unwrap().is_minimum());
    assert!((x - 1.0).abs() < 1e-3, "{x}");

    // Without a force the way down is looked for first.
    let (_, x) = passed([0.0, 1.0, 0.0], 0.0, 0.05);
    assert!(x.abs() > 0.3, "{x}");
}

/// Of 30 double wells three are a hundred times as shallow as the others, and are left to the next solve. Where there
/// are more of them than a tenth, the solve goes on.
#[test]
fn the_last_few_modes_are_passed() {
    for shallow in [3, 0, 6] {
        let depths = (0..30).map(|i| if i < shallow { 1e-2 } else { 1.0 });
        let wells = Wells::new(depths.collect());
        let settings = NewtonSettings {
            at_saddle: AtSaddle::PassFew,
            energy_tolerance: 1e-3,
            ..NewtonSettings::default()
        };
        let mut kkt = Kkt::new(&wells.pattern, &ConstraintRows::none(30), 1).unwrap();
        let mut x: Vec<f64> = (0..30).map(|i| 1e-6 * (1.0 + f64::from(i))).collect();
        let goes_on = &mut |_: &Iteration| true;
        let report = minimise(&wells, &[], &mut x, &mut kkt, &settings, goes_on).unwrap();
        assert!(report.converged && report.left_saddle, "{report:?}");
        let left = report.inertia.unwrap().excess();
        assert!(left <= 3, "{shallow}: {left} are left");
        assert!(shallow != 3 || left == 3, "{left} are left");
        let report = minimise(&wells, &[], &mut x, &mut kkt, &settings, goes_on).unwrap();
        assert!(report.inertia.unwrap().is_minimum(), "{report:?}");
        for (i, x) in x[shallow..].iter().enumerate() {
            assert!(
                (x.abs() - 1.0).abs() < 0.02,
                "{shallow}: deep well {i} at {x}"
            );
        }
    }
}

/// Double wells with their lowest places at 1 and -1, relaxed to a stiffness of 1 at `x = 0` whatever their depth.
struct Wells {
    depths: Vec<f64>,
    pattern: LowerPattern,
}

impl Wells {
    fn new(depths: Vec<f64>) -> Self {
        let alone: Vec<[usize; 1]> = (0..depths.len()).map(|i| [i]).collect();
        let lists = alone.iter().map(|i| i.as_slice());
        Self {
            pattern: LowerPattern::from_stencils(depths.len(), lists).unwrap(),
            depths,
        }
    }
}

impl Objective for Wells {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        let wells = x.iter().zip(&self.depths);
        wells
            .map(|(x, d)| d * (0.25 * x.powi(4) - 0.5 * x * x))
            .sum()
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        for ((gradient, x), d) in gradient.iter_mut().zip(x).zip(&self.depths) {
            *gradient = d * (x.powi(3) - x);
        }
        self.value(x)
    }
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        for (i, (x, d)) in x.iter().zip(&self.depths).enumerate() {
            exact[i] = d * (3.0 * x * x - 1.0);
            relaxed[i] = 3.0 * d * x * x + 1.0;
        }
    }
    fn force_scale(&self) -> f64 {
        1.0
    }
}

/// A solve that only a diagonal mends is stuck, also where it would pass a saddle.
#[test]
fn no_collapse_is_passed() {
    let (report, _) = passed([-2.9, 20.0, 0.0], 0.1, 0.05);
    assert!(report.shift_used > 0.0, "{report:?}");
    assert_eq!(report.stop, StopRule::Breakdown, "{report:?}");
}

/// A solve from `x`, 0 in a double well with what is `relaxed` of it, to this tolerance; and x where it ends.
fn passed(relaxed: [f64; 3], x: f64, energy_tolerance: f64) -> (SolveReport, f64) {
    let quartic = Quartic::new([1.0, -1.0, 1.0, 0.0], relaxed);
    let mut kkt = Kkt::new(&quartic.pattern, &ConstraintRows::none(2), 1).unwrap();
    let mut x = [x, 0.0];
    let settings = NewtonSettings {
        at_saddle: AtSaddle::Pass,
        energy_tolerance,
        first_relaxation: 0.9,
        ..NewtonSettings::default()
    };
    let goes_on = &mut |_: &Iteration| true;
    let report = minimise(&quartic, &[], &mut x, &mut kkt, &settings, goes_on).unwrap();
    (report, x[0])
}

/// Nothing resists anywhere: the start is as good as any place.
#[test]
fn an_energy_without_any_stiffness_is_at_rest() {
    let (report, x) = solve(&Quartic::new([0.0; 4], [0.0; 3]), AtSaddle::Leave);
    assert!(report.converged, "{report:?}");
    assert_eq!(x, [0.0; 2]);
}

/// Energies without a lower bound, some of which no relaxation mends, only a shift.
#[test]
fn an_energy_that_falls_for_ever_ends_without_converging() {
    for (energy, relaxed) in [
        ([0.0, -1.0, -1.0, 0.0], [-1.0, -1.0, 0.0]),
        ([0.0, -1.0, -1.0, 0.0], [0.0, 0.0, 0.0]),
        ([0.0, -1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]),
        ([-1.0, -1.0, 1.0, 1.0], [0.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
        ([0.0, -1e12, 1.0, 0.0], [-1e12, 1.0, 0.0]),
    ] {
        let quartic = Quartic::new(energy, relaxed);
        let (report, _) = solve(&quartic, AtSaddle::Leave);
        assert!(!report.converged, "{energy:?} {report:?}");
        let (report, _) = solve(&quartic, AtSaddle::Stop);
        assert!(!report.converged, "{energy:?} {report:?}");
    }
}

/// Whatever trials come to, the loads come to an end: here all just beyond a load fail, or buckle.
#[test]
fn loads_come_to_an_end() {
    for beyond in [Outcome::Failed, Outcome::Buckled] {
        for limit in [0.0, 0.1 + 0.2, 1.0 / 3.0] {
            let settings = LoadSettings {
                growth: 1.001,
                bracket: 1.0 + f64::EPSILON,
                landing: 1.0 + f64::EPSILON,
                smallest_step: 1e-9,
            };
            let mut loads = LoadStepper::new(&[1.0], settings).unwrap();
            let mut trials = 0;
            while let Some(trial) = loads.next_trial() {
                loads.report(if trial.load > limit {
                    beyond
                } else {
                    Outcome::Stable
                });
                trials += 1;
                assert!(trials < 100_000, "{beyond:?} {limit} {trial:?}");
            }
        }
    }
}
