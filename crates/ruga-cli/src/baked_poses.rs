//! Poses that tasks have baked, for a merge.

use ruga_scene::Scene;

use crate::arguments::quality_words;
use crate::error::CliError;
use crate::kept_pose::{Unusable, kept_pose};
use crate::output_folder::OutputFolder;
use crate::pose_record::{PoseRecord, Records};

/// Poses that an error names.
const NAMED: usize = 10;

/// The wanted poses of the scene, each finished and as fine as asked for.
///
/// # Errors
/// [`CliError::NotBaked`] naming those that are not, and why.
pub(crate) fn baked_poses(
    scene: &Scene,
    folder: &OutputFolder,
    records: &Records,
) -> Result<Vec<Option<PoseRecord>>, CliError> {
    let asked = scene.modelling.points_per_wavelength;
    let (mut baked, mut missing) = (Vec::new(), Vec::new());
    for spec in &scene.poses {
        match kept_pose(records, folder.pose(&spec.name), asked) {
            Ok(record) => baked.push(Some(record)),
            Err(fault) => missing.push(format!("`{}` {}", spec.name, in_words(&fault, asked))),
        }
    }
    if missing.is_empty() {
        return Ok(baked);
    }
    let count = missing.len();
    missing.truncate(NAMED);
    if count > NAMED {
        missing.push(format!("and {} more", count - NAMED));
    }
    Err(CliError::NotBaked {
        path: records.output.clone(),
        count,
        poses: missing.join("; "),
    })
}

/// Why a pose cannot be merged, as what is said of it.
fn in_words(fault: &Unusable, asked: f64) -> String {
    match fault {
        Unusable::Absent => "has no record that can be read".to_owned(),
        Unusable::Older => {
            "was made from an older version of the scene, its mesh, its images or of ruga"
                .to_owned()
        }
        Unusable::NotWhole => "lacks some of its files".to_owned(),
        Unusable::Interrupted { keys } => {
            format!("was interrupted when only its keys {keys:?} were finished")
        }
        Unusable::Coarser { points } => format!(
            "has {}, coarser than {}",
            quality_words(*points),
            quality_words(asked)
        ),
    }
}
