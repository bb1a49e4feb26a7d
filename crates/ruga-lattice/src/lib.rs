//! A coarse hexahedral lattice that carries the inside of a body: a closed surface goes in; node
//! vectors, their elastic energy and the surface that they move come out.
//!
//! A [`Lattice`] is the body cut along a regular grid, one element for each connected piece in a
//! cell: parts that are close but not connected, such as lips, do not stick together. A
//! [`LatticeEnergy`] gives value, gradient and Hessian of its elasticity, a [`RotatedLinear`]
//! material at every quadrature point. An [`Embedding`] is the sparse map from nodes to points of
//! the surface and their normals, and takes forces back.
//!
//! ```text
//! x(X) = sum_i N_i(X) q_i                       N: quadratic B-splines, or trilinear
//! E_q  = int mu |S - I|^2 + lambda/2 tr(S - I)^2 dX,     dx/dX = R S
//! ```
//!
//! After Rémillard and Kry 2013, "Embedded Thin Shells for Wrinkle Simulation" (RK), sections 3, 5
//! and 6.2. Different from it: an element has its material where its piece of the body is
//! ([`Filling`]), and the grid fits the surface's box along every axis.
//!
//! SI units: metres, newtons, joules, kilograms. *Rest* positions `X` are those of the surface that
//! the lattice was built from. The Hessian is symmetric, its lower triangle in compressed columns
//! over the nodes that are not pinned.
//!
//! ```
//! use nalgebra::Vector3;
//! use ruga_lattice::{Embedding, Lattice, LatticeEnergy, LatticeSpec, SolidMaterial};
//! use ruga_mesh::TriMesh;
//!
//! // A tetrahedron, 10 cm wide.
//! let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
//! let positions = corners.map(Vector3::from);
//! let lattice = Lattice::build(&TriMesh::new(4, faces)?, &positions, &LatticeSpec::default())?;
//! assert!((lattice.volume() - 1e-3 / 6.0).abs() < 1e-15);
//!
//! let foam = SolidMaterial { young: 5e5, poisson: 0.3 };
//! let energy = LatticeEnergy::new(&lattice, &foam, &vec![false; lattice.node_count()])?;
//! let surface = Embedding::of_vertices(&lattice)?;
//! // Stretched by a hundredth along x, the surface follows exactly.
//! let stretch = |p: &Vector3<f64>| Vector3::new(1.01 * p.x, p.y, p.z);
//! let q: Vec<_> = lattice.rest_positions().iter().map(stretch).collect();
//! assert!((surface.positions(&q)[1].x - 0.101).abs() < 1e-15);
//! assert!(energy.value(&q) > 0.0 && energy.value(lattice.rest_positions()) < 1e-20);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod lattice;
mod shape;

mod lattice_energy;
mod lattice_objective;
mod mass;
mod quadrature;
mod rotated_linear;
mod signed_svd;

mod embedding;
mod lattice_points;
mod surface_elements;
mod surface_stiffness;

mod closed_surface;
mod face_cutting;
mod face_regions;
mod grid;
mod moments;
mod node_merging;
mod pieces;
mod solid_intervals;

mod error;
mod ids;

pub use grid::cell_size;
pub use lattice::{Filling, Lattice, LatticeSpec, MAX_CELLS, VOID_STIFFNESS};
pub use shape::Shape;

pub use lattice_energy::LatticeEnergy;
pub use lattice_objective::LatticeObjective;
pub use rotated_linear::{RotatedLinear, SolidMaterial};

pub use embedding::Embedding;
pub use lattice_points::LatticePoint;
pub use surface_stiffness::SurfaceBlocks;

pub use error::LatticeError;
pub use ids::{ElementId, NodeId};
