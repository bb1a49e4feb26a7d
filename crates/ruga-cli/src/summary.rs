//! What a run of several poses comes to: the report, the table, the outcome.

use ruga_io::{PoseReport, Report};

use crate::arguments::RunArguments;
use crate::error::{CliError, counted};
use crate::folder_results::FolderResults;
use crate::messages;
use crate::planned::Planned;
use crate::pose_record::PoseRecord;
use crate::project::Project;
use crate::run::Outcome;
use crate::table::{ABSENT, duration, number, table};

/// Where each warning can be read when several were said as one.
pub(crate) const ALL_IN_REPORT: &str = "all are in report.json";

/// Writes `report.json`, prints the results and says how the run ended.
///
/// The report has every pose in the folder that fits the scene; table and outcome are about `poses`,
/// those of this run.
///
/// # Errors
/// The report or a record cannot be written.
pub(crate) fn conclude(
    project: &Project,
    plan: &Planned,
    arguments: &RunArguments,
    poses: &[Option<PoseRecord>],
    results: &FolderResults,
) -> Result<Outcome, CliError> {
    let own: Vec<&PoseRecord> = poses.iter().flatten().collect();
    let finished = own.iter().filter(|pose| !pose.report.interrupted);
    let missing = poses.len() - finished.count();
    let report = report(project, plan, results, (missing, poses.len()));
    report.write(&arguments.output.join("report.json"))?;
    results.remove_leftovers()?;
    say_warnings(project, plan, &own, results);
    if arguments.json {
        messages::result(&report.to_json());
    } else {
        if !own.is_empty() {
            messages::result(&results_table(&own));
        }
        let others = results.current.len().saturating_sub(own.len());
        if others > 0 {
            let others = counted(others, "pose");
            messages::result(&format!("{others} of earlier runs are listed with these."));
        }
        let folder = arguments.output.display();
        messages::result(&format!("Results are in {folder}; see report.json there."));
    }
    if missing > 0 {
        messages::note(&format!(
            "interrupted: {} left; finished poses are whole and finished keys are kept, `--resume` \
             continues",
            counted(missing, "pose")
        ));
        return Ok(Outcome::Incomplete);
    }
    Ok(convergence(own.iter().map(|pose| &pose.report)))
}

/// The report of all poses in the folder, with every warning once.
fn report(
    project: &Project,
    plan: &Planned,
    results: &FolderResults,
    (missing, asked): (usize, usize),
) -> Report {
    let mut report = Report::new(
        env!("CARGO_PKG_VERSION"),
        project.path.to_string_lossy().into_owned(),
    );
    let of_poses = results.current.iter().flat_map(|pose| &pose.warnings);
    let all = project.warnings.iter().chain(plan.warnings());
    for warning in all.chain(of_poses).chain(&results.notes) {
        if !report.warnings.contains(warning) {
            report.warnings.push(warning.clone());
        }
    }
    if missing > 0 {
        let missing = counted(missing, "pose");
        report
            .warnings
            .push(format!("interrupted: {missing} of {asked} not finished"));
    }
    report.poses = results.current.iter().map(|r| r.report.clone()).collect();
    report
}

/// Says what has not been said before the poses were simulated.
fn say_warnings(project: &Project, plan: &Planned, own: &[&PoseRecord], results: &FolderResults) {
    let said: Vec<&String> = project.warnings.iter().chain(plan.warnings()).collect();
    let of_poses = own.iter().flat_map(|pose| &pose.warnings);
    let new = of_poses.chain(&results.notes);
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
        "{} did not converge: {}; the results are written and marked in report.json",
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
