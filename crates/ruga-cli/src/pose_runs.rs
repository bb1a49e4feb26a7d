//! Simulates poses and hands each to what `bake` or `simulate` makes of it.

use std::num::NonZeroUsize;
use std::thread;

use indicatif::ProgressBar;
use rayon::{ThreadPool, ThreadPoolBuilder};
use ruga_io::{PoseReport, Seconds, WrinkleMap};
use ruga_scene::{Scene, ScenePlan, counted};
use ruga_stepper::{Frame, PoseResult, PoseSpec};

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::kept_pose::kept_poses;
use crate::memory_limit::planned_bytes;
use crate::output_folder::OutputFolder;
use crate::pose_queue::{Capacity, Planned, run_all};
use crate::pose_record::{PoseRecord, Records};
use crate::pose_report::{ending, pose_report};
use crate::progress::PoseProgress;
use crate::table::duration;
use crate::time_left::TimeLeft;
use crate::warning_groups::is_about;
use crate::watch::{Wanted, Watch};

/// The files of one pose.
#[derive(Debug, Default)]
pub(crate) struct PoseFiles {
    /// Entries of the manifest.
    pub(crate) maps: Vec<WrinkleMap>,
    /// Every file, relative to the output folder.
    pub(crate) files: Vec<String>,
    /// Warnings for the user, without the pose's name.
    pub(crate) warnings: Vec<String>,
}

/// Product that a command makes of a pose.
pub(crate) trait Product: Sync {
    /// Whether it writes load steps as they come; else nothing is written before the pose is done,
    /// and an earlier run's files stay good until then.
    const WANTS_FRAMES: bool;

    /// Records of what has been made of poses so far.
    fn records(&self) -> &Records;

    /// Whether it has a use for the state of every triangle in every load step.
    fn wants_face_states(&self) -> bool {
        false
    }

    /// Whether an earlier run has made of a pose all that this one is to make.
    fn has_all_of(&self, record: &PoseRecord) -> bool {
        let _ = record;
        true
    }

    /// Removes of earlier runs' files those among which new ones are about to appear: an
    /// interrupted run must not leave a mixture.
    fn begin(&self, pose: &PoseSpec);

    /// Writes a load step, if it is to be written; returns the files.
    fn frame(&self, pose: &PoseSpec, frame: &Frame<'_>) -> Result<Vec<String>, CliError>;

    /// Writes what the pose gives; an interrupted one has fewer keys.
    fn pose(&self, pose: &PoseSpec, result: &PoseResult) -> Result<PoseFiles, CliError>;
}

/// Threads that were asked for, or one per core.
pub(crate) fn thread_count(arguments: &RunArguments) -> usize {
    let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
    arguments.threads.map_or_else(cores, NonZeroUsize::get)
}

/// Rayon's threads for the loops inside a simulation or a bake; the global pool stays untouched.
pub(crate) fn thread_pool(threads: usize) -> Result<ThreadPool, CliError> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| CliError::Threads {
            threads,
            reason: error.to_string(),
        })
}

/// Makes every pose of the plan that no earlier run has left; `None` stands for a pose that was interrupted
/// before its first key, or whose earlier results are better than what was reached.
///
/// # Errors
/// A pose that cannot be simulated or written; of several the one that began first.
pub(crate) fn run_poses<P: Product>(
    scene: &Scene,
    plan: &ScenePlan,
    arguments: &RunArguments,
    folder: &OutputFolder,
    product: &P,
) -> Result<Vec<Option<PoseRecord>>, CliError> {
    let progress = PoseProgress::new(scene.poses.len(), arguments);
    let mut poses = match arguments.resume {
        true => {
            let has_all = |record: &PoseRecord| product.has_all_of(record);
            let note = |text: &str| progress.note(text);
            kept_poses(product.records(), scene, folder, has_all, note)
        }
        false => vec![None; scene.poses.len()],
    };
    // Poses that are made of the same simulation, as mirror images are, are in work together.
    let mut to_be_made: Vec<Vec<usize>> = Vec::new();
    for pose in (0..poses.len()).filter(|&pose| poses[pose].is_none()) {
        let is_alike = |made: &&mut Vec<usize>| plan.first_alike(made[0]) == plan.first_alike(pose);
        match to_be_made.iter_mut().find(is_alike) {
            Some(made) => made.push(pose),
            None => to_be_made.push(vec![pose]),
        }
    }
    let capacity = Capacity {
        threads: thread_count(arguments),
        memory: arguments.memory.as_ref().map(|limit| limit.bytes),
    };
    let bytes_of = |alike: &Vec<usize>| planned_bytes(plan, alike[0]);
    let seconds_of = |alike: &Vec<usize>| -> Vec<f64> {
        let layers = plan.pose_layers(alike[0]).into_iter();
        layers.map(|layer| layer.seconds).collect()
    };
    let bytes: Vec<u64> = to_be_made.iter().map(bytes_of).collect();
    let at_a_time = capacity.most_at_a_time(&bytes);
    if at_a_time > 1 {
        longest_first(&mut to_be_made, |alike| seconds_of(alike).iter().sum());
    }
    let planned = to_be_made.iter().map(|alike| Planned {
        bytes: bytes_of(alike),
        seconds: seconds_of(alike).iter().sum(),
    });
    let planned: Vec<Planned> = planned.collect();
    let time_left = TimeLeft::new(
        (planned.clone(), capacity),
        to_be_made.iter().map(seconds_of).collect(),
    );
    let run = PoseRun {
        scene,
        plan,
        folder,
        progress,
        product,
    };
    let made = run_all(&planned, capacity, |number, threads, given_up| {
        time_left.begin(number, threads);
        let made = run.alike(&to_be_made[number], (threads, given_up), |record| {
            time_left.end(number, layer_seconds(&record.report))
        });
        made.map(Some)
    })?;
    for (alike, made) in to_be_made.into_iter().zip(made) {
        for (pose, made) in alike.into_iter().zip(made.into_iter().flatten()) {
            poses[pose] = made;
        }
    }
    Ok(poses)
}

/// Sorts by the time that each is planned to take: a long pose that begins last is waited for while other threads have
/// nothing to do. Of equals the first stays first.
fn longest_first<T>(poses: &mut [T], seconds: impl Fn(&T) -> f64) {
    poses.sort_by(|a, b| seconds(b).total_cmp(&seconds(a)));
}

/// Time that each layer of a pose took, s.
fn layer_seconds(pose: &PoseReport) -> Vec<f64> {
    let per_frame = pose.layers.iter().map(|layer| layer.seconds.total);
    let frames = f64::from(pose.frames.max(1));
    per_frame
        .map(|seconds| frames * seconds.unwrap_or(0.0))
        .collect()
}

/// Data that all poses share.
struct PoseRun<'a, P> {
    scene: &'a Scene,
    plan: &'a ScenePlan,
    folder: &'a OutputFolder,
    progress: PoseProgress,
    product: &'a P,
}

impl<P: Product> PoseRun<'_, P> {
    /// Makes poses of one simulation, which has so many threads; `time_left` takes the record of the one that was
    /// simulated and says, once all have ended, for how many seconds the others will go on.
    fn alike(
        &self,
        poses: &[usize],
        (threads, given_up): (usize, &(dyn Fn() -> bool + Sync)),
        time_left: impl Fn(&PoseRecord) -> f64,
    ) -> Result<Vec<Option<PoseRecord>>, CliError> {
        let mut simulated = None;
        let mut made: Vec<Option<PoseRecord>> = Vec::new();
        for (number, &pose) in poses.iter().enumerate() {
            let first = made.first().cloned().flatten();
            let left = |record: &PoseRecord| match number + 1 == poses.len() {
                true => time_left(first.as_ref().unwrap_or(record)),
                false => 0.0,
            };
            made.push(self.pose(pose, (threads, given_up), (&mut simulated, left))?);
        }
        Ok(made)
    }

    /// Makes one pose, of what is `simulated` already if it is.
    fn pose(
        &self,
        index: usize,
        with: (usize, &(dyn Fn() -> bool + Sync)),
        (simulated, time_left): (
            &mut Option<(usize, PoseResult)>,
            impl FnOnce(&PoseRecord) -> f64,
        ),
    ) -> Result<Option<PoseRecord>, CliError> {
        let spec = &self.scene.poses[index];
        let mut earlier = Vec::new();
        if P::WANTS_FRAMES {
            earlier = self.product.records().forget(&spec.name)?;
            self.product.begin(spec);
        }
        let bar = self.progress.start(&spec.name, index + 1);
        let record = self.simulate(index, &bar, with, (simulated, earlier));
        let ending = match &record {
            Ok(Some(record)) => {
                let warnings = match record.warnings.len() {
                    0 => String::new(),
                    count => format!(", {}", counted(count, "warning")),
                };
                let left = match time_left(record) {
                    left if left > 0.0 => format!("; about {} left", duration(left)),
                    _ => String::new(),
                };
                format!("{}{warnings}{left}", ending(&record.report))
            }
            Ok(None) => "interrupted".to_owned(),
            Err(_) => "failed".to_owned(),
        };
        self.progress
            .end(&bar, &format!("pose `{}`: {ending}", spec.name));
        record
    }

    fn simulate(
        &self,
        index: usize,
        bar: &ProgressBar,
        (threads, given_up): (usize, &(dyn Fn() -> bool + Sync)),
        (simulated, mut earlier): (&mut Option<(usize, PoseResult)>, Vec<String>),
    ) -> Result<Option<PoseRecord>, CliError> {
        let scene = self.scene;
        let spec = &scene.poses[index];
        let mut files = Vec::new();
        let mut sink = |frame: &Frame<'_>| {
            files.extend(self.product.frame(spec, frame)?);
            Ok(())
        };
        let wanted = Wanted {
            frames: P::WANTS_FRAMES,
            face_states: self.product.wants_face_states(),
        };
        let mut watch = Watch::new(bar, given_up, wanted, &mut sink);
        let mut seconds = vec![Seconds::default(); scene.layers.len()];
        let passed_on = simulated
            .as_ref()
            .map(|(from, result)| self.plan.passed_on(result, [*from, index]));
        let own;
        let result = match &passed_on {
            Some(result) => result,
            None => {
                let pool = thread_pool(threads)?;
                let result = pool.install(|| self.plan.simulate(index, &mut watch));
                let result = result.map_err(|source| CliError::Simulation {
                    scene: scene.path.clone(),
                    pose: spec.name.clone(),
                    source: Box::new(source),
                })?;
                seconds = watch.finish(result.layers.len(), result.frames)?;
                own = simulated.insert((index, result));
                &own.1
            }
        };
        if result.interrupted && !self.is_worth_keeping(spec, result) {
            return Ok(None);
        }
        bar.set_message("writing");
        let records = self.product.records();
        earlier.extend(records.forget(&spec.name)?);
        let mut made = self.product.pose(spec, result)?;
        made.files.extend(files);
        earlier.retain(|file| !made.files.contains(file));
        let record = self.record(spec, result, &seconds, made, earlier);
        records.write(&record)?;
        Ok(Some(record))
    }

    /// Whether the finished keys of an interrupted pose are more than what is there already.
    fn is_worth_keeping(&self, spec: &PoseSpec, result: &PoseResult) -> bool {
        let records = self.product.records();
        let inputs = self.folder.pose(&spec.name).inputs;
        let earlier = records.read(&spec.name);
        let earlier = earlier.filter(|record| record.is_current(&records.output, inputs));
        result.keys.len() > earlier.map_or(0, |record| record.keys.len())
    }

    fn record(
        &self,
        spec: &PoseSpec,
        result: &PoseResult,
        seconds: &[Seconds],
        made: PoseFiles,
        leftovers: Vec<String>,
    ) -> PoseRecord {
        let name = &spec.name;
        let planned = self.plan.warnings();
        let planned = planned.filter(|warning| is_about(warning, name));
        let mut warnings: Vec<String> = planned.chain(&result.warnings).cloned().collect();
        let about_maps = made.warnings.iter();
        warnings.extend(about_maps.map(|warning| format!("pose '{name}': {warning}")));
        let keys: Vec<f64> = result.keys.iter().map(|key| key.load).collect();
        if result.interrupted {
            warnings.push(format!(
                "pose '{name}': interrupted when {} of its keys {:?} were finished; the same command with \
                 `--resume` makes it whole",
                keys.len(),
                spec.keys
            ));
        }
        PoseRecord {
            origin: self.folder.origin.clone(),
            inputs: self.folder.pose(name).inputs.text(),
            points_per_wavelength: self.points(),
            keys,
            report: pose_report(name, result, seconds, self.points(), &made.maps),
            maps: made.maps,
            files: made.files,
            leftovers,
            warnings,
        }
    }

    fn points(&self) -> f64 {
        self.scene.modelling.points_per_wavelength
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_begin_first_and_equals_as_they_were() {
        let mut poses = [("a", 1.0), ("b", 3.0), ("c", 0.0), ("d", 3.0)];
        longest_first(&mut poses, |pose| pose.1);
        assert_eq!(poses.map(|pose| pose.0), ["b", "d", "a", "c"]);
    }
}
