//! One pose of a body from rest to its keys.

use ruga_blend::Driver;

use super::plan::BodyPlan;
use super::run::BodyRun;
use crate::error::Halt;
use crate::validation::{check_body_modelling, check_pose};
use crate::{BodyPose, LayerReport, Modelling, Observer, PoseResult, StepperError};

/// Simulates a pose of a body under a layer: both at once, as one minimum of all energies.
///
/// Handles and obstacles go their ways and blend shapes draw the surface with growing weights; from
/// load to load the body is in equilibrium, and a load at which something first buckles is
/// approached by bisection, so that the wavelength is chosen at the onset. With
/// [`Modelling::dynamics`] every load is one step in time instead, whole where the solver finds its
/// end, or else in shorter ones, and nothing waits at keys for rest. Weight acts in full from the
/// first load on. Not converging is reported, not an error; the results reached until
/// then are kept. [`KeyResult::artist_positions`](crate::KeyResult::artist_positions) say where the
/// artist's mesh has gone.
///
/// # Errors
/// [`StepperError::Setting`] for a value out of range or that is no number;
/// [`StepperError::OtherPlan`] for a driver or modelling that the plan was not made for; a motion of something that is not there, or whose keyframes do not ascend; an obstacle without a
/// shape; what shell, constraints, remeshing or solver refuse.
pub fn simulate_body(
    driver: &Driver,
    plan: &BodyPlan,
    pose: &BodyPose,
    modelling: &Modelling,
    observer: &mut dyn Observer,
) -> Result<PoseResult, StepperError> {
    check_body_modelling(modelling)?;
    check_pose(driver, &pose.pose)?;
    plan.made_for.check(driver, modelling)?;
    let made = BodyRun::new(driver, plan, pose, modelling, observer);
    let Some(mut run) = Halt::unless_interrupted(made)? else {
        return Ok(interrupted(plan));
    };
    run.follow(observer)?;
    Ok(run.into_result())
}

/// The result of a run that the observer ended before its first step.
fn interrupted(plan: &BodyPlan) -> PoseResult {
    PoseResult {
        layers: vec![LayerReport {
            name: plan.spec.name.clone(),
            wavelength_predicted: plan.wavelength,
            critical_strain_predicted: plan.critical_strain,
            ..LayerReport::default()
        }],
        interrupted: true,
        ..PoseResult::default()
    }
}
