//! Why the command could not run.

use std::path::PathBuf;

use miette::Diagnostic;
use ruga_io::IoError;
use ruga_scene::{SceneError, counted};
use ruga_stepper::StepperError;
use thiserror::Error;

use crate::memory_size::MemorySize;
use crate::preview_fault::PreviewFault;

/// Errors that the user can mend; each message names the file, and the key or element in it.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum CliError {
    /// A file cannot be read, means something impossible, or cannot be written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The scene, or something that it names, cannot be used.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// A folder cannot be previewed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Preview(#[from] PreviewFault),
    /// A scene of a free sheet is to age.
    #[error("{}: `[sheet]`: `ruga age` finds folds that stay in skin; accepted: scenes without it", scene.display())]
    AgedSheet {
        /// The scene file.
        scene: PathBuf,
    },
    /// `--format glb` for a scene without a sheet.
    #[error("{}: `--format glb` shows how a sheet moves the mesh, and the scene has no `[sheet]`", scene.display())]
    #[diagnostic(help(
        "take `obj`, `vtu` or `usda`: they hold the layers as they wrinkle; how a soft body moves the mesh is in the GLB of `ruga bake`"
    ))]
    NoSheet {
        /// The scene file.
        scene: PathBuf,
    },
    /// `ruga new --mesh` with a mesh that nothing moves.
    #[error("{}: the mesh has no blend shapes, so there is nothing to pose", mesh.display())]
    #[diagnostic(help(
        "export it with its blend shapes (shape keys); an OBJ has one file for each, which \
         `targets` under [driver] names: see `ruga help scene`"
    ))]
    NothingToPose { mesh: PathBuf },
    /// A pose cannot be simulated.
    #[error("{}: pose `{pose}`: {source}", scene.display())]
    Simulation {
        scene: PathBuf,
        pose: String,
        source: Box<StepperError>,
    },
    /// `--memory` is less than a pose needs by itself; `others` are further such poses.
    #[error(
        "{}: pose `{pose}` needs {needed} of memory by itself, more than `--memory {limit}` allows{}",
        scene.display(),
        and_others(*others)
    )]
    #[diagnostic(help(
        "nothing was written; give `--memory {needed}` or more, or let the pose need less: `--quality draft`, \
         a smaller `size` under [bake], or a smaller region (`region` under [driver], `mask` of a layer); \
         `ruga plan` shows what each needs"
    ))]
    TooLittleMemory {
        scene: PathBuf,
        pose: String,
        needed: MemorySize,
        limit: MemorySize,
        others: usize,
    },
    /// `ruga plan` with `--image` or `--preview` has nothing to show, or no file to show it in.
    #[error("{}: no picture of the plan: {reason}", path.display())]
    NoPicture { path: PathBuf, reason: String },
    /// More poses overlap than there are to be packed maps.
    #[error(
        "{}: `pack.maps`: found {maps}, but poses {poses} overlap; {needed} maps can hold them apart",
        scene.display()
    )]
    #[diagnostic(help(
        "all maps of the poses are written, only `packed` is not; give `maps = {needed}` or more under [pack], \
         or keep the poses apart with masks; `--resume` packs without baking again"
    ))]
    TooFewMaps {
        scene: PathBuf,
        poses: String,
        maps: usize,
        needed: usize,
    },
    /// The output folder cannot be used.
    #[error("{}: cannot be the output folder: {reason}", path.display())]
    Output { path: PathBuf, reason: String },
    /// Another run is writing to the output folder; `work` says where in it.
    #[error("{}: another run is working {work}: {holder}", path.display())]
    #[diagnostic(help(
        "wait until it is done, stop it, or give another folder with `--output`; a run that was killed \
         holds no folder"
    ))]
    Busy {
        path: PathBuf,
        work: String,
        holder: String,
    },
    /// The output folder has results of another scene.
    #[error("{}: holds {} of another scene: {other}; this scene is {own}", path.display(), counted(*count, "pose"))]
    #[diagnostic(help(
        "give another folder with `--output`, or take this one with `--force`: then the other scene's \
         poses leave `wrinkles.json` and `report.json`, and files that this run does not write stay"
    ))]
    OtherScene {
        path: PathBuf,
        count: usize,
        other: String,
        own: String,
    },
    /// `ruga bake --merge` in a folder without all that is to be merged.
    #[error("{}: {} to be merged {} not there as asked for: {poses}", path.display(), counted(*count, "pose"), if *count == 1 { "is" } else { "are" })]
    #[diagnostic(help(
        "run the tasks of these poses again, or bake them here: the same command with `--resume` in place of \
         `--merge` makes what is missing and merges; nothing was changed"
    ))]
    NotBaked {
        path: PathBuf,
        count: usize,
        poses: String,
    },
    /// `ruga age` would write over the network that the scene has aged by.
    #[error("{}: `memory.network`: found {}, the file that this run writes", scene.display(), path.display())]
    #[diagnostic(help(
        "leave `network` out to find anew what poses leave in young skin, or give another folder with `--output` \
         to let aged skin age further"
    ))]
    OwnNetwork { scene: PathBuf, path: PathBuf },
    /// `ruga job` would overwrite another job.
    #[error("{}: is there already and is another job: {difference}; nothing was written", path.display())]
    #[diagnostic(help(
        "give another folder with `--output`, or write over the job with `--force`; results stay"
    ))]
    OtherJob { path: PathBuf, difference: String },
    /// A text of a job that farms would read as something else, or not at all.
    #[error("{}: {what} `{text}` cannot stand in a job: {reason}", scene.display())]
    JobText {
        scene: PathBuf,
        what: &'static str,
        text: String,
        reason: &'static str,
    },
    /// `ruga new` would overwrite something.
    #[error("{}: exists already; nothing was written", path.display())]
    #[diagnostic(help("choose another folder, or move the file away"))]
    InTheWay { path: PathBuf },
    /// No worker threads.
    #[error("cannot start {threads} threads: {reason}")]
    Threads { threads: usize, reason: String },
    /// `ruga check` found something.
    #[error("{}: {} found", scene.display(), counted(*count, "problem"))]
    Problems { scene: PathBuf, count: usize },
}

/// Words for further poses that need too much memory.
fn and_others(others: usize) -> String {
    match others {
        0 => String::new(),
        1 => "; so does 1 other pose".to_owned(),
        _ => format!("; so do {others} other poses"),
    }
}
