//! Why a scene cannot be read, planned or baked.

use std::path::PathBuf;

use miette::Diagnostic;
use ruga_bake::BakeError;
use ruga_blend::{BlendError, did_you_mean};
use ruga_io::IoError;
use ruga_material::MaterialError;
use ruga_stepper::{LatticeError, StepperError};
use thiserror::Error;

use crate::SymmetryFault;

/// Errors that the user can mend; each message names the file, and the key or element in it.
#[derive(Debug, Error, Diagnostic)]
pub enum SceneError {
    /// A file cannot be read or means something impossible.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The scene says something that cannot be done.
    #[error("{}: {}{reason}{}", path.display(), key_and_line(key, *line), did_you_mean(suggestion.as_deref()))]
    Key {
        /// The scene file.
        path: PathBuf,
        /// The key, as `layers[0].young`; empty when the file is not TOML.
        key: String,
        /// Line in the file, from 1, where it is known.
        line: Option<usize>,
        /// The value that was found and what is accepted.
        reason: String,
        /// The nearest accepted name.
        suggestion: Option<String>,
    },
    /// A file that the scene names cannot be used for what the scene wants of it.
    #[error("{}: `{key}`: {source}", scene.display())]
    NamedFile {
        /// The scene file.
        scene: PathBuf,
        /// The key that names the file, as `layers[0].map.image`.
        key: String,
        /// Error of the file, which it names.
        source: Box<IoError>,
    },
    /// A share of the bending of a layer that is not there.
    #[error("{}: `layers[{layer}].bending_transfer`: found {found}, but there is no layer below", scene.display())]
    #[diagnostic(help("leave `bending_transfer` out"))]
    NoLayerBelow {
        /// The scene file.
        scene: PathBuf,
        /// Number of the layer, from 0.
        layer: usize,
        /// The share.
        found: f64,
    },
    /// A preset that does not exist.
    #[error("{}: `{key}`: there is no preset `{name}`{}", scene.display(), did_you_mean(suggestion.as_deref()))]
    #[diagnostic(help("presets: {listed}"))]
    UnknownPreset {
        /// The scene file.
        scene: PathBuf,
        /// The key in the scene.
        key: String,
        /// The name that was given.
        name: String,
        /// The nearest accepted name.
        suggestion: Option<String>,
        /// The accepted names.
        listed: String,
    },
    /// A layer that cannot be.
    #[error("{}: `{key}`: {source}", scene.display())]
    Material {
        /// The scene file.
        scene: PathBuf,
        /// The key in the scene.
        key: String,
        /// Error of the crate that refused it.
        source: MaterialError,
    },
    /// A pose was asked for that the scene does not have.
    #[error("{}: the scene has no pose `{name}`{}", scene.display(), did_you_mean(suggestion.as_deref()))]
    #[diagnostic(help("poses: {listed}"))]
    UnknownPose {
        /// The scene file.
        scene: PathBuf,
        /// The name that was given.
        name: String,
        /// The nearest accepted name.
        suggestion: Option<String>,
        /// The accepted names.
        listed: String,
    },
    /// The mesh cannot be driven.
    #[error("{}: {source}", mesh.display())]
    Mesh {
        /// The mesh file.
        mesh: PathBuf,
        /// Error of the crate that refused it.
        source: BlendError,
    },
    /// A mesh that is to mirror itself and does not.
    #[error("{}: `driver.symmetry`: {} does not mirror itself at x = 0: {source}", scene.display(), mesh.display())]
    #[diagnostic(help("leave `symmetry` out, or mirror the mesh in the tool it was made with"))]
    NotSymmetric {
        /// The scene file.
        scene: PathBuf,
        /// The mesh file.
        mesh: PathBuf,
        /// What has no partner.
        source: SymmetryFault,
    },
    /// A size that no skin has: the file is in another unit than it was taken to be in.
    #[error("{}: the mesh is {width} wide; {question}", mesh.display())]
    #[diagnostic(help("{remedy}"))]
    Unit {
        /// The mesh file.
        mesh: PathBuf,
        /// With its unit, as `21 m`.
        width: String,
        /// Question which unit it might be in.
        question: String,
        /// Advice what to write into the scene.
        remedy: String,
    },
    /// Two triangles would write the same texels.
    #[error("{}: the texture coordinates of triangles {first} and {second} overlap inside the active region of pose `{pose}` ({} there)", mesh.display(), counted(*triangles, "overlapping triangle"))]
    #[diagnostic(help(
        "give every part of the active region its own place in the UV square, or leave one of them \
         out with a mask: `driver.region = \"mask.png\"`"
    ))]
    OverlappingUvs {
        /// The mesh file.
        mesh: PathBuf,
        /// The pose.
        pose: String,
        /// Number in the file of the first triangle.
        first: u32,
        /// Number in the file of the other triangle.
        second: u32,
        /// Number of triangles that lie on others.
        triangles: usize,
    },
    /// Texture coordinates that are no numbers.
    #[error("{}: {} without texture coordinates, the first is triangle {first}", mesh.display(), counted(*count, "triangle"))]
    MissingUvs {
        /// The mesh file.
        mesh: PathBuf,
        /// Number of such triangles.
        count: usize,
        /// Number in the file of the first triangle.
        first: u32,
    },
    /// Texture coordinates that leave the maps empty.
    #[error("{}: {problem}", mesh.display())]
    #[diagnostic(help("{advice}"))]
    UvLayout {
        /// The mesh file.
        mesh: PathBuf,
        /// Fault of the texture coordinates.
        problem: String,
        /// Advice to the user.
        advice: &'static str,
    },
    /// Two zones that both claim a place.
    #[error("{}: the zones `{first}` and `{second}` overlap: at u {u:.2}, v {v:.2} from the upper left of {} their masks add up to {percent:.0} %; accepted: up to 100 %", scene.display(), map_words(*tile))]
    #[diagnostic(help(
        "paint one of the masks black where the other is white; where one goes over into the other, let their greys add up to white, over a wavelength or more"
    ))]
    ZonesOverlap {
        /// The scene file.
        scene: PathBuf,
        /// One zone.
        first: String,
        /// The other zone.
        second: String,
        /// Number of the UDIM tile that the place is in; `None` on a mesh without.
        tile: Option<u32>,
        /// Texture coordinate of the place, from the left.
        u: f64,
        /// Texture coordinate of the place, from the top.
        v: f64,
        /// Sum of the masks there, %.
        percent: f64,
    },
    /// Masks that leave nothing of a layer.
    #[error("{}: layer `{layer}`: nothing is left to simulate by {masks}: no face of the mesh is white there", scene.display())]
    #[diagnostic(help(
        "a face counts where the mask is lighter than a sixteenth in its middle: paint whole faces white, because a speck inside one is not enough; check, too, that black and white, and up and down, are not the wrong way round"
    ))]
    BlackMask {
        /// The scene file.
        scene: PathBuf,
        /// Name of the layer.
        layer: String,
        /// The keys of its masks with their images.
        masks: String,
    },
    /// The scene cannot be planned or simulated.
    #[error("{}: {source}", scene.display())]
    Model {
        /// The scene file.
        scene: PathBuf,
        /// Error of the crate that refused it.
        source: Box<StepperError>,
    },
    /// The mesh does not enclose a body.
    #[error("{}: cannot be a body: {source}", mesh.display())]
    Surface {
        /// The mesh file.
        mesh: PathBuf,
        /// Error of the crate that refused it.
        source: LatticeError,
    },
    /// A map cannot be baked.
    #[error("{}: pose `{pose}`: {source}", mesh.display())]
    Baking {
        /// The mesh file.
        mesh: PathBuf,
        /// The pose.
        pose: String,
        /// Error of the crate that refused it.
        source: BakeError,
    },
}

/// A count with its noun: `1 face`, `2 faces`.
pub fn counted(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

fn map_words(tile: Option<u32>) -> String {
    tile.map_or_else(|| "the map".to_owned(), |tile| format!("tile {tile}"))
}

fn key_and_line(key: &str, line: Option<usize>) -> String {
    let key = if key.is_empty() {
        String::new()
    } else {
        format!("`{key}`")
    };
    match line {
        Some(line) if key.is_empty() => format!("line {line}: "),
        Some(line) => format!("{key} (line {line}): "),
        None if key.is_empty() => key,
        None => format!("{key}: "),
    }
}
