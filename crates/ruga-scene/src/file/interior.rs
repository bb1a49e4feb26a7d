//! `[interior]`: the soft body below the layers, what holds it and what it runs into; and the
//! motions of poses.

use ruga_stepper::CellShape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::BurnSource;

/// `[interior]`: layers on an embedded lattice (Rémillard and Kry 2013).
///
/// What lies inside has the Young's modulus and the Poisson ratio of `[substrate]`. All lengths are
/// metres; `length_unit` converts OBJ input alone. Places and directions are in the axes of the world:
/// those in which a glTF file's node stands, of which glTF says that `y` is up. `driver.region` is
/// `"all"` where it is `"auto"`. The lowest layer moves together with the body; others lie on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Interior {
    /// Lattice cells along the longest side of the body, 1 to 64: more follow its bending more closely,
    /// and take longer. If left out, the number is chosen so that the body bends freely and each cell
    /// is longer than a wrinkle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<u32>,
    /// The lattice's elements.
    pub shape: CellShape,
    /// Density of the inside, kg/m3, above 0.
    pub density: f64,
    /// Acceleration of whatever has mass, m/s2; none if left out. It acts in full from the first load
    /// step on.
    pub gravity: [f64; 3],
    /// Stiffness per area of springs that draw the surface to the posed blend shapes, Pa/m, above 0;
    /// left out, blend shapes move nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub follow: Option<f64>,
    /// Parts of the body that are held and moved.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub handles: Vec<Handle>,
    /// What the layer cannot enter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Obstacle>,
}

impl Default for Interior {
    fn default() -> Self {
        Self {
            cells: None,
            shape: CellShape::Quadratic,
            density: 1100.0,
            gravity: [0.0; 3],
            follow: None,
            handles: Vec::new(),
            obstacles: Vec::new(),
        }
    }
}

impl Interior {
    /// What poses can move.
    pub fn movers(&self) -> Movers<'_> {
        Movers {
            table: "interior",
            handles: &self.handles,
            obstacles: &self.obstacles,
            sources: &[],
        }
    }
}

/// What poses can move.
#[derive(Clone, Copy, Debug)]
pub struct Movers<'a> {
    /// The table that lists it.
    pub table: &'static str,
    /// Parts that are held.
    pub handles: &'a [Handle],
    /// What nothing can enter.
    pub obstacles: &'a [Obstacle],
    /// What is hot; only balls move.
    pub sources: &'a [BurnSource],
}

impl<'a> Movers<'a> {
    /// Names of handles, of obstacles, then of hot balls.
    pub fn names(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let handles = self.handles.iter().map(|handle| handle.name.as_str());
        let obstacles = self.obstacles.iter().map(|obstacle| obstacle.name.as_str());
        let balls = self.sources.iter().filter(|source| source.sphere.is_some());
        handles
            .chain(obstacles)
            .chain(balls.map(|source| source.name.as_str()))
    }
}

/// One of `[[interior.handles]]` or `[[sheet.handles]]`: the part of a body or sheet in a box, which moves as poses
/// tell it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Handle {
    /// Its name in motions.
    pub name: String,
    /// Lowest corner of the box at rest, m.
    pub min: [f64; 3],
    /// Highest corner, m; above the lowest along every axis.
    pub max: [f64; 3],
}

/// One of `[[interior.obstacles]]` or `[[sheet.obstacles]]`: a rigid thing without friction. Exactly one shape is
/// given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Its name in motions.
    pub name: String,
    /// Everything behind a plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<Plane>,
    /// A ball.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<Sphere>,
    /// A straight cylinder: a button.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<Cylinder>,
}

/// A plane and everything behind it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// A point on it, m.
    pub point: [f64; 3],
    /// Towards the free side, of any length but zero.
    pub normal: [f64; 3],
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Its centre, m.
    pub centre: [f64; 3],
    /// Its radius, m, above 0.
    pub radius: f64,
}

/// A straight cylinder with flat ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Centre of one end, m.
    pub from: [f64; 3],
    /// Centre of the other end, m; elsewhere than `from`.
    pub to: [f64; 3],
    /// Its radius, m, above 0.
    pub radius: f64,
}

/// One of the `motions` of a pose: where a handle or an obstacle is at one time.
///
/// Several motions of one thing are its keyframes, in ascending order; between them, and between
/// the rest and the first, it moves evenly. After the last it stays. A keyframe between two load steps
/// is a load step of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Name of the handle or obstacle.
    pub of: String,
    /// When, as a fraction of the pose, above 0 and up to 1.
    pub at: f64,
    /// `move`: way from where it is at rest, m, after it has been turned; none if left out.
    #[serde(default, rename = "move")]
    pub translation: [f64; 3],
    /// Axis times angle, degrees, by the right-hand rule; none if left out.
    #[serde(default)]
    pub turn: [f64; 3],
    /// A point of the axis at rest, m; the origin if left out.
    #[serde(default)]
    pub about: [f64; 3],
}
