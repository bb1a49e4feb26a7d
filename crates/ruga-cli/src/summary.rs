//! What a run of several poses comes to: the report, the table, the outcome.

use ruga_io::{PoseReport, Report};
use ruga_scene::{Scene, ScenePlan, counted};

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::folder_results::FolderResults;
use crate::messages;
use crate::outcome::Outcome;
use crate::pose_record::PoseRecord;
use crate::table::{ABSENT, duration, number, table};

/// Words that tell where each warning can be read when several were said as one.
pub(crate) const ALL_IN_REPORT: &str = "all are in report.json";

/// The poses of a run, or the error that ended it.
pub(crate) type RunPoses = Result<Vec<Option<PoseRecord>>, CliError>;

/// The poses as they are, unless an error ended the run and neither it nor an earlier one has left
/// anything for manifest and report to list.
///
/// # Errors
/// That of the run, when nothing is to be written any more.
pub(crate) fn unless_nothing_is_there(
    poses: RunPoses,
    arguments: &RunArguments,
    results: &FolderResults,
) -> Result<RunPoses, CliError> {
    let has_report = || arguments.output.join("report.json").exists();
    match poses {
        Err(error) if results.current.is_empty() && !has_report() => Err(error),
        poses => Ok(poses),
    }
}

/// The error that ended the run, where it could not be concluded either: `then` is said, if it is
/// not that.
pub(crate) fn first_error(poses: RunPoses, then: CliError) -> CliError {
    match poses {
        Ok(_) => then,
        Err(first) => {
            messages::error(then);
            first
        }
    }
}

/// Writes `report.json`, prints the results and says how the run ended.
///
/// The report has every pose in the folder that fits the scene; table and outcome are about `poses`,
/// those of this run. After an error it is written all the same: maps of poses that were finished
/// before have replaced those that an earlier report describes.
///
/// # Errors
/// That of the run; the report or a record cannot be written.
pub(crate) fn conclude(
    scene: &Scene,
    plan: &ScenePlan,
    arguments: &RunArguments,
    poses: RunPoses,
    results: &FolderResults,
) -> Result<Outcome, CliError> {
    let path = arguments.output.join("report.json");
    let poses = match poses {
        Ok(poses) => poses,
        Err(error) => {
            let ending = format!("the run was ended by an error: {error}");
            let report = report(scene, plan, results, Some(ending));
            return match report.write(&path) {
                Ok(()) => Err(error),
                Err(then) => Err(first_error(Err(error), then.into())),
            };
        }
    };
    let own: Vec<&PoseRecord> = poses.iter().flatten().collect();
    let finished = own.iter().filter(|pose| !pose.report.interrupted);
    let missing = poses.len() - finished.count();
    let ending = (missing > 0).then(|| {
        let missing = counted(missing, "pose");
        format!("interrupted: {missing} of {} not finished", poses.len())
    });
    let report = report(scene, plan, results, ending);
    report.write(&path)?;
    results.remove_leftovers()?;
    say_warnings(scene, plan, &own, &results.notes);
    if arguments.json {
        messages::result(&report.to_json());
    } else {
        if !own.is_empty() {
            messages::result(&results_table(&own));
        }
        let others = results.current.len().saturating_sub(own.len());
        if others > 0 {
            let verb = if others == 1 { "is" } else { "are" };
            let others = counted(others, "pose");
            messages::result(&format!(
                "{others} of earlier runs {verb} listed with these."
            ));
        }
        let folder = arguments.output.display();
        messages::result(&format!("Results are in {folder}; see report.json there."));
    }
    if missing > 0 {
        return Ok(interrupted(missing));
    }
    Ok(convergence(own.iter().map(|pose| &pose.report)))
}

/// Prints what a task has made and says how it ended.
///
/// A task that has baked its poses is done also where one did not converge: a farm would take it for
/// failed, and never come to the merge, which says so and lists the pose.
pub(crate) fn conclude_task(
    scene: &Scene,
    plan: &ScenePlan,
    poses: &[Option<PoseRecord>],
) -> Outcome {
    let own: Vec<&PoseRecord> = poses.iter().flatten().collect();
    say_warnings(scene, plan, &own, &[]);
    if !own.is_empty() {
        messages::result(&results_table(&own));
    }
    let finished = own.iter().filter(|pose| !pose.report.interrupted);
    let missing = poses.len() - finished.count();
    if missing > 0 {
        return interrupted(missing);
    }
    convergence(own.iter().map(|pose| &pose.report));
    Outcome::Done
}

fn interrupted(missing: usize) -> Outcome {
    messages::note(&format!(
        "interrupted: {} left; finished poses are whole and finished keys are kept, `--resume` continues",
        counted(missing, "pose")
    ));
    Outcome::Incomplete
}

/// The report of all poses in the folder, with every warning once; `ending` says what kept the run
/// from making all that it was asked for.
fn report(
    scene: &Scene,
    plan: &ScenePlan,
    results: &FolderResults,
    ending: Option<String>,
) -> Report {
    let mut report = Report::new(
        env!("CARGO_PKG_VERSION"),
        scene.path.to_string_lossy().into_owned(),
    );
    let of_poses = results.current.iter().flat_map(|pose| &pose.warnings);
    let all = scene.warnings.iter().chain(plan.warnings());
    for warning in all.chain(of_poses).chain(&results.notes) {
        if !report.warnings.contains(warning) {
            report.warnings.push(warning.clone());
        }
    }
    report.warnings.extend(ending);
    report.poses = results.current.iter().map(|r| r.report.clone()).collect();
    report
}

/// Says what has not been said before the poses were simulated.
fn say_warnings(scene: &Scene, plan: &ScenePlan, own: &[&PoseRecord], notes: &[String]) {
    let said: Vec<&String> = scene.warnings.iter().chain(plan.warnings()).collect();
    let of_poses = own.iter().flat_map(|pose| &pose.warnings);
    let new = of_poses.chain(notes);
    messages::warnings(new.filter(|warning| !said.contains(warning)), ALL_IN_REPORT);
}

fn convergence<'a>(poses: impl Iterator<Item = &'a PoseReport>) -> Outcome {
    let failed: Vec<String> = poses
        .filter(|pose| !pose.converged)
        .map(|pose| format!("`{}`", pose.name))
        .collect();
    if failed.is_empty() {
        return Outcome::Done;
    }
    messages::warning(&format!(
        "{} did not converge: {}; there results may be too shallow, too deep or in the wrong place. \
         The results are written and marked in report.json; `keys` closer together may help, or on a soft body or a sheet more `steps`",
        counted(failed.len(), "pose"),
        failed.join(", ")
    ));
    Outcome::Incomplete
}

fn results_table(poses: &[&PoseRecord]) -> String {
    let mut rows = Vec::new();
    for pose in poses.iter().map(|pose| &pose.report) {
        for layer in &pose.layers {
            let length = |metres: Option<f64>| number(1e3 * metres.unwrap_or(f64::NAN), 2, "mm");
            let wrinkled = layer.wavelength_m.and(layer.amplitude_m);
            let seconds = layer.seconds.total.unwrap_or(0.0) * f64::from(pose.frames.max(1));
            rows.push(vec![
                pose.name.clone(),
                layer.name.clone(),
                if pose.converged { "yes" } else { "NO" }.to_owned(),
                layer.vertices.map_or(ABSENT.to_owned(), |n| n.to_string()),
                length(layer.wavelength_predicted_m),
                length(layer.wavelength_m),
                length(wrinkled),
                duration(seconds),
            ]);
        }
    }
    let headings = [
        "pose",
        "layer",
        "converged",
        "vertices",
        "predicted",
        "wavelength",
        "amplitude",
        "time",
    ];
    table(&headings, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pose_that_did_not_converge_makes_the_run_incomplete() {
        let pose = |converged| PoseReport {
            converged,
            ..PoseReport::default()
        };
        let outcome = |poses: [PoseReport; 2]| convergence(poses.iter());
        assert_eq!(outcome([pose(true), pose(true)]), Outcome::Done);
        assert_eq!(outcome([pose(true), pose(false)]), Outcome::Incomplete);
    }
}
