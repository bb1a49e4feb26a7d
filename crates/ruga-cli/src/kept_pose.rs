//! Poses of earlier runs that serve another one.

use crate::pose_inputs::ScenePose;
use crate::pose_record::{PoseRecord, Records};

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
