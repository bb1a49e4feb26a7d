//! Unknowns left out of the system against the same unknowns held by rows.

use ruga_solver::{
    ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, Pinned, SolverError, minimise,
};

const COUNT: usize = 12;

/// Springs between neighbours that stiffen as they stretch, each weight pulled down by one.
struct Chain(LowerPattern);

impl Chain {
    fn new() -> Self {
        let pairs: Vec<[usize; 2]> = (1..COUNT).map(|i| [i - 1, i]).collect();
        let pattern = LowerPattern::from_stencils(COUNT, pairs.iter().map(|pair| &pair[..]));
        Self(pattern.expect("a chain"))
    }
}

impl Objective for Chain {
    fn pattern(&self) -> &LowerPattern {
        &self.0
    }
    fn value(&self, x: &[f64]) -> f64 {
        let stretch = x.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let springs = stretch.map(|s| 0.5 * s + 0.25 * s * s);
        springs.sum::<f64>() + x.iter().sum::<f64>()
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(1.0);
        for i in 1..COUNT {
            let stretch = x[i] - x[i - 1];
            let force = stretch + stretch.powi(3);
            gradient[i] += force;
            gradient[i - 1] -= force;
        }
        self.value(x)
    }
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        exact.fill(0.0);
        for i in 1..COUNT {
            let stiffness = 1.0 + 3.0 * (x[i] - x[i - 1]).powi(2);
            for (row, column, sign) in [(i, i, 1.0), (i - 1, i - 1, 1.0), (i, i - 1, -1.0)] {
                let entry = self.0.position(row, column).expect("an entry of the chain");
                exact[entry] += sign * stiffness;
            }
        }
        relaxed.copy_from_slice(exact);
    }
}

#[test]
fn pinned_unknowns_stay_and_the_others_are_as_with_rows() {
    let chain = Chain::new();
    let held = [0, 4, COUNT - 1];
    let mut start = vec![0.0; COUNT];
    start[4] = 0.5;
    let settings = NewtonSettings::default();

    let starts = (0..=held.len()).collect();
    let rows = ConstraintRows::new(starts, held.to_vec(), vec![1.0; held.len()], COUNT);
    let mut kkt = Kkt::new(chain.pattern(), &rows.expect("rows"), 1).expect("a system");
    let mut by_rows = start.clone();
    let rhs = held.map(|i| start[i]);
    let report = minimise(&chain, &rhs, &mut by_rows, &mut kkt, &settings, &mut |_| {
        true
    });
    assert!(report.expect("a valid system").converged);

    let pinned: Vec<bool> = (0..COUNT).map(|i| held.contains(&i)).collect();
    let reduced = Pinned::new(&chain, &pinned, &start).expect("free unknowns");
    let none = ConstraintRows::none(COUNT - held.len());
    let mut kkt = Kkt::new(reduced.pattern(), &none, 1).expect("a system");
    let mut x = reduced.free(&start);
    let report = minimise(&reduced, &[], &mut x, &mut kkt, &settings, &mut |_| true);
    assert!(report.expect("a valid system").converged);
    for (i, (eliminated, held_by_row)) in reduced.merge(&x).iter().zip(&by_rows).enumerate() {
        assert!((eliminated - held_by_row).abs() < 1e-6, "{i}");
        if pinned[i] {
            assert_eq!(*eliminated, start[i]);
        }
    }
}

#[test]
fn wrong_sizes_and_no_freedom_are_refused() {
    let chain = Chain::new();
    let refused = |pinned: &[bool], x: &[f64]| Pinned::new(&chain, pinned, x).err();
    let all = [true; COUNT];
    assert!(refused(&all[1..], &[0.0; COUNT]).is_some());
    assert!(refused(&[false; COUNT], &[0.0; 3]).is_some());
    assert!(refused(&[false; COUNT], &[f64::NAN; COUNT]).is_some());
    assert_eq!(refused(&all, &[0.0; COUNT]), Some(SolverError::Empty));
}
