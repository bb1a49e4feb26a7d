//! A burning law and a triangle mesh in; temperature and fuel over the mesh, step by step, out.
#![doc = include_str!("../README.md")]

mod design;
mod field_mesh;
mod front;
mod law;
mod report;
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
pub use solver::{BurnSettings, BurnSolver, FrontCorrection};
pub use source::Source;
pub use state::{BurnState, Prospect};

pub use report::{HeatBalance, StepReport};

pub use error::BurnError;
