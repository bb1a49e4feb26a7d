//! Poses and the memory that a run may need.

use ruga_scene::{Scene, ScenePlan};

use crate::error::CliError;
use crate::kept_pose::kept_pose;
use crate::memory_size::MemorySize;
use crate::pose_inputs::scene_poses;
use crate::pose_record::Records;

/// Memory that a pose is expected to need, in whole bytes.
pub(crate) fn planned_bytes(plan: &ScenePlan, pose: usize) -> u64 {
    plan.pose_memory(pose).ceil() as u64
}

/// Refuses a limit that is too low for one of the poses by itself. Of a run that goes on with the poses in
/// `earlier` records, those that are finished need nothing.
///
/// # Errors
/// [`CliError::TooLittleMemory`] naming the pose that needs most; the scene file, or an image, has gone.
pub(crate) fn refuse_too_little(
    limit: Option<&MemorySize>,
    scene: &Scene,
    plan: &ScenePlan,
    earlier: Option<&Records>,
) -> Result<(), CliError> {
    let Some(limit) = limit else {
        return Ok(());
    };
    let mut large: Vec<usize> = (0..scene.poses.len()).collect();
    large.retain(|&pose| planned_bytes(plan, pose) > limit.bytes);
    if let (Some(records), false) = (earlier, large.is_empty()) {
        let points = scene.modelling.points_per_wavelength;
        let inputs = scene_poses(scene)?;
        let finished = inputs
            .iter()
            .filter(|pose| kept_pose(records, pose, points).is_ok());
        let finished: Vec<&str> = finished.map(|pose| pose.name.as_str()).collect();
        large.retain(|&pose| !finished.contains(&scene.poses[pose].name.as_str()));
    }
    let Some(&largest) = large.iter().max_by_key(|&&pose| planned_bytes(plan, pose)) else {
        return Ok(());
    };
    Err(CliError::TooLittleMemory {
        scene: scene.path.clone(),
        pose: scene.poses[largest].name.clone(),
        needed: MemorySize::rounded_up(planned_bytes(plan, largest)),
        limit: limit.clone(),
        others: large.len() - 1,
    })
}
