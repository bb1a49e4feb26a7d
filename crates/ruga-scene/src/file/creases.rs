//! `[[creases]]`: lines along which the skin folds.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One of `[[creases]]`: lines along which a layer folds, as it does in the palm or between the brows. Exactly
/// one of `uv`, `edges`, `line_mesh` and `image` says where. A preset fills in what is left out; its values are
/// nominal, from anatomy and not measured on skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crease {
    /// Its name in reports and messages.
    pub name: String,
    /// Name of the layer that folds, the lowest one of its zone; the first layer of the scene if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer: Option<String>,
    /// `"palm-line"`, `"finger-flexion"`, `"crows-foot"`, `"frown-line"` or `"nasolabial"`: width,
    /// stiffness, angle and anchor of such a line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// A line through texture coordinates, from the upper left of the texture: `[[0.41, 0.22], [0.45,
    /// 0.25]]`. A seam is crossed by a point on it in one island, followed by the same place in the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub uv: Vec<[f64; 2]>,
    /// A line along edges of a glTF mesh: numbers of vertices in the file, from 0, neighbours joined by an edge;
    /// closed if it ends where it began.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<u32>,
    /// Name of another mesh (glTF) or object (OBJ) in the file of the mesh that consists of lines, as a curve
    /// that was drawn on the skin: each of its polylines is a line, put onto the closest places of the skin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line_mesh: Option<String>,
    /// Largest distance of a point of `line_mesh` from the skin, m; a wavelength of the layer if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reach: Option<f64>,
    /// Grey image over the UV square on which lines are painted white: each stroke is a line along its middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<PathBuf>,
    /// Whether the last point of `uv` is joined to the first.
    #[serde(default)]
    pub closed: bool,
    /// What becomes of the corners of `uv`, `line_mesh` and the strokes of `image`.
    #[serde(default)]
    pub corners: Corners,
    /// The side to which it folds.
    #[serde(default)]
    pub fold: Fold,
    /// Whether it folds to that side only.
    #[serde(default = "yes")]
    pub one_sided: bool,
    /// Width of the soft strip that it stands for, m; the layer's thickness if neither this nor a preset is
    /// given. The line stays sharp whatever its width.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Share of the bending stiffness that is left on the strip, from 0.000001 to 1; 0.1 without a preset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Angle at which the line has no moment at full strength, degrees from flat, 0 to 150; 15 without a preset.
    /// The skin beside it resists, so that in skin that is not compressed the fold is a part of it; `ruga plan`
    /// says how deep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    /// What holds the line down to the tissue below: `{ depth = 1e-3, stiffness = 20.0 }`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anchor: Option<Anchor>,
    /// Depth to which the flesh of a soft body is cut below the line, m: inwards along the mean of the normals around,
    /// at least a cell of its lattice, in every pose. The skin goes across the cut. Only with `[interior]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slit: Option<f64>,
    /// Whether it takes up, as a fold, what a pose compresses the skin by beyond the 15 to 25 % that wrinkles take,
    /// across the line and within a wavelength of it: for lines of palms and finger joints.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub absorb: bool,
    /// Lengths over which it fades in from its start and out to its end, m; three widths if left out. A closed
    /// line has no ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fade: Option<[f64; 2]>,
    /// What its angle and its anchor's depth follow.
    #[serde(default)]
    pub drive: Drive,
    /// With `drive = "weights"`: blend shapes whose weights in a pose, each times its factor, add up to the
    /// strength: `{ browDownLeft = 0.5, browDownRight = 0.5 }`. Sums below 0 count as 0, above 1 as 1; a factor
    /// below 0 takes strength away, or follows a weight below 0.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub weights: BTreeMap<String, f64>,
}

/// Springs that hold a crease down. On a soft body they hold it to places inside, that deep below the line at rest, and
/// draw them up; on a free sheet there are none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// Depth below the skin around the line at full strength, m; of a mountain fold the height. With 0 the line is
    /// held level with the skin around it.
    pub depth: f64,
    /// Stiffness in units of what carries the layer, above 0, at most 100; with 20 a line at rest sinks to 0.91 of the
    /// depth, with 100 to 0.98.
    #[serde(default = "anchor_stiffness")]
    pub stiffness: f64,
}

fn yes() -> bool {
    true
}

fn anchor_stiffness() -> f64 {
    20.0
}

/// What becomes of the corners of a polyline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Corners {
    /// A smooth curve goes through the points; turns over 60 degrees stay corners.
    #[default]
    Round,
    /// They stay.
    Keep,
}

/// The side to which a crease folds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Fold {
    /// A furrow, as seen from outside.
    #[default]
    Valley,
    /// A ridge.
    Mountain,
}

/// What the strength of a crease follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Drive {
    /// The pose's own load: none at rest, full at its end.
    #[default]
    Load,
    /// Nothing: the line is there in every pose at every key, also in one whose weights are 0, for a map of
    /// the face at rest.
    Always,
    /// Blend-shape weights, by `weights`.
    Weights,
}
