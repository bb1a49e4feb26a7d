//! The optional tables: `[solver]`, `[remesh]`, `[bake]`.

use ruga_bake::BakeSettings;
use ruga_io::{Frame, MapFormat, MapKind, NormalY};
use ruga_stepper::{EdgeLimits, Modelling};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[solver]`: how frames are solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Equilibria or motion.
    pub mode: SolverMode,
    /// Step of the motion, s.
    pub time_step: f64,
    /// Damping of the motion, 1/s.
    pub damping: f64,
    /// Relative residual at which a frame counts as solved.
    pub tolerance: f64,
    /// Seed of everything random.
    pub seed: u64,
}

impl Default for Solver {
    fn default() -> Self {
        let modelling = Modelling::default();
        Self {
            mode: SolverMode::Static,
            time_step: 0.02,
            damping: 0.5,
            tolerance: modelling.tolerance,
            seed: modelling.seed,
        }
    }
}

/// Equilibria or motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SolverMode {
    /// Energy minima, frame by frame.
    #[default]
    Static,
    /// Implicit Euler with mass and damping.
    Dynamic,
}

/// `[remesh]`: how the layers' meshes are fitted to what a pose asks for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Remesh {
    /// Whether meshes are fitted; if not, they are as fine everywhere.
    pub enabled: bool,
    /// Vertices per wavelength across a wrinkle, from 3: fewer cannot show it.
    pub points_per_wavelength: f64,
    /// Shortest edge, m.
    pub min_edge: f64,
    /// Longest edge, m; half a wavelength is the most in any case.
    pub max_edge: f64,
    /// Longest over shortest wanted edge at a place, at most; from 1 to 4. Two and a half edges per
    /// wavelength along the wrinkles are kept in any case.
    pub aspect: f64,
}

impl Default for Remesh {
    fn default() -> Self {
        let edges = EdgeLimits::default();
        Self {
            enabled: true,
            points_per_wavelength: Modelling::default().points_per_wavelength,
            min_edge: edges.min_edge,
            max_edge: edges.max_edge,
            aspect: edges.aspect,
        }
    }
}

/// `[bake]`: which maps, how large, in which convention.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Bake {
    /// Width and height, texels.
    pub size: u32,
    /// The kinds of maps.
    pub maps: Vec<MapKind>,
    /// Their format.
    pub format: MapFormat,
    /// Sign of the green channel of normal maps.
    pub normal_y: NormalY,
    /// The tangent frame of normal maps.
    pub frame: Frame,
    /// Texels around each island that continue it: with the skin on the other side of a UV seam, or
    /// where there is none with the texels of its border.
    pub padding: u32,
    /// Samples per texel along each axis: 1, 2 or 4.
    pub supersample: u32,
    /// Radius of a ridge that is white in curvature maps, and of a furrow that is black, m: what is
    /// sharper is clamped.
    pub curvature_length: f64,
}

impl Default for Bake {
    fn default() -> Self {
        let settings = BakeSettings::default();
        Self {
            size: settings.size,
            maps: vec![MapKind::Normal, MapKind::Height],
            format: MapFormat::Png16,
            normal_y: NormalY::Up,
            frame: settings.frame,
            padding: 16,
            supersample: settings.supersample,
            curvature_length: 1e-3,
        }
    }
}
