//! Remeshes a surface so that its edges follow a sizing tensor, and says how to carry data over.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`SurfaceMesh`] lies on a [`Surface`], addressed by material points: the facets of a mesh
//! ([`PolyhedralSurface`]), the Loop surface of positions and triangles ([`SmoothSurface`]), or one of
//! your own; [`FeatureCurves`] adds curves that features follow. A [`Sizing`] says at each vertex how long edges should be in each direction, a [`Metric`]
//! says it anywhere. [`remesh`] or [`remesh_to_metric`] returns a mesh that follows it and a
//! [`Transfer`] that turns values of the old mesh, per vertex or per corner, into values of the new
//! one. [`sizing_field`] derives a sizing from a wrinkled shape and from what drives it. [`LevelCut`] keeps the
//! part of a mesh where a level is positive, as of a sheet that burns.
//!
//! An edge `e` has the metric length `sqrt(eᵀ M e)` with the mean tensor `M` of its ends and is
//! wanted near one. Splitting in independent sets, flipping to the anisotropic Delaunay condition
//! and collapsing follow Narain, Samii and O'Brien, *Adaptive anisotropic remeshing for cloth
//! simulation*, 2012, as Li 2014 (LK 2.1) uses them, but in the rest metric of a surface in space
//! instead of texture coordinates.
//!
//! Positions and wanted lengths are in metres, tensors in 1/m². Loops run on the threads of rayon's current
//! pool; their number does not change the mesh.

mod closest;
mod collapse;
mod corner_values;
mod counts;
mod cut;
mod error;
mod feature_curves;
mod flip;
mod grading;
mod half_edges;
mod length_classes;
mod patch;
mod relax;
mod remesh;
mod sizing;
mod sizing_field;
mod smooth_surface;
mod split;
mod surface;
mod tensor2;
mod tensor3;
mod touched;
mod transfer;

pub use cut::{CutPoint, LevelCut, shares_left};
pub use feature_curves::{FeatureCurve, FeatureCurves};
pub use remesh::{RemeshReport, RemeshSettings, Remeshed, remesh, remesh_to_metric};
pub use sizing::{Metric, SizeLimits, Sizing, size_tensor};
pub use sizing_field::{FaceDriver, Refinement, SizingInput, sizing_field};
pub use smooth_surface::SmoothSurface;
pub use surface::{PolyhedralSurface, Surface, SurfaceMesh};
pub use transfer::Transfer;

pub use error::RemeshError;
