//! `[memory]`: what the skin keeps of its poses.

use std::path::{Path, PathBuf};

use ruga_blend::nearest;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::{Checked, Fault, fault, shortly};
use super::validate::listed;
use super::{Pose, SceneFile};
use crate::SceneError;

/// The largest `weakening`: of a line with a tenth of the skin's stiffness it leaves a thousandth at twice `yield`.
const MOST_WEAKENING: f64 = 100.0;

/// `[memory]`: folds that stay. `ruga age` finds what poses leave in the skin and writes it into a file; a scene
/// that names the file has these folds in every pose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Memory {
    /// File that `ruga age` has written. Its lines are creases in every pose, and creases of the scene have in every
    /// pose what they keep.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub network: Option<PathBuf>,
    /// Poses that `ruga age` holds, each for itself; none: every pose of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<String>,
    /// What a crease gives back: it keeps what a pose folds it beyond this, degrees, from 1 to 150.
    #[serde(rename = "yield")]
    pub yield_angle: f64,
    /// The same of wrinkles: skin that turns by more than this across a valley, from flank to flank, keeps a line
    /// there, and of the angle what is beyond; degrees, from 10 to 180, where no wrinkle does.
    pub wrinkle_yield: f64,
    /// How much softer a line becomes: a crease that is folded by twice its `yield` gains this share of its
    /// softness; 0 to 100. Without any, 0, lines keep angles alone.
    pub weakening: f64,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            network: None,
            poses: Vec::new(),
            yield_angle: 20.0,
            wrinkle_yield: 45.0,
            weakening: 0.5,
        }
    }
}

impl SceneFile {
    /// Checks that `[memory]` names poses of the scene, which are `poses`; `path` is for messages.
    ///
    /// # Errors
    /// [`SceneError::Key`] for the first that is none.
    pub(crate) fn check_memory(&self, poses: &[Pose], path: &Path) -> Result<(), SceneError> {
        let unknown = self.unknown_memory_pose(poses);
        unknown.map_or(Ok(()), |fault| Err(fault.at(path)))
    }

    fn unknown_memory_pose(&self, poses: &[Pose]) -> Option<Fault> {
        let names = || poses.iter().map(|pose| pose.name.as_str());
        let wanted = self.memory.iter().flat_map(|memory| &memory.poses);
        let mut unknown = wanted
            .enumerate()
            .filter(|(_, name)| !names().any(|own| own == name.as_str()));
        unknown.next().map(|(i, name)| Fault {
            key: format!("memory.poses[{i}]"),
            reason: format!(
                "the scene has no pose `{name}`; accepted: {}",
                listed(names())
            ),
            suggestion: nearest(name, names()),
        })
    }

    pub(super) fn memory_faults(&self) -> Checked {
        let Some(memory) = &self.memory else {
            return Ok(());
        };
        let angles = [
            ("memory.yield", memory.yield_angle, [1.0, 150.0]),
            ("memory.wrinkle_yield", memory.wrinkle_yield, [10.0, 180.0]),
        ];
        for (key, angle, [least, most]) in angles {
            if !(least..=most).contains(&angle) {
                return fault(key, angle, &format!("degrees from {least} to {most}"));
            }
        }
        let weakening = memory.weakening;
        if !(0.0..=MOST_WEAKENING).contains(&weakening) {
            let accepted = "a number from 0 to 100; 0.5 is half as soft again";
            return fault("memory.weakening", shortly(weakening), accepted);
        }
        if memory.network.is_some() && self.driver.symmetry.is_some() {
            let accepted =
                "no `symmetry` with a network of creases, which may differ from side to side";
            return fault("driver.symmetry", "\"x\"", accepted);
        }
        Ok(())
    }
}
