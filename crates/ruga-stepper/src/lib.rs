//! Plans and runs the wrinkling of layers on a posed mesh: a driver, layers and poses go in, the
//! wrinkled surfaces at every key come out.
//!
//! A [`LayerSpec`] is a material, what carries it and how the two hold together; a [`PoseSpec`] is
//! a set of blend-shape weights and the loads at which results are kept. [`plan()`] compares what
//! each pose asks of the skin with what the layer can bear and gives a [`Plan`]: where to simulate,
//! how finely, at what cost. [`Plan::simulate`] takes one pose of it from rest to full weight, shows an
//! [`Observer`] each step, and returns a [`PoseResult`].
//!
//! At each key of a pose the layer takes the positions `x` of least energy over the posed surface:
//!
//! ```text
//! min  shell(x) + 1/2 int K0 w^2 + K1 |grad w|^2 + Kt |x_t - p_t|^2     subject to  H x = b
//! ```
//!
//! `w` is the height over the posed surface and `x_t - p_t` the way along it; `H x = b` holds
//! averages of the layer, taken over more than a wavelength, at the same averages of that surface
//! (Li 2014, ch. 4). The base also pushes back with what a layer lying flat on it exerts, so that
//! the artist's own shape is in equilibrium. On the way to a key every face passes its own critical strain
//! slowly, because wrinkles choose their length there. A layer's mesh is fitted to what
//! the pose asks for; the next layer is then solved on what this one has become, going on from its own
//! last shape, or two are solved at once ([`Stack`]). With [`Dynamics`] load steps are steps in time.
//!
//! A layer may also lie on a soft [`Body`] that moves (Rémillard and Kry 2013): [`plan_body`] fills
//! the driver's surface with a coarse lattice, and its plan minimises the energies of layer,
//! springs, lattice and contact with [`Obstacle`]s all at once, under the motion of [`Handle`]s, of
//! obstacles and of blend shapes that draw the surface; results have the same form.
//!
//! SI units; positions are in space, loads are fractions of a pose in (0, 1]. The crate alone
//! changes the state of a simulation. It reads no clock and no file and prints nothing; the same
//! input gives the same result.
//!
//! ```
//! use std::sync::Arc;
//!
//! use nalgebra::{Vector2, Vector3};
//! use ruga_blend::{ArtistMesh, BlendShape, Driver};
//! use ruga_material::preset;
//! use ruga_stepper::{LayerSpec, Modelling, PoseSpec, Silent, plan};
//!
//! let square = [[0.0, 0.0], [0.04, 0.0], [0.04, 0.04], [0.0, 0.04]];
//! let driver = Arc::new(Driver::new(&ArtistMesh {
//!     positions: square.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
//!     uvs: Some(square.map(|[x, y]| Vector2::new(25.0 * x, 25.0 * y)).to_vec()),
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     shapes: vec![BlendShape {
//!         name: "compress".into(),
//!         position_deltas: square.map(|[x, _]| Vector3::new(-0.1 * x, 0.0, 0.0)).to_vec(),
//!         normal_deltas: None,
//!     }],
//!     ..ArtistMesh::default()
//! })?);
//! let skin = preset("forehead-furrow").expect("one of the presets");
//! let layers = [LayerSpec::from_preset(skin, 1)?];
//! let poses = [PoseSpec {
//!     name: "frown".into(),
//!     weights: driver.weights([("compress", 1.0)])?,
//!     keys: vec![1.0],
//!     steps: 3,
//!     motions: Vec::new(),
//!     growths: Vec::new(),
//!     half: false,
//! }];
//!
//! let plan = plan(&driver, &layers, &poses, &Modelling::draft(), 1024)?;
//! let result = plan.simulate(0, &mut Silent)?;
//! assert!(result.converged);
//! // Deeper than a tenth of a millimetre: the skin wrinkles.
//! assert!(result.layers[0].amplitude > 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod crease;
mod growth;
mod mask;
mod model;
mod plan;
mod result;
mod run;
mod sheet;
mod skin;
mod support;

mod error;
mod observer;
mod preparing;
#[cfg(test)]
mod test_drivers;
mod validation;

pub use plan::{
    AppliedStrain, BYTES_PER_TEXEL, InteriorPlan, LayerPlan, LoadPath, PaintedRanges, Plan,
    PlannedFace, PlannedSurface, PosePlan, Treatment, plan, plan_body,
};

pub use crease::{CreaseAnchor, CreaseSpec};
pub use growth::{GROWTH_RANGE, Grows, GrowthDirection, GrowthSpec};
pub use mask::{Mask, PaintedNumber};
pub use model::{
    Coupling, Dynamics, EdgeLimits, LayerSpec, Modelling, PoseSpec, Presence, Region, Stack,
};
pub use result::{
    ArtistPlace, ComputedMesh, CreaseReport, FaceState, FireReport, FoldSample, KeyResult,
    LayerReport, LayerSurface, PoseResult,
};

pub use skin::mirror::SymmetryPlane;

pub use sheet::{BurntSurface, Fire, FireSource, Heats, SHEET_EDGES, Sheet, plan_sheet};

pub use support::{Body, Handle, Keyframe, Motion, Obstacle, ObstacleShape};

pub use observer::{Frame, Observer, Phase, Preparation, Progress, Silent};

pub use error::StepperError;
// A layer and its modelling are chosen, and refused, in these words; a caller needs no other crate for
// them.
pub use ruga_burn::FrontDesign;
pub use ruga_constraint::Sampling;
pub use ruga_lattice::{LatticeError, Shape as CellShape, SolidMaterial};
pub use ruga_shell::{BendingModel, FoldSense};
pub use ruga_solver::StopRule;
