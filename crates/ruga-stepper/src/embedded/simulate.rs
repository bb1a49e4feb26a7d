//! One pose of a body from rest to its keys.

use super::plan::Interior;
use super::run::BodyRun;
use crate::error::Halt;
use crate::{Observer, Plan, PoseResult, StepperError};

/// Simulates pose number `pose` of a body under a layer: both at once, as one minimum of all energies.
///
/// # Errors
/// What shell, constraints, remeshing or solver refuse.
pub(crate) fn simulate_body(
    (plan, interior): (&Plan, &Interior),
    pose: usize,
    observer: &mut dyn Observer,
) -> Result<PoseResult, StepperError> {
    let made = BodyRun::new((plan, interior), pose, observer);
    let Some(mut run) = Halt::unless_interrupted(made)? else {
        return Ok(PoseResult {
            layers: plan.reports(pose),
            interrupted: true,
            ..PoseResult::default()
        });
    };
    run.follow(observer)?;
    Ok(run.into_result())
}
