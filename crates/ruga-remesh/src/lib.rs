//! Remeshes a surface so that its edges follow a sizing tensor, and says how to carry data over.
//!
//! A [`SurfaceMesh`] lies on a [`Surface`], addressed by material points; a [`Sizing`] says at each
//! vertex how long edges should be in each direction. [`remesh`] returns a mesh that follows it
//! and a [`Transfer`] that turns per-vertex values of the old mesh into values of the new one.
//! [`sizing_field`] derives a sizing from a wrinkled shape and from what drives it.
//!
//! An edge `e` has the metric length `sqrt(eᵀ M e)` with the mean tensor `M` of its ends and is
//! wanted near one. Splitting in independent sets, flipping to the anisotropic Delaunay condition
//! and collapsing follow Narain, Samii and O'Brien, *Adaptive anisotropic remeshing for cloth
//! simulation*, 2012, as Li 2014 (LK 2.1) uses them, but in the rest metric of a surface in space
//! instead of texture coordinates.
//!
//! Positions and wanted lengths are in metres, tensors in 1/m².
//!
//! ```
//! use nalgebra::Vector3;
//! use ruga_mesh::{PerEdge, TriMesh};
//! use ruga_remesh::{PolyhedralSurface, RemeshSettings, Sizing, SurfaceMesh, remesh};
//!
//! // A square of 10 mm, two triangles, meshed with edges of about 1 mm.
//! let base = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
//! let corners = [[0.0, 0.0], [0.01, 0.0], [0.01, 0.01], [0.0, 0.01]];
//! let positions = corners.map(|[x, y]| Vector3::new(x, y, 0.0));
//! let seams = PerEdge::filled(base.edges().len(), false);
//! let surface = PolyhedralSurface::new(&base, &positions, &seams)?;
//! let coarse = SurfaceMesh::on_surface(base.clone(), surface.vertex_points()?, &surface)?;
//! let fine = remesh(&coarse, &Sizing::uniform(4, 1e-3)?, &surface, &RemeshSettings::default())?;
//! assert!(fine.report.share_met() > 0.95);
//! assert_eq!(fine.mesh.mesh.vertex_count(), fine.transfer.rows.row_count());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod closest;
mod collapse;
mod error;
mod flip;
mod grading;
mod half_edges;
mod patch;
mod relax;
mod remesh;
mod sizing;
mod sizing_field;
mod split;
mod surface;
mod tensor2;
mod tensor3;
mod transfer;

pub use remesh::{RemeshReport, RemeshSettings, Remeshed, remesh};
pub use sizing::{SizeLimits, Sizing, size_tensor};
pub use sizing_field::{FaceDriver, Refinement, SizingInput, face_compression, sizing_field};
pub use surface::{PolyhedralSurface, Surface, SurfaceMesh};
pub use transfer::Transfer;

pub use error::RemeshError;
