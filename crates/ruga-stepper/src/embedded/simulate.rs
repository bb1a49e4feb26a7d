//! One pose of a body from rest to its keys.

use ruga_blend::Driver;

use super::plan::BodyPlan;
use super::run::BodyRun;
use crate::{BodyPose, Modelling, Observer, PoseResult, StepperError};

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
/// A motion of something that is not there, or whose keyframes do not ascend; an obstacle without a
/// shape; what shell, constraints, remeshing or solver refuse.
pub fn simulate_body(
    driver: &Driver,
    plan: &BodyPlan,
    pose: &BodyPose,
    modelling: &Modelling,
    observer: &mut dyn Observer,
) -> Result<PoseResult, StepperError> {
    let mut run = BodyRun::new(driver, plan, pose, modelling, observer)?;
    run.follow(observer)?;
    Ok(run.into_result())
}
