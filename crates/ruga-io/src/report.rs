//! `report.json`: what was simulated, how it went, what came out.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{IoError, write_atomically};

/// The whole report, version 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Version of this layout: 1.
    pub version: u32,
    /// Version of ruga that wrote it.
    pub ruga: String,
    /// The scene file, as it was given.
    pub scene: String,
    /// Warnings for the user: each one whole, also where the command has said several of one
    /// kind in one message.
    pub warnings: Vec<String>,
    /// One entry per pose in the folder that was made from this version of the scene, whichever run
    /// made it, in the order of the scene.
    pub poses: Vec<PoseReport>,
}

/// Report of one pose.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseReport {
    /// Name of the pose.
    pub name: String,
    /// Whether every frame of every layer converged; false for a pose that was interrupted.
    pub converged: bool,
    /// Whether the run was interrupted on the way: then `maps` has those of the keys that were
    /// finished. Left out where it is false.
    #[serde(default, skip_serializing_if = "is_false")]
    pub interrupted: bool,
    /// Vertices per wavelength that were asked for; the poses of a folder may differ in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points_per_wavelength: Option<f64>,
    /// Load or time steps that were solved.
    pub frames: u32,
    /// Baked files relative to the report, by `<key%>_<kind>`, such as `100_normal`.
    pub maps: BTreeMap<String, String>,
    /// One entry per layer, bottom first.
    pub layers: Vec<LayerReport>,
}

fn is_false(value: &bool) -> bool {
    !value
}

/// Report of one layer in one pose. What was not measured is `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerReport {
    /// Name of the layer.
    pub name: String,
    /// Vertices of its mesh in the last frame.
    pub vertices: Option<u64>,
    /// Triangles of its mesh in the last frame.
    pub faces: Option<u64>,
    /// Constraint rows in the last frame.
    pub constraints: Option<u64>,
    /// Critical wavelength from thickness and stiffness, m.
    pub wavelength_predicted_m: Option<f64>,
    /// Compression at which it begins to wrinkle.
    pub critical_strain_predicted: Option<f64>,
    /// Shortest and longest critical wavelength that paint and natural unevenness make of it where it
    /// is simulated, m; nothing where it is even.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength_range_m: Option<[f64; 2]>,
    /// Least and greatest thickness there, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness_range_m: Option<[f64; 2]>,
    /// Dominant wavelength of what came out, m.
    pub wavelength_m: Option<f64>,
    /// `sqrt(2)` times the RMS height of what came out, m.
    pub amplitude_m: Option<f64>,
    /// Energy of the last frame, J.
    pub energy_j: Option<f64>,
    /// Newton iterations over all frames.
    pub newton_iterations: Option<u64>,
    /// Numeric factorisations over all frames, which most of the solver's time goes into.
    pub factorizations: Option<u64>,
    /// Relative residual of the last frame.
    pub residual: Option<f64>,
    /// Rule that ended the last solve: `decrement`, `residual`, or what kept it from converging.
    pub stop_rule: Option<String>,
    /// Response bending modulus of the layer's own mesh over that of its material.
    pub bending_ratio: Option<f64>,
    /// Area by which the last key compresses the layer beyond what wrinkles and creases take up, m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out_m2: Option<f64>,
    /// Creases of the layer that lie on its mesh.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub creases: Vec<CreaseReport>,
    /// Triangles of a sheet that cross others of it, at the last key; left out of other layers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intersections: Option<u64>,
    /// What the fire of a sheet has done.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fire: Option<FireReport>,
    /// Time spent, means per frame.
    pub seconds: Seconds,
}

/// What a fire has done to a sheet, in the last frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FireReport {
    /// Vertices of the mesh of temperature and fuel.
    pub field_vertices: u64,
    /// Share of the fuel that is left.
    pub fuel_left: f64,
    /// Mass that is left, kg.
    pub mass_kg: f64,
    /// Median speed of the front where it has passed, m/s.
    pub front_speed_m_s: Option<f64>,
    /// Pieces that the sheet is in.
    pub pieces: u64,
    /// Loose pieces that have vanished, because they were small or had fallen far.
    pub dropped_pieces: u64,
    /// Their area when fresh, m2.
    pub dropped_area_m2: f64,
    /// Triangles whose curl is cut to what their edges can show.
    pub capped_faces: u64,
    /// How often the sheet was meshed anew, to be fine where it burns.
    #[serde(default)]
    pub remeshings: u64,
}

/// How a crease has folded in a pose, in the last frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CreaseReport {
    /// Name of the crease; lines of an image have numbers behind it.
    pub name: String,
    /// Length of line that was simulated, m.
    pub length_m: f64,
    /// Fold angle along the line, positive in a furrow, degrees.
    pub fold_deg: MeanAndMost,
    /// Depth below the skin without wrinkles; negative for a ridge, m.
    pub depth_m: MeanAndMost,
    /// Share of the layer's energy that is in the crease itself.
    pub energy_share: f64,
    /// Share of the length that is folded by 5 degrees or more.
    pub folded_share: f64,
}

/// Mean along a line, and what is farthest from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeanAndMost {
    /// Mean.
    pub mean: f64,
    /// The value farthest from 0.
    pub most: f64,
}

/// Seconds per frame, mean: the columns of Li 2014, Table 6-1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Building constraint rows.
    pub constraints: Option<f64>,
    /// Solving.
    pub integration: Option<f64>,
    /// Remeshing.
    pub remeshing: Option<f64>,
    /// Sampling materials and rows anew.
    pub sampling: Option<f64>,
    /// All of a frame.
    pub total: Option<f64>,
}

impl Report {
    /// Version of the layout that this crate writes.
    pub const VERSION: u32 = 1;

    /// An empty report.
    pub fn new(ruga: impl Into<String>, scene: impl Into<String>) -> Self {
        Self {
            version: Self::VERSION,
            ruga: ruga.into(),
            scene: scene.into(),
            warnings: Vec::new(),
            poses: Vec::new(),
        }
    }

    /// The report as JSON text.
    pub fn to_json(&self) -> String {
        to_json_text(self)
    }

    /// Writes the report, whole or not at all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        write_atomically(path, self.to_json().as_bytes())
    }
}

/// Pretty JSON with a final newline; numbers that are not finite become `null`.
pub(crate) fn to_json_text(value: &impl Serialize) -> String {
    // Plain structs with string keys: serialisation into memory has no way to fail.
    let mut text = serde_json::to_string_pretty(value)
        .expect("structs of numbers, strings, lists and string-keyed maps always serialise");
    text.push('\n');
    text
}
