//! Fires that tests light on flat sheets of paper.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, Smoothing};
use ruga_material::ShrinkLaw;
use ruga_stepper::{
    Dynamics, Fire, FireReport, FireSource, FrontDesign, GrowthDirection, Heats, Modelling,
    PoseResult, PoseSpec, Sheet, Silent, StepperError, plan_sheet,
};

use crate::flat_sheet::{clamp, paper};

/// Temperature of what sets paper on fire, K.
pub(crate) const EMBER: f64 = 1500.0;

/// A front of 2 mm/s and 4 mm on paper of which nothing falls off, and that neither shrinks nor curls.
pub(crate) fn fire(sources: Vec<FireSource>) -> Fire {
    Fire {
        front: FrontDesign {
            speed: 2e-3,
            width: 4e-3,
            ignition: 573.0,
            burning: 1100.0,
            surroundings: 293.0,
            loss_time: None,
        },
        edges_per_width: 2.0,
        speed: None,
        shrink: ShrinkLaw {
            along: 0.0,
            across: 0.0,
            asymmetry: 0.0,
            char_young: 0.1,
            char_thickness: 0.8,
        },
        grain: GrowthDirection::Angle(0.0),
        shrink_factor: None,
        asymmetry_factor: None,
        char_mass: 0.2,
        ash_share: 0.0,
        ash_paint: None,
        least_piece: 1e-6,
        sources,
    }
}

pub(crate) fn ball(x: f64, y: f64, radius: f64) -> FireSource {
    FireSource {
        name: format!("ball at {x} {y}"),
        temperature: EMBER,
        heats: Heats::Ball {
            centre: Vector3::new(x, y, 0.0),
            radius,
            coefficient: 50.0,
        },
    }
}

pub(crate) fn sheet(fire: Fire) -> Sheet {
    Sheet {
        gravity: Vector3::zeros(),
        handles: vec![clamp(1e-3)],
        obstacles: Vec::new(),
        edge: Some(2.1e-3),
        fire: Some(fire),
    }
}

pub(crate) fn pose(steps: u32) -> PoseSpec {
    PoseSpec {
        name: "burn".into(),
        weights: Default::default(),
        keys: vec![0.6, 1.0],
        steps,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }
}

/// A fire of so many steps of so many seconds.
pub(crate) fn run(
    driver: &Arc<Driver>,
    sheet: &Sheet,
    (steps, time_step): (u32, f64),
) -> Result<PoseResult, StepperError> {
    run_pose(driver, sheet, pose(steps), time_step)
}

pub(crate) fn run_pose(
    driver: &Arc<Driver>,
    sheet: &Sheet,
    pose: PoseSpec,
    time_step: f64,
) -> Result<PoseResult, StepperError> {
    let modelling = modelling(time_step);
    let plan = plan_sheet(driver, &paper(Vec::new()), sheet, &[pose], &modelling, 512)?;
    plan.simulate(0, &mut Silent)
}

pub(crate) fn modelling(time_step: f64) -> Modelling {
    Modelling {
        dynamics: Some(Dynamics {
            time_step,
            damping: 2.0,
        }),
        smoothing: Smoothing::None,
        ..Modelling::default()
    }
}

pub(crate) fn burnt(result: &PoseResult) -> &FireReport {
    assert!(result.converged, "{:?}", result.warnings);
    result.layers[0].fire.as_ref().expect("a fire")
}

/// Mass of a square metre of the fresh paper, kg.
pub(crate) const PAPER: f64 = 800.0 * 1e-4;
