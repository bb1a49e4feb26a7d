//! Cluster centres and Gaussian constraint functions sampled on a mesh: rows of H.
//!
//! [`cluster_centres`] spreads centres over a region, at a spacing that follows the local
//! wavelength. A [`Kernel`] says how a neighbourhood is weighted around each of them.
//! [`constraint_rows`] samples these weightings on a mesh, by a [`Sampling`]: each
//! [`ConstraintRow`] is an average of vertices which a solver may hold at the same average of the
//! surface below. Centres and kernels belong to the surface, rows to one mesh of it: after a remesh
//! the same functions are sampled again.
//!
//! For comparison with these local functions, [`spectral_rows`] gives global ones.
//!
//! Li 2014 (multi-layer skin), chapter 4, and Rémillard and Kry 2013 (embedded shells), section 3;
//! [`cluster_centres`], [`Kernel`] and [`Sampling`] say where we differ.
//!
//! Lengths in metres, on the rest surface. Weights are numbers that sum to one.
//!
//! ```
//! use nalgebra::Vector3;
//! use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
//! use ruga_mesh::{MaterialPoint, PerVertex, TriMesh, subdivide, vertex_normals};
//!
//! // Two triangles, 4 cm wide, subdivided to edges of 1.25 mm; rows every 15 mm.
//! let coarse = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
//! let fine = subdivide(&coarse, 5, &PerVertex::filled(4, true));
//! let square = [[0.0, 0.0], [0.04, 0.0], [0.04, 0.04], [0.0, 0.04]];
//! let positions = fine.fine_from_coarse.apply(&square.map(|[x, y]| Vector3::new(x, y, 0.0)));
//! let normals = vertex_normals(&fine.mesh, &positions);
//!
//! let spacing = PerVertex::filled(positions.len(), 0.015);
//! let everywhere: Vec<_> = spacing.ids().collect();
//! let settings = ClusterSettings::default();
//! let centres = cluster_centres(&fine.mesh, &positions, &spacing, &everywhere, &settings)?;
//! let centres: Vec<_> =
//!     centres.iter().filter_map(|&v| MaterialPoint::of_vertex(&fine.mesh, v)).collect();
//! let kernels = vec![Kernel::beside_foundation(0.015); centres.len()];
//! let set = constraint_rows(
//!     &fine.mesh, &positions, &normals, &centres, &kernels, Sampling::Quadrature,
//! )?;
//! assert_eq!(set.rows.len(), 8);
//! let sum: f64 = set.rows[0].weights.iter().map(|pair| pair.1).sum();
//! assert!((sum - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod centre;
mod chart;
mod cluster_centres;
mod error;
mod kernel;
mod krylov;
mod laplacian;
mod moments;
mod quadrature;
mod region_graph;
mod rows;
mod spectral;

pub use cluster_centres::{ClusterSettings, cluster_centres};
pub use kernel::Kernel;
pub use rows::{ConstraintRow, ConstraintSet, Order, Sampling, constraint_rows};
pub use spectral::{SpectralRows, spectral_rows};

pub use error::ConstraintError;
pub use moments::Degradation;
