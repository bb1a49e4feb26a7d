//! What a run of several poses comes to: the report, the table, the outcome.

use ruga_io::{PoseReport, Report};

use crate::arguments::RunArguments;
use crate::error::{CliError, counted};
use crate::messages;
use crate::planned::Planned;
use crate::pose_record::PoseRecord;
use crate::project::Project;
use crate::run::Outcome;
use crate::table::{ABSENT, duration, number, table};

/// Writes `report.json`, prints the results and says how the run ended.
///
/// # Errors
/// The report cannot be written.
pub(crate) fn conclude(
    project: &Project,
    plan: &Planned,
    arguments: &RunArguments,
    records: &[Option<PoseRecord>],
) -> Result<Outcome, CliError> {
    let finished: Vec<&PoseRecord> = records.iter().flatten().collect();
    let missing = records.len() - finished.len();
    let mut report = Report::new(
        env!("CARGO_PKG_VERSION"),
        project.path.to_string_lossy().into_owned(),
    );
    let own = finished.iter().flat_map(|record| &record.warnings);
    let all = project.warnings.iter().chain(plan.warnings()).chain(own);
    report.warnings = all.cloned().collect();
    if missing > 0 {
        report.warnings.push(format!(
            "interrupted: {} of {} not simulated",
            counted(missing, "pose"),
            records.len()
        ));
    }
    report.poses = finished.iter().map(|r| r.report.clone()).collect();
    report.write(&arguments.output.join("report.json"))?;
    if arguments.json {
        messages::result(&report.to_json());
    } else {
        if !report.poses.is_empty() {
            messages::result(&results_table(&report.poses));
        }
        let folder = arguments.output.display();
        messages::result(&format!("Results are in {folder}; see report.json there."));
    }
    if missing > 0 {
        messages::note(&format!(
            "interrupted: {} left; finished poses are whole, `--resume` continues",
            counted(missing, "pose")
        ));
        return Ok(Outcome::Incomplete);
    }
    Ok(convergence(&report.poses))
}

fn convergence(poses: &[PoseReport]) -> Outcome {
    let failed: Vec<String> = poses
        .iter()
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

fn results_table(poses: &[PoseReport]) -> String {
    let mut rows = Vec::new();
    for pose in poses {
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
        assert_eq!(convergence(&[pose(true), pose(true)]), Outcome::Done);
        assert_eq!(convergence(&[pose(true), pose(false)]), Outcome::Incomplete);
    }
}
