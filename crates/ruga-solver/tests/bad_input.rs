//! Mistakes in the input are errors that name them, never panics.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use ruga_solver::{
    ConstraintRows, Kkt, LoadSettings, LoadStepper, LowerPattern, NewtonSettings, Objective,
    SolverError, StopRule, minimise,
};

/// `sum of stiffness x^2 / 2`.
struct Springs {
    pattern: LowerPattern,
    stiffness: f64,
    damping: Vec<f64>,
    energy_scale: f64,
}

fn springs(count: usize) -> Springs {
    Springs {
        pattern: diagonal(count),
        stiffness: 1.0,
        damping: vec![0.0; count],
        energy_scale: 1.0,
    }
}

fn diagonal(count: usize) -> LowerPattern {
    LowerPattern::new(
        (0..=count).collect::<Vec<_>>(),
        (0..).take(count).collect::<Vec<_>>(),
    )
    .unwrap()
}

impl Objective for Springs {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        0.5 * self.stiffness * x.iter().map(|x| x * x).sum::<f64>()
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        for (gradient, x) in gradient.iter_mut().zip(x) {
            *gradient = self.stiffness * x;
        }
        self.value(x)
    }
    fn hessian(&self, _: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        exact.fill(self.stiffness);
        relaxed.fill(self.stiffness);
    }
    fn damping(&self) -> &[f64] {
        &self.damping
    }
    fn energy_scale(&self) -> f64 {
        self.energy_scale
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
}

fn error_of(objective: &Springs, rhs: &[f64], x: &mut [f64], kkt: &mut Kkt) -> SolverError {
    minimise(
        objective,
        rhs,
        x,
        kkt,
        &NewtonSettings::default(),
        &mut |_| true,
    )
    .unwrap_err()
}

#[test]
fn malformed_patterns() {
    let of = |starts: &[usize], rows: &[u32]| {
        LowerPattern::new(starts.to_vec(), rows.to_vec()).unwrap_err()
    };
    assert_eq!(of(&[], &[]), SolverError::Empty);
    assert_eq!(of(&[0], &[]), SolverError::Empty);
    assert_eq!(
        of(&[1, 2], &[0, 0]),
        SolverError::MalformedStarts { position: 0 }
    );
    assert_eq!(
        of(&[0, 2, 1], &[0, 1]),
        SolverError::MalformedStarts { position: 2 }
    );
    assert_eq!(
        of(&[0, 1, 5], &[0, 1]),
        SolverError::MalformedStarts { position: 2 }
    );
    assert_eq!(
        of(&[0, 1, 1], &[0]),
        SolverError::MissingDiagonal { column: 1 }
    );
    assert_eq!(
        of(&[0, 1, 2], &[1, 1]),
        SolverError::MissingDiagonal { column: 0 }
    );
    assert_eq!(
        of(&[0, 3, 4], &[0, 1, 1, 1]),
        SolverError::Unsorted { line: 0 }
    );
    let beyond = SolverError::IndexOutOfRange {
        line: 0,
        index: 7,
        limit: 2,
    };
    assert_eq!(of(&[0, 2, 3], &[0, 7, 1]), beyond);
    let lists: [&[usize]; 2] = [&[0, 1], &[1, 4]];
    let beyond = SolverError::IndexOutOfRange {
        line: 1,
        index: 4,
        limit: 3,
    };
    assert_eq!(LowerPattern::from_stencils(3, lists).unwrap_err(), beyond);
    let size = 1 << 31;
    let none: [&[usize]; 0] = [];
    let refused = LowerPattern::from_stencils(size, none).unwrap_err();
    assert_eq!(refused, SolverError::TooLarge { size });
}

#[test]
fn malformed_constraints() {
    let of = |starts: &[usize], columns: &[usize], values: &[f64]| {
        ConstraintRows::new(starts.to_vec(), columns.to_vec(), values.to_vec(), 4).unwrap_err()
    };
    assert_eq!(
        of(&[], &[], &[]),
        SolverError::MalformedStarts { position: 0 }
    );
    assert_eq!(
        of(&[0, 2], &[2, 1], &[1.0; 2]),
        SolverError::Unsorted { line: 0 }
    );
    let beyond = SolverError::IndexOutOfRange {
        line: 0,
        index: 4,
        limit: 4,
    };
    assert_eq!(of(&[0, 1], &[4], &[1.0]), beyond);
    assert!(matches!(
        of(&[0, 1], &[0], &[]),
        SolverError::SizeMismatch { .. }
    ));
    assert!(matches!(
        of(&[0, 1], &[0], &[f64::NAN]),
        SolverError::NotFinite { index: 0, .. }
    ));
    let rows = ConstraintRows::none(4);
    assert!(matches!(
        rows.mul(&[0.0; 3], &mut []),
        Err(SolverError::SizeMismatch { .. })
    ));
}

#[test]
fn systems_that_do_not_fit() {
    let pattern = diagonal(4);
    let block = SolverError::BlockSize {
        unknowns: 4,
        block: 3,
    };
    let none = ConstraintRows::none(4);
    assert_eq!(Kkt::new(&pattern, &none, 3).unwrap_err(), block);
    assert!(matches!(
        Kkt::new(&pattern, &none, 0),
        Err(SolverError::BlockSize { .. })
    ));
    let other = ConstraintRows::none(5);
    assert!(matches!(
        Kkt::new(&pattern, &other, 1),
        Err(SolverError::SizeMismatch { .. })
    ));

    let mut kkt = Kkt::new(&pattern, &none, 1).unwrap();
    let unsolved = kkt.solve(&[1.0; 4], &[], &mut [0.0; 4], &mut []);
    assert_eq!(unsolved, Err(SolverError::NotFactorized));
    assert!(matches!(
        kkt.factorize(&[1.0; 3], &[0.0; 4]),
        Err(SolverError::SizeMismatch { .. })
    ));
    let infinite = [1.0, f64::INFINITY, 1.0, 1.0];
    assert!(matches!(
        kkt.factorize(&infinite, &[0.0; 4]),
        Err(SolverError::NotFinite { index: 1, .. })
    ));
    kkt.factorize(&[1.0; 4], &[0.0; 4]).unwrap();
    let short = kkt.solve(&[1.0; 3], &[], &mut [0.0; 4], &mut []);
    assert!(matches!(short, Err(SolverError::SizeMismatch { .. })));
    let nan = kkt.solve(&[f64::NAN; 4], &[], &mut [0.0; 4], &mut []);
    assert!(matches!(nan, Err(SolverError::NotFinite { .. })));
}

#[test]
fn objectives_that_do_not_fit() {
    let mut kkt = Kkt::new(&diagonal(4), &ConstraintRows::none(4), 1).unwrap();
    let good = springs(4);
    assert_eq!(
        error_of(&springs(5), &[], &mut [0.0; 5], &mut kkt),
        SolverError::PatternMismatch
    );
    assert!(matches!(
        error_of(&good, &[], &mut [0.0; 3], &mut kkt),
        SolverError::SizeMismatch { .. }
    ));
    assert!(matches!(
        error_of(&good, &[1.0], &mut [0.0; 4], &mut kkt),
        SolverError::SizeMismatch { .. }
    ));
    assert!(matches!(
        error_of(&good, &[], &mut [f64::NAN; 4], &mut kkt),
        SolverError::NotFinite { .. }
    ));
    let scale = Springs {
        energy_scale: 0.0,
        ..springs(4)
    };
    assert!(matches!(
        error_of(&scale, &[], &mut [1.0; 4], &mut kkt),
        SolverError::Setting { .. }
    ));
}

#[test]
fn energies_that_are_not_finite_and_rows_that_disagree_are_data() {
    let mut kkt = Kkt::new(&diagonal(2), &ConstraintRows::none(2), 1).unwrap();
    let broken = Springs {
        stiffness: f64::NAN,
        ..springs(2)
    };
    let settings = NewtonSettings::default();
    let report = minimise(
        &broken,
        &[],
        &mut [1.0; 2],
        &mut kkt,
        &settings,
        &mut |_| true,
    )
    .unwrap();
    assert_eq!(
        (report.stop, report.converged),
        (StopRule::OutsideDomain, false)
    );

    let twice = ConstraintRows::new(vec![0, 1, 2], vec![0, 0], vec![1.0; 2], 2).unwrap();
    let mut kkt = Kkt::new(&diagonal(2), &twice, 1).unwrap();
    let rhs = [1.0, 2.0];
    let mut x = [0.0; 2];
    let report = minimise(&springs(2), &rhs, &mut x, &mut kkt, &settings, &mut |_| {
        true
    })
    .unwrap();
    assert_eq!(
        (report.stop, report.converged),
        (StopRule::Infeasible, false)
    );
    assert!(report.infeasibility > 0.1);
    assert!(x.iter().all(|entry| entry.is_finite()));
}

#[test]
fn settings_outside_their_range() {
    let mut kkt = Kkt::new(&diagonal(2), &ConstraintRows::none(2), 1).unwrap();
    let bad = [
        NewtonSettings {
            max_iterations: 0,
            ..Default::default()
        },
        NewtonSettings {
            energy_tolerance: f64::NAN,
            ..Default::default()
        },
        NewtonSettings {
            residual_tolerance: -1.0,
            ..Default::default()
        },
        NewtonSettings {
            first_relaxation: 1.1,
            ..Default::default()
        },
        NewtonSettings {
            first_relaxation: f64::NAN,
            ..Default::default()
        },
    ];
    for settings in bad {
        let result = minimise(
            &springs(2),
            &[],
            &mut [0.0; 2],
            &mut kkt,
            &settings,
            &mut |_| true,
        );
        assert!(matches!(result, Err(SolverError::Setting { .. })));
    }
    for keys in [&[0.0, 1.0][..], &[0.5, 0.5], &[0.5, 1.1], &[f64::NAN]] {
        let result = LoadStepper::new(keys, LoadSettings::default());
        assert!(matches!(result, Err(SolverError::Setting { .. })));
    }
    for growth in [1.0, 1.0 + f64::EPSILON, f64::INFINITY, f64::NAN] {
        let settings = LoadSettings {
            growth,
            ..Default::default()
        };
        assert!(LoadStepper::new(&[1.0], settings).is_err(), "{growth}");
    }
    for smallest_step in [0.0, 1e-300, 1.0, f64::NAN] {
        let settings = LoadSettings {
            smallest_step,
            ..Default::default()
        };
        assert!(
            LoadStepper::new(&[1.0], settings).is_err(),
            "{smallest_step}"
        );
    }
}

/// `x y`, a saddle without any stiffness of its own.
struct BareSaddle {
    pattern: LowerPattern,
}

impl Objective for BareSaddle {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        x[0] * x[1]
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.copy_from_slice(&[x[1], x[0]]);
        self.value(x)
    }
    fn hessian(&self, _: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        // On the diagonal next to nothing, which shifts are measured by.
        exact.copy_from_slice(&[1e-30, 1.0, 1e-30]);
        relaxed.copy_from_slice(exact);
    }
    fn force_scale(&self) -> f64 {
        1.0
    }
}

#[test]
fn a_hessian_that_no_shift_mends_ends_the_solve_and_says_so() {
    let pattern = LowerPattern::new(vec![0, 2, 3], vec![0, 1, 1]).unwrap();
    let mut kkt = Kkt::new(&pattern, &ConstraintRows::none(2), 1).unwrap();
    let saddle = BareSaddle { pattern };
    let mut x = [1.0, 2.0];
    let settings = NewtonSettings::default();
    let report = minimise(&saddle, &[], &mut x, &mut kkt, &settings, &mut |_| true).unwrap();
    assert_eq!(
        (report.stop, report.converged),
        (StopRule::Breakdown, false)
    );
    assert_eq!(x, [1.0, 2.0]);
}
