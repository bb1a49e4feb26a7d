//! The mesh of a sheet that burns, before and after it is made anew.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use ruga_blend::Driver;

use super::test_fires::{fire, modelling, paper, pose};
use super::{HALVINGS, SheetRun};
use crate::run::layer_run::Ending;
use crate::test_drivers::{SIDE, square};
use crate::{Dynamics, Handle, PoseResult, Sheet, Silent, plan_sheet};

const STEPS: u32 = 14;

/// Length and width of a strip, m.
const LENGTH: f64 = 0.06;
const WIDTH: f64 = 0.006;

/// A strip that is held at one end and burns from the other, narrowly enough to need finer edges there.
fn burning() -> Sheet {
    let far = Vector3::new(0.5 * LENGTH, WIDTH, WIDTH);
    let mut fire = fire(0.8e-3, Vector3::new(0.5 * LENGTH, 0.0, 0.0), 2e-3);
    fire.ash_share = 0.0;
    let end = Vector3::new(1e-3 - 0.5 * LENGTH, WIDTH, WIDTH);
    Sheet {
        gravity: Vector3::zeros(),
        handles: vec![Handle {
            name: "end".into(),
            min: -far,
            max: end,
            turn: Matrix3::identity(),
            shift: Vector3::zeros(),
        }],
        obstacles: Vec::new(),
        edge: None,
        fire: Some(fire),
    }
}

/// A new mesh in the middle of a fire keeps what is there.
#[test]
fn a_new_mesh_keeps_mass_energy_and_shape() {
    let flat =
        |p: nalgebra::Vector2<f64>| Vector3::new(p.x * LENGTH / SIDE, p.y * WIDTH / SIDE, 0.0);
    let driver: Arc<Driver> = Arc::new(square(&flat, &flat));
    let modelling = modelling(Dynamics {
        time_step: 0.2,
        damping: 2.0,
    });
    let pose = pose(STEPS);
    let sheet = burning();
    let plan = plan_sheet(
        &driver,
        &paper(),
        &sheet,
        std::slice::from_ref(&pose),
        &modelling,
        512,
    );
    let plan = plan.expect("a plan");
    let state = plan.sheet_state(&sheet, 0, &mut Silent).expect("a sheet");
    let result = PoseResult {
        layers: plan.reports(0),
        ..PoseResult::default()
    };
    let mut run = SheetRun::new(&plan, (&sheet, 0), state, result).expect("a run");
    let even = run.state.region.skin.mesh.vertex_count();
    let mut jumps = Vec::new();
    for step in 0..STEPS {
        let times = [step, step + 1].map(|at| f64::from(at) / f64::from(STEPS));
        run.refit(times, &mut Silent).expect("a mesh");
        let ending = run.step(times, HALVINGS, &mut Silent).expect("a step");
        assert!(ending == Ending::Reached);
        if step < STEPS / 2 {
            continue;
        }
        let before = measures(&mut run);
        // A new mesh, whether it is needed or not.
        let zones = run.state.zones(&run.moves, times);
        let made = run.state.refit(&driver, &zones, &mut || true);
        assert!(made.is_ok());
        let after = measures(&mut run);
        assert!((after.mass / before.mass - 1.0).abs() < 1e-12);
        assert!(
            (after.end - before.end).norm() < 1e-5,
            "{after:?} {before:?}"
        );
        jumps.push((after.energy / before.energy - 1.0).abs());
        assert!(run.state.vertex_count() < even / 4, "{even}");
    }
    let most = jumps.iter().copied().fold(0.0, f64::max);
    assert!(most < 0.01, "{jumps:?}");
}

#[derive(Debug)]
struct Measures {
    /// Mass, kg.
    mass: f64,
    /// Elastic energy, J.
    energy: f64,
    /// Place of a corner of the burning end, m.
    end: Vector3<f64>,
}

/// What a new mesh should not change.
fn measures(run: &mut SheetRun<'_>) -> Measures {
    let (fire, burning) = run.state.fire().expect("a fire");
    let remains = fire.remains(burning).expect("shares");
    let (driver, pose) = (&run.plan.driver, run.pose);
    let shaped = run.state.shape(driver, pose, 1.0, Some(remains));
    shaped.expect("a shape");
    let state = &run.state;
    let at = state.on_region(&state.moving.positions);
    let region = state.region.skin.rest.positions.iter().zip(at);
    let far = region.max_by(|a, b| a.0.x.total_cmp(&b.0.x));
    Measures {
        mass: state.meshed.masses.iter().sum(),
        energy: state.elastic_energy(),
        end: far.expect("vertices").1,
    }
}
