//! Simulates poses and hands each to what `bake` or `simulate` makes of it.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::thread;

use ruga_io::{LayerReport, PoseReport, Seconds, WrinkleMap};
use ruga_stepper::StopRule;
use ruga_stepper::{Frame, PoseResult, PoseSpec};

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::fingerprint::Fingerprint;
use crate::planned::Planned;
use crate::pose_queue::run_all;
use crate::pose_record::PoseRecord;
use crate::progress::PoseProgress;
use crate::project::Project;
use crate::table::duration;
use crate::watch::Watch;

/// The files of one pose.
#[derive(Debug, Default)]
pub(crate) struct PoseFiles {
    /// Entries of the manifest.
    pub(crate) maps: Vec<WrinkleMap>,
    /// Every file, relative to the output folder.
    pub(crate) files: Vec<String>,
    /// What the user should know, without the pose's name.
    pub(crate) warnings: Vec<String>,
}

/// What a command makes of a pose.
pub(crate) trait Product: Sync {
    /// Name of the command: poses made by another one are made again.
    const COMMAND: &'static str;

    /// Whether it has a use for load steps, not for keys alone.
    const WANTS_FRAMES: bool;

    /// Removes of earlier runs' files those among which new ones are about to appear: an
    /// interrupted run must not leave a mixture.
    fn begin(&self, pose: &PoseSpec);

    /// Writes a load step, if it is to be written; returns the files.
    fn frame(&self, pose: &PoseSpec, frame: &Frame<'_>) -> Result<Vec<String>, CliError>;

    /// Writes what the finished pose gives.
    fn pose(&self, pose: &PoseSpec, result: &PoseResult) -> Result<PoseFiles, CliError>;
}

/// Threads that were asked for, or one per core.
pub(crate) fn thread_count(arguments: &RunArguments) -> usize {
    let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
    arguments.threads.map_or_else(cores, NonZeroUsize::get)
}

/// Simulates every pose of the plan; `None` stands for a pose that was interrupted.
///
/// # Errors
/// The first pose that cannot be simulated or written.
pub(crate) fn run_poses<P: Product>(
    project: &Project,
    plan: &Planned,
    arguments: &RunArguments,
    product: &P,
) -> Result<Vec<Option<PoseRecord>>, CliError> {
    let count = project.poses.len();
    let run = PoseRun {
        project,
        plan,
        arguments,
        inputs: project.fingerprint()?.with(P::COMMAND.as_bytes()),
        progress: PoseProgress::new(count),
        product,
    };
    run_all(count, thread_count(arguments), |pose, given_up| {
        run.pose(pose, given_up)
    })
}

/// What all poses share.
struct PoseRun<'a, P> {
    project: &'a Project,
    plan: &'a Planned,
    arguments: &'a RunArguments,
    inputs: Fingerprint,
    progress: PoseProgress,
    product: &'a P,
}

impl<P: Product> PoseRun<'_, P> {
    fn pose(
        &self,
        index: usize,
        given_up: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<PoseRecord>, CliError> {
        let spec = &self.project.poses[index];
        let folder = &self.arguments.output;
        if self.arguments.resume
            && let Some(record) = PoseRecord::find(folder, &spec.name, self.inputs)
        {
            let name = &spec.name;
            self.progress
                .note(&format!("pose `{name}` is there from an earlier run"));
            return Ok(Some(record));
        }
        let earlier = PoseRecord::forget(folder, &spec.name)?;
        self.product.begin(spec);
        let bar = self.progress.start(&spec.name, index + 1);
        let record = self.simulate(index, &bar, given_up);
        let ending = match &record {
            Ok(Some(record)) => ending(&record.report),
            Ok(None) => "interrupted".to_owned(),
            Err(_) => "failed".to_owned(),
        };
        self.progress
            .end(&bar, &format!("pose `{}`: {ending}", spec.name));
        let record = record?;
        if let Some(record) = &record {
            record.remove_leftovers(folder, &earlier);
        }
        for warning in record.iter().flat_map(|record| &record.warnings) {
            self.progress.note(&format!("warning: {warning}"));
        }
        Ok(record)
    }

    fn simulate(
        &self,
        index: usize,
        bar: &indicatif::ProgressBar,
        given_up: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<PoseRecord>, CliError> {
        let project = self.project;
        let spec = &project.poses[index];
        let mut files = Vec::new();
        let mut sink = |frame: &Frame<'_>| {
            files.extend(self.product.frame(spec, frame)?);
            Ok(())
        };
        let mut watch = Watch::new(bar, given_up, P::WANTS_FRAMES, &mut sink);
        let result = self.plan.simulate(project, index, &mut watch);
        let result = result.map_err(|source| CliError::Simulation {
            scene: project.path.clone(),
            pose: spec.name.clone(),
            source: Box::new(source),
        })?;
        let seconds = watch.finish(result.layers.len(), result.frames)?;
        if result.interrupted {
            return Ok(None);
        }
        bar.set_message("writing");
        let mut made = self.product.pose(spec, &result)?;
        made.files.extend(files);
        let record = record(self.inputs, &spec.name, result, &seconds, made);
        record.write(&self.arguments.output)?;
        Ok(Some(record))
    }
}

fn record(
    inputs: Fingerprint,
    name: &str,
    result: PoseResult,
    seconds: &[Seconds],
    made: PoseFiles,
) -> PoseRecord {
    let maps: BTreeMap<String, String> = made
        .maps
        .iter()
        .map(|map| {
            let percent = ruga_io::key_percent(map.key);
            (format!("{percent}_{}", map.kind.word()), map.file.clone())
        })
        .collect();
    let about_maps = made.warnings.iter();
    let about_maps = about_maps.map(|warning| format!("pose '{name}': {warning}"));
    PoseRecord {
        inputs: inputs.text(),
        warnings: result.warnings.into_iter().chain(about_maps).collect(),
        report: PoseReport {
            name: name.to_owned(),
            converged: result.converged,
            frames: u32::try_from(result.frames).unwrap_or(u32::MAX),
            maps,
            layers: result
                .layers
                .into_iter()
                .zip(seconds)
                .map(|(layer, seconds)| layer_report(layer, seconds))
                .collect(),
        },
        maps: made.maps,
        files: made.files,
    }
}

fn layer_report(layer: ruga_stepper::LayerReport, seconds: &Seconds) -> LayerReport {
    let count = |n: usize| u64::try_from(n).ok();
    LayerReport {
        name: layer.name,
        vertices: count(layer.vertices),
        faces: count(layer.faces),
        constraints: count(layer.constraints),
        wavelength_predicted_m: Some(layer.wavelength_predicted),
        critical_strain_predicted: Some(layer.critical_strain_predicted),
        wavelength_m: layer.wavelength,
        amplitude_m: Some(layer.amplitude),
        energy_j: Some(layer.energy),
        newton_iterations: count(layer.newton_iterations),
        residual: Some(layer.residual),
        stop_rule: layer.stop.map(stop_rule),
        bending_ratio: layer.bending_ratio,
        seconds: seconds.clone(),
    }
}

fn stop_rule(rule: StopRule) -> String {
    match rule {
        StopRule::Decrement => "decrement",
        StopRule::Residual => "residual",
        StopRule::Saddle => "saddle",
        StopRule::IterationLimit => "iteration limit",
        StopRule::LineSearch => "line search",
        StopRule::Infeasible => "infeasible",
        StopRule::Breakdown => "breakdown",
        StopRule::OutsideDomain => "outside domain",
        StopRule::Interrupted => "interrupted",
    }
    .to_owned()
}

fn ending(report: &PoseReport) -> String {
    let layers = report.layers.iter();
    let seconds: f64 = layers.filter_map(|layer| layer.seconds.total).sum();
    if report.frames == 0 && report.converged {
        return "nothing to wrinkle".to_owned();
    }
    let time = duration(seconds * f64::from(report.frames.max(1)));
    match report.converged {
        true => format!("done in {time}"),
        false => format!("done in {time}, but it did not converge"),
    }
}
