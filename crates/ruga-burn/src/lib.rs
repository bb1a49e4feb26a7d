//! A burning law and a triangle mesh in; temperature and fuel over the mesh, step by step, out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`FieldMesh`] is a triangulation in its rest metric, flipped to a Delaunay one without moving a vertex. A
//! [`BurnLaw`] says how heat flows, what burns and what is lost; a [`FrontDesign`] makes one from the speed
//! and width that the front is to have. [`Front`] is the closed form the other way round, and [`FrontDeath`]
//! the loss that no front survives. A [`BurnState`] holds temperature and fuel share, a [`Source`] heats
//! from outside, and a [`BurnSolver`] steps the state and tells in a [`StepReport`] what burnt and where the heat went.
//!
//! ## Equations
//!
//! ```text
//! dT/dt = a Lap T + dT_ad r - (T - T_a)/tau + sources - radiation
//! dY/dt = -r,     r = mu (T - T_i)  while T > T_i and Y > 0
//! ```
//! after Jeong, Kim, Kim 2011, *Shrinkage, wrinkling and ablation of burning cloth and paper*, eq. (1) to (4),
//! with what is amiss there mended; see [`BurnLaw`]. Burning is of zeroth order in the fuel, because then the
//! speed of the front has a closed form. The scheme is first order in time and second in space;
//! [`FrontCorrection`] makes up for its errors at the front.
//!
//! ## Units and spaces
//!
//! SI units: metres, seconds, kelvin. Fields live on vertices, and the surface is the one at rest: nothing here
//! knows where the sheet is in space. Heat is counted in K m², which the areal heat capacity turns into joules,
//! and fuel in m² of fresh sheet.

mod design;
mod field_mesh;
mod front;
mod law;
mod report;
mod settings;
mod solver;
mod source;
mod state;

mod correction;
mod heat_matrix;
mod intrinsic;
mod root;
mod wave;

mod error;

pub use design::FrontDesign;
pub use field_mesh::FieldMesh;
pub use front::{Front, FrontDeath};
pub use law::{BurnLaw, Radiation, StarterCheck};
pub use settings::{BurnSettings, FrontCorrection};
pub use solver::BurnSolver;
pub use source::Source;
pub use state::{BurnState, Prospect};

pub use report::{HeatBalance, StepReport};

pub use error::BurnError;
