//! `ruga age`: the creases that poses leave in the skin.

use std::path::Path;

use ruga_io::{IoError, write_atomically};
use ruga_scene::{CreaseNetwork, KeptCrease, PoseFolds, Scene, SceneFile, SceneOptions, counted};
use ruga_stepper::{Frame, PoseResult, PoseSpec};

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::folder_results::FolderResults;
use crate::memory_limit::refuse_too_little;
use crate::outcome::Outcome;
use crate::output_folder::OutputFolder;
use crate::pose_record::{PoseRecord, Records};
use crate::pose_runs::{PoseFiles, Product, run_poses, thread_count, thread_pool};
use crate::summary::{self, ALL_IN_REPORT};
use crate::table::{number, table};
use crate::{interrupt, messages};

/// File of what poses leave, in the output folder.
const FILE: &str = "creases.json";

/// Simulates the poses of a scene and writes what they leave in the skin.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated or written.
pub(crate) fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    let options = options(arguments)?;
    let pool = thread_pool(thread_count(arguments))?;
    let mut scene = pool.install(|| Scene::read_with(&arguments.scene, &options))?;
    // Lines of both sides are looked for, each in its own pose.
    scene.mirror = None;
    refuse_sheet(&scene)?;
    refuse_own_network(&scene, &arguments.output)?;
    let plan = pool.install(|| scene.plan())?;
    drop(pool);
    let records = Records::of_age(&arguments.output);
    let earlier = arguments.resume.then_some(&records);
    refuse_too_little(arguments.memory.as_ref(), &scene, &plan, earlier)?;
    // Until here nothing is written and Ctrl-C may end the process.
    interrupt::listen();
    let folder = OutputFolder::open(&scene, arguments, "age")?;
    let warnings = scene.warnings.iter().chain(plan.warnings());
    messages::warnings(warnings, ALL_IN_REPORT);
    let folds = Folds {
        scene: &scene,
        arguments,
        records,
    };
    let poses = run_poses(&scene, &plan, arguments, &folder, &folds);
    let results = FolderResults::read(&folds.records, &folder.poses);
    let poses = summary::unless_nothing_is_there(poses, arguments, &results)?;
    let network = match &poses {
        Ok(poses) if poses.iter().all(is_finished) => Some(folds.network(&results)?),
        _ => None,
    };
    let outcome = summary::conclude(&scene, &plan, arguments, poses, &results)?;
    match network {
        Some(network) if !arguments.json => messages::result(&network_table(&scene, &network)),
        Some(_) => {}
        None => messages::note(
            "creases.json is not written, because poses are not finished; one that is there is of an earlier run. \
             `--resume` continues",
        ),
    }
    Ok(outcome)
}

/// The poses that are asked for, or else those that the scene wants to be held.
fn options(arguments: &RunArguments) -> Result<SceneOptions, CliError> {
    let mut options = arguments.scene_options();
    if options.poses.is_empty() {
        let file = SceneFile::read(&arguments.scene)?;
        options.poses = file.memory.map_or_else(Vec::new, |memory| memory.poses);
    }
    Ok(options)
}

/// Refuses a free sheet: what is looked for are wrinkles of skin, in wavelengths.
fn refuse_sheet(scene: &Scene) -> Result<(), CliError> {
    match &scene.sheet {
        None => Ok(()),
        Some(_) => Err(CliError::AgedSheet {
            scene: scene.path.clone(),
        }),
    }
}

/// Refuses a scene that would age further with each run.
fn refuse_own_network(scene: &Scene, output: &Path) -> Result<(), CliError> {
    let network = scene.file.memory.as_ref();
    let Some(network) = network.and_then(|memory| memory.network.as_ref()) else {
        return Ok(());
    };
    let same = |a: &Path, b: &Path| {
        let [a, b] = [a, b].map(|path| path.canonicalize());
        matches!((a, b), (Ok(a), Ok(b)) if a == b)
    };
    if same(network, &output.join(FILE)) {
        return Err(CliError::OwnNetwork {
            scene: scene.path.clone(),
            path: network.clone(),
        });
    }
    messages::note("the scene has aged already: what is found is added to what its network keeps");
    Ok(())
}

fn is_finished(pose: &Option<PoseRecord>) -> bool {
    pose.as_ref().is_some_and(|pose| !pose.report.interrupted)
}

struct Folds<'a> {
    scene: &'a Scene,
    arguments: &'a RunArguments,
    records: Records,
}

impl Product for Folds<'_> {
    const WANTS_FRAMES: bool = false;

    fn records(&self) -> &Records {
        &self.records
    }

    /// They have the wavelength of every place.
    fn wants_face_states(&self) -> bool {
        true
    }

    fn begin(&self, _: &PoseSpec) {}

    fn frame(&self, _: &PoseSpec, _: &Frame<'_>) -> Result<Vec<String>, CliError> {
        Ok(Vec::new())
    }

    fn pose(&self, pose: &PoseSpec, result: &PoseResult) -> Result<PoseFiles, CliError> {
        let file = format!("folds/{}.json", pose.name);
        let folds = self.scene.folds(pose, result);
        let text = serde_json::to_vec(&folds)
            .expect("structs of numbers, strings and lists always serialise");
        write_atomically(&self.arguments.output.join(&file), &text)?;
        Ok(PoseFiles {
            files: vec![file],
            ..PoseFiles::default()
        })
    }
}

impl Folds<'_> {
    /// Writes the network that the poses leave: those of this run, and those of earlier ones that the scene wants
    /// to be held.
    fn network(&self, results: &FolderResults) -> Result<CreaseNetwork, CliError> {
        let memory = self.scene.file.memory.as_ref();
        let held = memory.map_or(&[][..], |memory| &memory.poses);
        let of_run = |name: &str| self.scene.poses.iter().any(|pose| pose.name == name);
        let is_wanted = |pose: &&PoseRecord| {
            let name = &pose.report.name;
            !pose.report.interrupted && (held.is_empty() || held.contains(name) || of_run(name))
        };
        let mut folds = Vec::new();
        for record in results.current.iter().filter(is_wanted) {
            for file in &record.files {
                folds.push(self.read(file)?);
            }
        }
        let network = self.scene.network(&folds);
        network.write(&self.arguments.output.join(FILE))?;
        Ok(network)
    }

    fn read(&self, file: &str) -> Result<PoseFolds, CliError> {
        let path = self.arguments.output.join(file);
        let bytes = ruga_io::read_bytes(&path)?;
        let folds = serde_json::from_slice(&bytes).ok();
        folds.filter(PoseFolds::is_whole).ok_or_else(|| {
            let reason = "was changed; remove it, and `--resume` simulates the pose again";
            IoError::malformed(&path, "folds of a pose", reason).into()
        })
    }
}

/// Table of what the skin keeps.
fn network_table(scene: &Scene, network: &CreaseNetwork) -> String {
    if network.creases.is_empty() {
        return "The poses leave no lines: no crease is folded by more than its `yield`, and no wrinkle turns the skin \
                by more than `wrinkle_yield` along two wavelengths of its valley."
            .to_owned();
    }
    let new = network
        .creases
        .iter()
        .filter(|crease| !crease.points_m.is_empty());
    let row = |crease: &KeptCrease| {
        vec![
            crease.name.clone(),
            crease.layer.clone(),
            number(1e3 * crease.length_m, 1, "mm"),
            number(scene.largest_kept(crease).to_degrees(), 0, "°"),
        ]
    };
    let rows: Vec<_> = network.creases.iter().map(row).collect();
    let headings = ["crease", "layer", "length", "keeps up to"];
    let new = match new.count() {
        0 => "No new lines.".to_owned(),
        count => format!("{} left by wrinkles.", counted(count, "line")),
    };
    format!(
        "{}\n{new} All is in creases.json: `network` under [memory] names it in a scene.",
        table(&headings, &rows)
    )
}
