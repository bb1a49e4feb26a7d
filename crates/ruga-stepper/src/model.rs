//! What is to be simulated: materials, couplings, poses and the choices of the planner.

use std::sync::Arc;

use nalgebra::Vector2;
use ruga_blend::{Smoothing, Weights};
use ruga_constraint::{SampleConstraints, Sampling, constraint_rows};
use ruga_material::{
    LaminatedSheet, LayerMaterial, MaterialError, Preset, PropertyMap, Substrate, Variation,
    VariationField, WavelengthModel, wrinkling,
};
use ruga_shell::BendingModel;
use ruga_solver::{Minimise, minimise};

use crate::mask::Mask;
use crate::{CreaseSpec, GrowthSpec, Motion};

/// Energies and constraints that hold a layer on its support surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Coupling {
    /// Gaussian averaging constraints alone, as in the papers.
    ///
    /// Their centres are wavelength/√3 apart.
    Constraint,
    /// An elastic foundation alone.
    ///
    /// A Pasternak foundation and tangential springs.
    Elastic,
    /// The foundation with averaging constraints over longer distances.
    ///
    /// Their centres are 1.5 wavelengths apart.
    #[default]
    Hybrid,
}

impl Coupling {
    /// Whether springs hold the layer, and not rows alone.
    pub(crate) fn has_foundation(self) -> bool {
        matches!(self, Self::Elastic | Self::Hybrid)
    }
}

/// One layer and what it lies on.
#[derive(Clone, Debug)]
pub struct LayerSpec {
    /// Name in reports and file names.
    pub name: String,
    /// The layer; of bonded plies [`LaminatedSheet::material`].
    pub material: LayerMaterial,
    /// Bonded plies that a free sheet is made of, which may grow each by itself ([`Grows::Ply`](crate::Grows::Ply)).
    /// Painted properties and variation scale all of them alike.
    pub laminate: Option<LaminatedSheet>,
    /// Material below the layer.
    pub substrate: Substrate,
    /// Formula for wavelength and critical strain.
    pub model: WavelengthModel,
    /// Energies and constraints that hold the layer on its support surface.
    pub coupling: Coupling,
    /// Sampling of the averaging constraints on a mesh.
    pub sampling: Sampling,
    /// Painted properties, relative to `material` and the wavelength it gives.
    pub map: Option<Arc<PropertyMap>>,
    /// Whether edges of the layer's mesh follow the places where the map jumps by a fifth or more, so
    /// that no triangle lies across them; without effect where it does not.
    pub sharp: bool,
    /// Fraction of the bending strain of the layer below that this one feels, 0 to 1; from the
    /// stiffness of both if left out.
    pub bending_transfer: Option<f64>,
    /// Natural unevenness of its thickness, on top of what is painted.
    pub variation: Option<Arc<VariationField>>,
    /// Painted presence on the artist's mesh, and strength of the relief.
    pub presence: Presence,
    /// Lines along which it folds.
    pub creases: Vec<CreaseSpec>,
    /// Changes of its rest lengths that poses switch on ([`PoseSpec::growths`]).
    pub growths: Vec<GrowthSpec>,
}

impl LayerSpec {
    /// Makes an even layer of `material` that lies everywhere on `substrate`, with the default formula,
    /// coupling and sampling.
    pub fn new(name: impl Into<String>, material: LayerMaterial, substrate: Substrate) -> Self {
        Self {
            name: name.into(),
            material,
            laminate: None,
            substrate,
            model: WavelengthModel::default(),
            coupling: Coupling::default(),
            sampling: Sampling::default(),
            map: None,
            sharp: false,
            bending_transfer: None,
            variation: None,
            presence: Presence::default(),
            creases: Vec::new(),
            growths: Vec::new(),
        }
    }

    /// Makes the layer that `preset` describes, named after it, with its natural unevenness.
    ///
    /// # Errors
    /// Those of [`Self::uneven`]; none for one of [`ruga_material::PRESETS`].
    pub fn from_preset(preset: &Preset, seed: u64) -> Result<Self, MaterialError> {
        let even = Self::new(preset.name, preset.layer, preset.substrate);
        match preset.variation {
            Some(variation) => even.uneven(variation, seed),
            None => Ok(even),
        }
    }

    /// Lets the layer's thickness vary from place to place; `seed` says where it is thick.
    ///
    /// # Errors
    /// [`MaterialError`] when material, substrate or variation are out of range.
    pub fn uneven(mut self, variation: Variation, seed: u64) -> Result<Self, MaterialError> {
        // The size of the unevenness is in wavelengths of the layer.
        let wave = wrinkling(&self.material, &self.substrate, self.model)?;
        let field = VariationField::new(variation, wave.wavelength, seed)?;
        self.variation = Some(Arc::new(field));
        Ok(self)
    }
}

/// Painted presence of a layer, and strength of its relief in results.
#[derive(Clone, Debug)]
pub struct Presence {
    /// Painted masks; the layer is where each of them is lighter than [`Mask::DARKEST`]. Their grey
    /// values, multiplied, fade its relief.
    pub masks: Vec<Mask>,
    /// Factor on its relief, above 0.
    pub strength: f64,
}

impl Default for Presence {
    /// A layer that is everywhere, with its relief as it is.
    fn default() -> Self {
        Self {
            masks: Vec::new(),
            strength: 1.0,
        }
    }
}

impl Presence {
    /// Whether the layer is at a texture coordinate.
    pub(crate) fn covers(&self, uv: Vector2<f64>) -> bool {
        self.masks.iter().all(|mask| mask.covers(uv))
    }

    /// Whether a triangle of the texture may have a part where the layer is.
    pub(crate) fn touches(&self, corners: &[Vector2<f64>; 3]) -> bool {
        self.masks.iter().all(|mask| mask.touches(corners))
    }

    /// Product of the masks' grey values at a texture coordinate, 0 to 1.
    pub fn grey(&self, uv: Vector2<f64>) -> f64 {
        self.masks.iter().map(|mask| mask.grey(uv)).product()
    }
}

/// Meaning of a stack of layers: which wrinkle together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Stack {
    /// Each layer by its own wavelength, as painted.
    ///
    /// Small wrinkles lie on large ones.
    #[default]
    Nominal,
    /// The lower layer carries the stiffness of the stack.
    ///
    /// It is as stiff as it and all above it together: physical, with fine wrinkles gathered in the
    /// valleys of large ones.
    Composite,
    /// All layers in one system; for small patches.
    ///
    /// Two layers are solved at once, on one mesh that is as fine as the upper one needs: the
    /// reference for the other two. Both are held by foundations and tangential springs alone,
    /// whatever their couplings; what the upper one feels of the lower one's bending follows. The tangential
    /// springs are as stiff against short sliding as against even one: over valleys that ask for more than some 15 %
    /// fine wrinkles may gather in folds, which those of a composite do not.
    Joint,
}

/// One pose to simulate.
#[derive(Clone, Debug)]
pub struct PoseSpec {
    /// Name in reports and file names.
    pub name: String,
    /// Blend-shape weights at load 1.
    pub weights: Weights,
    /// Loads at which results are kept, in (0, 1], strictly ascending, at least one.
    pub keys: Vec<f64>,
    /// Load steps from 0 to 1, 1 to 100 000.
    pub steps: u32,
    /// Motions of handles and obstacles of a [`Body`](crate::Body); what is not named stands
    /// still. A keyframe between two load steps is one of its own.
    pub motions: Vec<Motion>,
    /// Strengths at load 1 of the layers' growths, by name ([`LayerSpec::growths`]); 1 is the whole growth. Names
    /// that no layer has say nothing.
    pub growths: Vec<(String, f64)>,
    /// Simulates a pose that is its own mirror image at the plane `x = 0` on the side where x is positive alone:
    /// results end at the plane ([`LayerSurface::on_plane`](crate::LayerSurface::on_plane)), and reports are of that
    /// side. Only of layers on a driver, solved one on the other and without creases and growths, and where a
    /// [`SymmetryPlane`](crate::SymmetryPlane) keeps the pose.
    pub half: bool,
}

impl PoseSpec {
    /// Whether results are kept at a load.
    pub(crate) fn has_key(&self, load: f64) -> bool {
        // Loads are computed and keys are given, so that equal ones may differ by rounding. Keys
        // this close to each other are refused.
        self.keys.iter().any(|key| (key - load).abs() < 1e-9)
    }
}

/// Part of the artist's mesh on which layers are simulated.
#[derive(Clone, Debug, Default)]
pub enum Region {
    /// The faces that a pose compresses enough.
    #[default]
    Auto,
    /// All of the mesh.
    All,
    /// The faces that a pose compresses enough and on which the painted mask is lighter than
    /// [`Mask::DARKEST`]; its grey values fade the relief.
    Mask(Mask),
}

impl Region {
    /// The painted mask, if there is one.
    pub(crate) fn mask(&self) -> Option<&Mask> {
        match self {
            Self::Auto | Self::All => None,
            Self::Mask(mask) => Some(mask),
        }
    }
}

/// Limits of the edges of a fitted mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EdgeLimits {
    /// Shortest edge, m; not negative.
    pub min_edge: f64,
    /// Longest edge, m; above `min_edge`. Half a wavelength is the most in any case.
    pub max_edge: f64,
    /// Largest ratio of the lengths in two directions, at least 1. Two and a half edges per
    /// wavelength along the wrinkles are kept in any case.
    pub aspect: f64,
}

impl Default for EdgeLimits {
    fn default() -> Self {
        Self {
            min_edge: 0.0,
            max_edge: 1.0,
            // Bending by the curvature at vertices stays right on triangles up to four times as
            // long as wide along the wrinkles. At an angle to them they are up to a quarter too stiff.
            aspect: 4.0,
        }
    }
}

/// Motion instead of a sequence of equilibria: implicit Euler on the lowest layer (Li 2014,
/// eq. 5.2).
///
/// Every load step is then a step in time, [`PoseSpec::steps`] of them to full load; a key or a keyframe
/// of a motion between two divides a step, and one that cannot be solved is halved. At every key a
/// driver stands still until the skin rests. Layers on others are thin and light, and follow at once. A
/// [`Body`](crate::Body) moves with its layer, and time is the load: no key waits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dynamics {
    /// Length of a step, s; positive.
    pub time_step: f64,
    /// Force against the motion over mass and velocity, 1/s; not negative.
    pub damping: f64,
}

/// Choices that are not physics.
#[derive(Clone, Debug)]
pub struct Modelling {
    /// Part of the artist's mesh that is simulated.
    pub region: Region,
    /// Edges per wavelength asked for, 2 to 200; 12 is the standard quality. A layer that carries
    /// another has at least 18. A layer on a body may have fewer, from 0.1.
    pub points_per_wavelength: f64,
    /// Vertices of one layer in one pose above which refinement stops, with a warning; at least 1.
    pub vertex_budget: usize,
    /// Vertices of a layer, without those on its border, up to which it is solved as a whole; with more than
    /// 12 points per wavelength, as a layer has that carries another, as many more as there are on the same
    /// area. A larger one finds its first wrinkles as a whole, one of more than six times as many in wide
    /// patches of at most twice as many. Then it is solved in overlapping patches of at most a third, each of
    /// which is proved to be at a minimum at every key; not load step by load step, on a body, or in a joint pair.
    /// At least 1.
    pub whole_vertices: usize,
    /// Limits of the mesh where it is fitted to the pose; `None` keeps it uniform.
    pub remesh: Option<EdgeLimits>,
    /// Meaning of a stack of layers: which wrinkle together.
    pub stack: Stack,
    /// Motion in time; `None` takes the skin from equilibrium to equilibrium.
    pub dynamics: Option<Dynamics>,
    /// The surface between the artist's vertices.
    pub smoothing: Smoothing,
    /// Discrete bending energy.
    pub bending: BendingModel,
    /// Method that finds an equilibrium; [`ruga_solver::minimise`], unless methods are compared. States
    /// that another one does not call stable are warned of.
    pub minimise: Minimise,
    /// Method that samples averaging constraints on a mesh; [`ruga_constraint::constraint_rows`],
    /// unless methods are compared.
    pub sample: SampleConstraints,
    /// Relative residual at which a solve may stop, in (0, 1).
    pub tolerance: f64,
    /// Seed of the initial noise.
    pub seed: u64,
}

/// Edges per wavelength below another layer, at least: with fewer the upper layer sees a polygon,
/// and wrinkles at its corners.
const CARRYING_POINTS: f64 = 18.0;

impl Modelling {
    /// The choices for a first look: 6 edges per wavelength.
    pub fn draft() -> Self {
        Self::with_points(6.0)
    }

    /// The default: 12 edges per wavelength.
    pub fn standard() -> Self {
        Self::with_points(12.0)
    }

    /// The choices for the last tenths of a degree: 24 edges per wavelength, about eight times
    /// the vertices of a draft.
    pub fn fine() -> Self {
        Self::with_points(24.0)
    }

    /// Vertices up to which a layer that asks for so many `points` per wavelength is solved as a whole. Patches
    /// of fewer wavelengths stiffen the layer where they share averages, and gain no time.
    pub(crate) fn most_in_whole(&self, points: f64) -> usize {
        let finer = (points / 12.0).max(1.0);
        // Saturates where a library user wants no patches.
        (self.whole_vertices as f64 * finer.powi(2)) as usize
    }

    fn with_points(points_per_wavelength: f64) -> Self {
        Self {
            region: Region::Auto,
            points_per_wavelength,
            // By the planner's own model, one factorisation of so many vertices takes some twenty
            // seconds and 1.7 GB.
            vertex_budget: 300_000,
            // From here on patches take less time on one thread, too: of a smile of 8600 vertices .7.
            whole_vertices: 5_000,
            remesh: Some(EdgeLimits::default()),
            stack: Stack::Nominal,
            dynamics: None,
            // The artist's facets are as long as fine waves and would imprint on them.
            smoothing: Smoothing::Loop,
            // Hinges bend a fifth to a third too easily across triangles two to four times as long
            // as wide, which fitted meshes have.
            bending: BendingModel::VertexCurvature,
            minimise,
            sample: constraint_rows,
            tolerance: 1e-6,
            seed: 1,
        }
    }

    /// Edges per wavelength of layer number `index` of `layers`.
    pub(crate) fn points_of(&self, index: usize, layers: usize) -> f64 {
        match index + 1 < layers {
            true => self.points_per_wavelength.max(CARRYING_POINTS),
            false => self.points_per_wavelength,
        }
    }
}

impl Default for Modelling {
    fn default() -> Self {
        Self::standard()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_of_a_whole_grows_with_the_points_of_a_layer_that_carries_others() {
        let modelling = Modelling::standard();
        let most = |index| modelling.most_in_whole(modelling.points_of(index, 2));
        // Vertices in the same area grow with the square of the points.
        assert_eq!([most(0), most(1)], [11_250, 5_000]);
    }
}
