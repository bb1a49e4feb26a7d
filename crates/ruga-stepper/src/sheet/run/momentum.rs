//! Momentum of a sheet that burns freely.
//!
//! Fuel leaves with the velocity of its place, so that the momentum of what is left is not constant. In a step it is:
//! with the masses that are left, the forces of a step change no sum of mass times velocity.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::Driver;

use super::test_fires::{fire, modelling, paper, pose};
use super::{HALVINGS, SheetRun};
use crate::run::layer_run::Ending;
use crate::test_drivers::square;
use crate::{Dynamics, PoseResult, Sheet, Silent, plan_sheet};

const STEPS: u32 = 16;
const TIME_STEP: f64 = 0.25;

/// A front from a corner that curls what it burns; nothing holds the sheet.
fn burning() -> Sheet {
    Sheet {
        gravity: Vector3::zeros(),
        handles: Vec::new(),
        obstacles: Vec::new(),
        edge: Some(4e-3),
        fire: Some(fire(4e-3, Vector3::new(0.02, 0.02, 0.0), 8e-3)),
    }
}

/// Largest change of momentum by a step's forces over the mass of the fresh sheet times the front's speed, and how far
/// something has moved out of the plane, m.
fn drift() -> (f64, f64) {
    let flat = |p: nalgebra::Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
    let driver: Arc<Driver> = Arc::new(square(&flat, &flat));
    let modelling = modelling(Dynamics {
        time_step: TIME_STEP,
        damping: 0.0,
    });
    let pose = pose(STEPS);
    let sheet = burning();
    let plan = plan_sheet(&driver, &paper(), &sheet, &[pose], &modelling, 512).expect("a plan");
    let made = plan.sheet_state(&sheet, 0, &mut Silent);
    let state = made.expect("a sheet");
    let result = PoseResult {
        layers: plan.reports(0),
        ..PoseResult::default()
    };
    let mut run = SheetRun::new(&plan, (&sheet, 0), state, result).expect("a run");
    let fresh: f64 = run.state.meshed.masses.iter().sum();
    let mut velocities = vec![Vector3::zeros(); run.state.vertex_count()];
    let mut largest = 0.0_f64;
    for step in 0..STEPS {
        let before = run.state.moving.positions.clone();
        let times = [step, step + 1].map(|at| f64::from(at) / f64::from(STEPS));
        let ending = run.step(times, HALVINGS, &mut Silent).expect("a step");
        assert!(ending == Ending::Reached && run.solves == step as usize + 1);
        let ways = run.state.moving.positions.iter().zip(&before);
        let new: Vec<Vector3<f64>> = ways.map(|(x, y)| (x - y) / TIME_STEP).collect();
        let changes = new.iter().zip(&velocities).zip(&run.state.meshed.masses);
        let change: Vector3<f64> = changes.map(|((new, old), m)| (new - old) * *m).sum();
        largest = largest.max(change.norm() / (fresh * 2e-3));
        velocities = new;
    }
    let heights = run.state.moving.positions.iter().map(|x| x.z);
    let spread = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
    (largest, spread)
}

/// Within rounding, whatever a solve leaves.
#[test]
fn forces_within_a_free_sheet_do_not_change_its_momentum() {
    let (drift, height) = drift();
    assert!(height > 1e-3, "it curls by {height} m");
    assert!(drift < 1e-9, "{drift}");
}
