//! A rope that sags onto a floor: what touches it first is in the way of all else.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use ruga_solver::{
    ConstraintRows, Iteration, Kkt, LowerPattern, NewtonSettings, Objective, SolveReport, StopRule,
    minimise,
};

const POINTS: usize = 60;
const TENSION: f64 = 1e3;
const WEIGHT: f64 = 10.0;
const FLOOR: f64 = 1e6;

/// Heights of a rope between two held ends at height 1:
/// `sum T/2 (z_i+1 - z_i)^2 + w z_i + F/2 min(z_i, 0)^2`.
struct Rope {
    pattern: LowerPattern,
    damping: Vec<f64>,
}

impl Rope {
    fn new() -> Self {
        let pairs: Vec<[usize; 2]> = (1..POINTS).map(|i| [i - 1, i]).collect();
        let stencils = pairs.iter().map(<[usize; 2]>::as_slice);
        Self {
            pattern: LowerPattern::from_stencils(POINTS, stencils).unwrap(),
            damping: vec![1e-9; POINTS],
        }
    }

    /// With its ends.
    fn heights(z: &[f64]) -> Vec<f64> {
        [&[1.0], z, &[1.0]].concat()
    }
}

impl Objective for Rope {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, z: &[f64]) -> f64 {
        let rise = |pair: &[f64]| 0.5 * TENSION * (pair[1] - pair[0]).powi(2);
        let ropes: f64 = Self::heights(z).windows(2).map(rise).sum();
        let of_point = |z: &f64| WEIGHT * z + 0.5 * FLOOR * z.min(0.0).powi(2);
        ropes + z.iter().map(of_point).sum::<f64>()
    }

    fn gradient(&self, z: &[f64], gradient: &mut [f64]) -> f64 {
        let heights = Self::heights(z);
        for (i, entry) in gradient.iter_mut().enumerate() {
            let bend = 2.0 * heights[i + 1] - heights[i] - heights[i + 2];
            *entry = TENSION * bend + WEIGHT + FLOOR * z[i].min(0.0);
        }
        self.value(z)
    }

    fn hessian(&self, z: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        exact.fill(-TENSION);
        for (i, z) in z.iter().enumerate() {
            let touch = if *z < 0.0 { FLOOR } else { 0.0 };
            let diagonal = self.pattern.position(i, i).unwrap();
            exact[diagonal] = 2.0 * TENSION + touch;
        }
        relaxed.copy_from_slice(exact);
    }

    fn damping(&self) -> &[f64] {
        &self.damping
    }

    fn energy_scale(&self) -> f64 {
        WEIGHT
    }

    fn force_scale(&self) -> f64 {
        WEIGHT
    }
}

/// From a shallow bow just above the floor.
fn solve(
    overshoot: bool,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> (SolveReport, Vec<f64>) {
    let rope = Rope::new();
    let mut kkt = Kkt::new(&rope.pattern, &ConstraintRows::none(POINTS), 1).unwrap();
    let bow = |i: usize| 1e-3 + ((i as f64 - 29.5) / 30.0).powi(2);
    let mut z: Vec<f64> = (0..POINTS).map(bow).collect();
    let settings = NewtonSettings {
        overshoot,
        ..NewtonSettings::default()
    };
    let solve = minimise(&rope, &[], &mut z, &mut kkt, &settings, keep_going);
    (solve.unwrap(), z)
}

#[test]
fn whole_steps_find_what_touches_sooner() {
    let [(slow, shortened), (fast, whole)] =
        [false, true].map(|overshoot| solve(overshoot, &mut |_| true));
    assert!(slow.converged && fast.converged, "{slow:?} {fast:?}");
    let pairs = shortened.iter().zip(&whole);
    let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-5, "{apart}");
    assert!(
        5 * fast.factorizations < 4 * slow.factorizations,
        "{} of {}",
        fast.factorizations,
        slow.factorizations
    );
}

#[test]
fn wherever_it_is_interrupted_the_energy_has_fallen() {
    let (all, _) = solve(true, &mut |_| true);
    let mut last = f64::INFINITY;
    for end in 0..all.iterations {
        let (report, z) = solve(true, &mut |iteration| iteration.index < end);
        let energy = Rope::new().value(&z);
        assert!(energy <= last, "{end}: {energy} {last}");
        assert!(report.energy == energy, "{end}: {} {energy}", report.energy);
        last = energy;
    }
}

/// A slope that ends in a cliff up, whose second derivatives know of neither: from one the step is too
/// long, on the other too short.
struct Cliff {
    pattern: LowerPattern,
}

impl Objective for Cliff {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, z: &[f64]) -> f64 {
        z[0].max(-20.0 * z[0])
    }

    fn gradient(&self, z: &[f64], gradient: &mut [f64]) -> f64 {
        gradient[0] = if z[0] < 0.0 { -20.0 } else { 1.0 };
        self.value(z)
    }

    fn hessian(&self, z: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        exact[0] = if z[0] < 0.0 { 1e6 } else { 0.5 };
        relaxed[0] = exact[0];
    }

    fn damping(&self) -> &[f64] {
        &[1e-9]
    }
}

#[test]
fn a_whole_step_that_nothing_makes_up_for_is_taken_back() {
    let cliff = Cliff {
        pattern: LowerPattern::from_stencils(1, [[0].as_slice()]).unwrap(),
    };
    let settings = NewtonSettings {
        overshoot: true,
        max_iterations: 2,
        ..NewtonSettings::default()
    };
    let mut kkt = Kkt::new(&cliff.pattern, &ConstraintRows::none(1), 1).unwrap();
    let (mut z, mut energies) = ([1.0], Vec::new());
    let report = minimise(&cliff, &[], &mut z, &mut kkt, &settings, &mut |iteration| {
        energies.push(iteration.energy);
        true
    })
    .unwrap();
    assert!(energies[1] > 10.0 * energies[0], "{energies:?}");
    assert_eq!(report.stop, StopRule::IterationLimit);
    assert!((0.0..1.0).contains(&z[0]), "{z:?}");
    assert!(report.energy == z[0], "{} {z:?}", report.energy);
}
