//! Why the command could not run.

use std::path::PathBuf;

use miette::Diagnostic;
use ruga_bake::BakeError;
use ruga_blend::BlendError;
use ruga_io::IoError;
use ruga_material::MaterialError;
use ruga_stepper::{LatticeError, StepperError};
use thiserror::Error;

/// What the user can mend; each message names the file, and the key or element in it.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum CliError {
    /// A file cannot be read, means something impossible, or cannot be written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A share of the bending of a layer that is not there.
    #[error("{}: `layers[{layer}].bending_transfer`: found {found}, but there is no layer below", scene.display())]
    #[diagnostic(help("leave `bending_transfer` out"))]
    NoLayerBelow {
        scene: PathBuf,
        layer: usize,
        found: f64,
    },
    /// A preset that does not exist.
    #[error("{}: `{key}`: there is no preset `{name}`{}", scene.display(), did_you_mean(suggestion.as_deref()))]
    #[diagnostic(help("presets: {listed}"))]
    UnknownPreset {
        scene: PathBuf,
        key: String,
        name: String,
        suggestion: Option<String>,
        listed: String,
    },
    /// A layer that cannot be.
    #[error("{}: `{key}`: {source}", scene.display())]
    Material {
        scene: PathBuf,
        key: String,
        source: MaterialError,
    },
    /// `--pose` names what the scene does not have.
    #[error("{}: the scene has no pose `{name}`{}", scene.display(), did_you_mean(suggestion.as_deref()))]
    #[diagnostic(help("poses: {listed}"))]
    UnknownPose {
        scene: PathBuf,
        name: String,
        suggestion: Option<String>,
        listed: String,
    },
    /// The mesh cannot be driven.
    #[error("{}: {source}", mesh.display())]
    Mesh { mesh: PathBuf, source: BlendError },
    /// A size that no skin has: the file is in another unit than it was taken to be in.
    #[error("{}: the mesh is {width} wide; {question}", mesh.display())]
    #[diagnostic(help("{remedy}"))]
    Unit {
        mesh: PathBuf,
        /// With its unit, as `21 m`.
        width: String,
        question: String,
        remedy: String,
    },
    /// `ruga new --mesh` with a mesh that nothing moves.
    #[error("{}: the mesh has no blend shapes, so there is nothing to pose", mesh.display())]
    #[diagnostic(help(
        "export it with its blend shapes (shape keys); an OBJ has one file for each, which \
         `targets` under [driver] names: see `ruga help scene`"
    ))]
    NothingToPose { mesh: PathBuf },
    /// Two triangles would write the same texels.
    #[error("{}: the texture coordinates of triangles {first} and {second} overlap inside the active region of pose `{pose}` ({} there)", mesh.display(), counted(*triangles, "overlapping triangle"))]
    #[diagnostic(help(
        "give every part of the active region its own place in the UV square, or leave one of them \
         out with a mask: `driver.region = \"mask.png\"`"
    ))]
    OverlappingUvs {
        mesh: PathBuf,
        pose: String,
        first: u32,
        second: u32,
        triangles: usize,
    },
    /// Texture coordinates that are no numbers.
    #[error("{}: {} without texture coordinates, the first is triangle {first}", mesh.display(), counted(*count, "triangle"))]
    MissingUvs {
        mesh: PathBuf,
        count: usize,
        first: u32,
    },
    /// Texture coordinates that leave the maps empty.
    #[error("{}: {problem}", mesh.display())]
    #[diagnostic(help("{advice}"))]
    UvLayout {
        mesh: PathBuf,
        problem: String,
        advice: &'static str,
    },
    /// Two zones that both claim a place.
    #[error("{}: the zones `{first}` and `{second}` overlap: at u {u:.2}, v {v:.2} from the map's upper left their masks add up to {percent:.0} %; accepted: up to 100 %", scene.display())]
    #[diagnostic(help(
        "paint one of the masks black where the other is white; where one goes over into the other, let their greys add up to white, over a wavelength or more"
    ))]
    ZonesOverlap {
        scene: PathBuf,
        first: String,
        second: String,
        u: f64,
        v: f64,
        percent: f64,
    },
    /// The scene cannot be planned or simulated.
    #[error("{}: {source}", scene.display())]
    Model {
        scene: PathBuf,
        source: Box<StepperError>,
    },
    /// The mesh does not enclose a body.
    #[error("{}: cannot be a body: {source}", mesh.display())]
    Surface { mesh: PathBuf, source: LatticeError },
    /// A pose cannot be simulated.
    #[error("{}: pose `{pose}`: {source}", scene.display())]
    Simulation {
        scene: PathBuf,
        pose: String,
        source: Box<StepperError>,
    },
    /// A map cannot be baked.
    #[error("{}: pose `{pose}`: {source}", mesh.display())]
    Baking {
        mesh: PathBuf,
        pose: String,
        source: BakeError,
    },
    /// The output folder cannot be used.
    #[error("{}: cannot be the output folder: {reason}", path.display())]
    Output { path: PathBuf, reason: String },
    /// Another run is writing to the output folder.
    #[error("{}: another run is working in this folder: {holder}", path.display())]
    #[diagnostic(help(
        "wait until it is done, stop it, or give another folder with `--output`; a run that was killed \
         holds no folder"
    ))]
    Busy { path: PathBuf, holder: String },
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

/// The accepted name nearest to `name`, if it is near enough to be a slip of the hand.
pub(crate) fn nearest<'a>(
    name: &str,
    accepted: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    // Jaro-Winkler likes common beginnings, as typing errors do; below 0.75 the guesses annoy.
    const LEAST_SIMILARITY: f64 = 0.75;
    let lower = name.to_lowercase();
    accepted
        .into_iter()
        .map(|other| (strsim::jaro_winkler(&lower, &other.to_lowercase()), other))
        .filter(|(similarity, _)| *similarity >= LEAST_SIMILARITY)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, other)| other.to_owned())
}

/// `1 face`, `2 faces`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}
