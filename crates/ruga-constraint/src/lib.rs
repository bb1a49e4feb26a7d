//! Cluster centres and Gaussian constraint functions sampled on a mesh: rows of H.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! [`cluster_centres`] spreads centres over a region, at a spacing that follows the local
//! wavelength. A [`Kernel`] says how a neighbourhood is weighted around each of them.
//! [`constraint_rows`] samples these weightings on a mesh, by a [`Sampling`]: each
//! [`ConstraintRow`] is an average of vertices which a solver may hold at the same average of the
//! surface below. Centres and kernels belong to the surface, rows to one mesh of it: after a remesh
//! the same functions are sampled again.
//!
//! Li 2014 (multi-layer skin), chapter 4, and Rémillard and Kry 2013 (embedded shells), section 3;
//! [`cluster_centres`], [`Kernel`] and [`Sampling`] say where we differ.
//!
//! Lengths in metres, on the rest surface. Weights are numbers that sum to one.

mod centre;
mod chart;
mod cluster_centres;
mod error;
mod kernel;
mod moments;
mod quadrature;
mod region_graph;
mod rows;

pub use cluster_centres::{ClusterSettings, cluster_centres};
pub use kernel::Kernel;
pub use rows::{ConstraintRow, ConstraintSet, Order, SampleConstraints, Sampling, constraint_rows};

pub use error::ConstraintError;
pub use moments::Degradation;
