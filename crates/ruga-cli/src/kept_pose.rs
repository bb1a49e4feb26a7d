//! Poses of earlier runs that serve another one.

use ruga_scene::Scene;

use crate::arguments::quality_words;
use crate::output_folder::OutputFolder;
use crate::pose_inputs::ScenePose;
use crate::pose_record::{PoseRecord, Records};

/// What becomes of a finished pose without files that this run is to write.
const LACKS_FILES: &str =
    "is there without all of the formats that are asked for: it is made again";

/// Why what an output folder has of a pose does not serve.
#[derive(Debug)]
pub(crate) enum Unusable {
    /// There is no record, or none that can be read.
    Absent,
    /// The pose was made from other inputs than the scene's.
    Older,
    /// Some of its files are gone.
    NotWhole,
    /// The run ended when these keys were finished.
    Interrupted { keys: Vec<f64> },
    /// It has fewer vertices per wavelength than asked for.
    Coarser { points: f64 },
}

/// The pose as an earlier run left it, finished; `points` are the vertices per wavelength that are asked
/// for, and more do.
///
/// # Errors
/// Why it cannot be used.
pub(crate) fn kept_pose(
    records: &Records,
    pose: &ScenePose,
    points: f64,
) -> Result<PoseRecord, Unusable> {
    let record = records.read(&pose.name).ok_or(Unusable::Absent)?;
    if record.inputs != pose.inputs.text() {
        return Err(Unusable::Older);
    }
    if !record.is_whole(&records.output) {
        return Err(Unusable::NotWhole);
    }
    if record.report.interrupted {
        return Err(Unusable::Interrupted { keys: record.keys });
    }
    if record.points_per_wavelength < points {
        return Err(Unusable::Coarser {
            points: record.points_per_wavelength,
        });
    }
    Ok(record)
}

/// The poses of the scene as an earlier run left them, in its order; `None` stands for one that is to be
/// made, also because it is not `has_all`. `note` takes what the user should know of them.
///
/// A finer pose than asked for is kept, so that going on at a lower quality by mistake costs nothing.
pub(crate) fn kept_poses(
    records: &Records,
    scene: &Scene,
    folder: &OutputFolder,
    has_all: impl Fn(&PoseRecord) -> bool,
    note: impl Fn(&str),
) -> Vec<Option<PoseRecord>> {
    let asked = scene.modelling.points_per_wavelength;
    let poses = scene.poses.iter().map(|pose| {
        let kept = kept_pose(records, folder.pose(&pose.name), asked);
        let lacks_files = kept.as_ref().is_ok_and(|record| !has_all(record));
        let text = match lacks_files {
            true => Some(LACKS_FILES.to_owned()),
            false => what_becomes_of(&kept, asked),
        };
        if let Some(text) = text {
            note(&format!("pose `{}` {text}", pose.name));
        }
        kept.ok().filter(|_| !lacks_files)
    });
    poses.collect()
}

/// What becomes of a pose when `asked` vertices per wavelength are asked for; nothing is said of a new one.
fn what_becomes_of(kept: &Result<PoseRecord, Unusable>, asked: f64) -> Option<String> {
    let text = match kept {
        Ok(record) if record.points_per_wavelength > asked => format!(
            "is there from an earlier run at {}, finer than asked for: it is kept; without `--resume` it is \
             made again",
            quality_words(record.points_per_wavelength)
        ),
        Ok(_) => "is there from an earlier run".to_owned(),
        Err(Unusable::Absent) => return None,
        Err(Unusable::Older | Unusable::NotWhole) => {
            "is there from an older version of the scene, or not whole: it is made again".to_owned()
        }
        Err(Unusable::Interrupted { .. }) => {
            "was interrupted: it is made again; until then its finished keys are kept".to_owned()
        }
        Err(Unusable::Coarser { points }) => {
            let (found, asked) = (quality_words(*points), quality_words(asked));
            format!("is there at {found}: it is made again at {asked}")
        }
    };
    Some(text)
}
