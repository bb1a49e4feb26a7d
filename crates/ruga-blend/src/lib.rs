//! Blend-shape driver: weights in, posed positions and normals at material points out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! An [`ArtistMesh`] is what the file holds. A [`Driver`] welds it and blends:
//! `x(w) = rest + sum_i w_i delta_i` (Li 2014, 5.3). A [`BaseSurface`] is the smooth Loop limit
//! surface through it, addressed by material points; [`face_strains`] says what a pose asks of the
//! skin. Lengths are metres; texture coordinates have V down as in glTF.

mod artist_mesh;
mod base_surface;
mod driver;
mod error;
mod nearest;
mod smooth_groups;
mod strain;
mod surface_points;

pub use artist_mesh::{ArtistMesh, BlendShape};
pub use base_surface::{BaseSurface, PosedSurface, Smoothing};
pub use driver::{Driver, Weights};
pub use error::BlendError;
pub use nearest::{did_you_mean, nearest};
pub use smooth_groups::SmoothGroups;
pub use strain::{FaceStrain, face_strains};
pub use surface_points::SurfacePoints;
