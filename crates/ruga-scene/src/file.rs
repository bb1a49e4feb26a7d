//! `scene.toml`, version 1: what the user asks for.
//!
//! The structs keep the raw values of the file, defaults filled in; [`Layer::definition`] and
//! [`Substrate::definition`] say which of the ways to describe a material was used.

mod array_lengths;
mod burn;
mod creases;
mod fault;
mod growths;
mod interior;
mod memory;
mod names;
mod pack;
mod read;
mod reference;
mod settings;
mod sheet;
mod skin;
mod slips;
mod toml_words;
mod validate;
mod validate_creases;
mod validate_interior;
mod validate_layers;
mod zones;

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use burn::{Burn, BurnMap, BurnSource, Char};
pub use creases::{Anchor, Corners, Crease, Drive, Fold};
pub use growths::Growth;
pub use interior::{Cylinder, Handle, Interior, Motion, Movers, Obstacle, Plane, Sphere};
pub use memory::Memory;
pub(crate) use names::{file_name_fault, same_file};
pub use names::{is_usable_file_name, usable_file_name};
pub use pack::{Pack, PoseNames};
pub use reference::{Key, Table, reference};
pub use settings::{Bake, Remesh, Solver, SolverMode};
pub use sheet::Sheet;
pub use skin::{Layer, LayerDefinition, Ply, PropertyMap, Substrate, SubstrateDefinition};
pub use zones::Zone;

pub use ruga_blend::Smoothing;
pub use ruga_material::{WavelengthModel, Wrap};
pub use ruga_stepper::{CellShape, Coupling, Sampling, Stack};

use ruga_io::LengthUnit;
use ruga_stepper::Modelling;

/// A whole scene: what stands before the first table. All units are SI: metres, pascals, kilograms,
/// seconds. Paths are relative to the scene's folder. An unknown key is an error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the scene format: 1.
    pub version: u32,
    /// How several layers act together.
    #[serde(default)]
    pub stack: Stack,
    /// Unit of the coordinates of OBJ files; for glTF see `scale` under `[driver]`.
    #[serde(default)]
    pub length_unit: LengthUnit,
    /// The artist's mesh.
    pub driver: Driver,
    /// What carries the lowest layer; may be left out when that layer is a preset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub substrate: Option<Substrate>,
    /// The layers, bottom first.
    pub layers: Vec<Layer>,
    /// Lines along which layers fold.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub creases: Vec<Crease>,
    /// Layers that grow or shrink.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub growths: Vec<Growth>,
    /// If given, what the skin keeps of its poses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<Memory>,
    /// The poses; none means every blend shape and every growth at weight 1, or a body without shapes
    /// or a sheet under its own weight.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<Pose>,
    /// How frames are solved.
    #[serde(default)]
    pub solver: Solver,
    /// How the layers' meshes follow the wrinkles.
    #[serde(default)]
    pub remesh: Remesh,
    /// What is baked.
    #[serde(default)]
    pub bake: Bake,
    /// If given, the poses are packed into a few maps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pack: Option<Pack>,
    /// If given, the layers lie on a soft body instead of on the posed mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interior: Option<Interior>,
    /// If given, the layer is a thin sheet that lies on nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheet: Option<Sheet>,
    /// If given, the sheet burns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub burn: Option<Burn>,
}

/// The mesh and the part of it that is simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Driver {
    /// `.glb`, `.gltf` or `.obj`.
    pub mesh: PathBuf,
    /// Which mesh, if the file has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_name: Option<String>,
    /// Metres per unit of the mesh file, glTF and OBJ alike: 0.01 for a mesh in centimetres, 0.001
    /// for one in millimetres. Left out, glTF is in metres and OBJ in `length_unit`. The GLB that is
    /// written keeps the unit of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// OBJ alone: name and file of each blend shape, as `targets = { smile = "smile.obj" }`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub targets: BTreeMap<String, PathBuf>,
    /// Where skin is simulated: `"auto"` (where a pose compresses the skin enough to wrinkle it),
    /// `"all"`, or the path of a grey image over the UV square, white where skin is simulated.
    #[serde(default)]
    pub region: Region,
    /// Whether the mesh has UDIM tiles: unit squares of the texture, of which each has maps of its own. The one
    /// of column u and row v is number 1001 + u + 10 v. Masks and painted images with `<UDIM>` in their names,
    /// as `"skin.<UDIM>.png"`, are one file per tile; where a file is missing, masks are black and painted
    /// properties are the layer's own. An image without `<UDIM>` lies on the first tile of the mesh.
    #[serde(default)]
    pub tiles: Tiles,
    /// How the artist's facets are smoothed.
    #[serde(default)]
    pub smoothing: Smoothing,
    /// `"x"` for a mesh that is its own mirror image at x = 0, in the axes of its file: of a left and a right
    /// pose in one run `ruga bake` simulates one and mirrors the maps for the other, and of a pose that mirrors itself
    /// one half.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<Symmetry>,
    /// Vertices of one layer above which a run is refused.
    #[serde(default = "default_vertex_budget")]
    pub vertex_budget: u64,
}

fn default_vertex_budget() -> u64 {
    Modelling::default().vertex_budget as u64
}

/// Plane at which a mesh mirrors itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Symmetry {
    /// The plane x = 0.
    X,
}

/// Whether a mesh has UDIM tiles: unit squares of the texture, each with images of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Tiles {
    /// If most islands lie whole in a tile, and some in others than the first.
    #[default]
    Auto,
    /// Yes, also with islands over several tiles; each triangle must lie in one.
    Udim,
    /// No: only the square from 0 to 1 is baked, as for islands moved by 1 to be left out.
    One,
}

/// Where skin is simulated: `auto`, `all`, or the path of a mask.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "String", into = "String")]
pub enum Region {
    /// Where a pose compresses the skin enough to wrinkle it.
    #[default]
    Auto,
    /// Everywhere.
    All,
    /// Where a grey image is lighter than a sixteenth; its grey fades the wrinkles.
    Mask(PathBuf),
}

impl From<String> for Region {
    fn from(text: String) -> Self {
        match text.as_str() {
            "auto" => Region::Auto,
            "all" => Region::All,
            _ => Region::Mask(PathBuf::from(text)),
        }
    }
}

impl From<Region> for String {
    fn from(region: Region) -> Self {
        match region {
            Region::Auto => "auto".to_owned(),
            Region::All => "all".to_owned(),
            Region::Mask(path) => path.to_string_lossy().into_owned(),
        }
    }
}

/// A set of weights, growths and motions, and where on the way to it maps are baked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Its name, also in file names.
    pub name: String,
    /// Weight of each blend shape that takes part, from -10 to 10; 1 is the whole shape. May be left
    /// out when there are `growths`, an `[interior]` or a `[sheet]`.
    #[serde(default)]
    pub weights: BTreeMap<String, f64>,
    /// Strength of each of `[[growths]]` that takes part, as `{ dry = 1.0 }`; 1 is the whole growth.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub growths: BTreeMap<String, f64>,
    /// Fractions of the weights at which maps are baked, above 0 and up to 1: 0.5 is half way.
    #[serde(default = "default_keys")]
    pub keys: Vec<f64>,
    /// Load steps from rest to the full pose, for `ruga simulate` and for soft bodies; `ruga bake` goes
    /// from key to key on a posed mesh that does not move in time.
    #[serde(default = "default_steps")]
    pub steps: u32,
    /// Where handles and obstacles of `[interior]` or `[sheet]` go; what is not named stands still.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<Motion>,
}

fn default_keys() -> Vec<f64> {
    vec![0.5, 1.0]
}

fn default_steps() -> u32 {
    20
}

impl Pose {
    /// One blend shape at weight 1, with the default keys and steps.
    pub fn of_shape(name: impl Into<String>, shape: &str) -> Self {
        Self {
            weights: BTreeMap::from([(shape.to_owned(), 1.0)]),
            ..Self::at_rest(name)
        }
    }

    /// One growth at strength 1, with the default keys and steps.
    pub fn of_growth(name: impl Into<String>, growth: &str) -> Self {
        Self {
            growths: BTreeMap::from([(growth.to_owned(), 1.0)]),
            ..Self::at_rest(name)
        }
    }

    /// Neither shapes nor motions, with the default keys and steps: a body or sheet under its own weight.
    pub fn at_rest(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            weights: BTreeMap::new(),
            growths: BTreeMap::new(),
            keys: default_keys(),
            steps: default_steps(),
            motions: Vec::new(),
        }
    }
}
