//! Energies of a thin layer on a surface: positions in; value, gradient and Hessian out.
//!
//! A [`LayerEnergy`] sums three kinds of stencil over a [`TriMesh`](ruga_mesh::TriMesh): a [`Membrane`] per
//! face, bending by the [`BendingModel`] asked for (a [`Hinge`] per interior edge, or
//! the curvature of a [`StarShape`] per vertex that has an inner edge), and a foundation ([`NormalFoundation`] per face,
//! [`TangentialSpring`] per vertex) towards a base that each frame replaces. Each stencil can be used
//! alone. [`response_modulus`] says how stiffly a given mesh really bends. An [`UpperSheet`] may move
//! together with the layer, on springs above it ([`LayerSprings`] per face). A [`LayerPart`], which
//! a [`PartIndex`] makes, is the energy as a function of some vertices, while the others stand still.
//!
//! ```text
//! E = sum_faces  A C/2 ((1 - nu) E:E + nu tr(E)^2)             St. Venant-Kirchhoff, plane stress
//!   + sum_faces  A C (J_0 - J)^3 / J_0^2                        below J_0 = 0.4 of a face's area
//!   + sum_edges  k/2 (theta - theta_rest)^2                    Grinspun 2003, calibrated to D
//!  or sum_stars  A D/2 ((tr kappa)^2 - 2 (1 - nu) det kappa)   kappa linear in theta - theta_rest
//!     + sum_edges k u^3/(1.01 - u)                           u from 0 at 2 rad of bend to 1 at pi
//!   + sum_creases  L/(2 c) (phi - phi_rest)^2                   in series with the bending, phi least
//!   + 1/2 int    K0 w^2 + K1 |grad w|^2 + Kt |t|^2 + Kg |grad t|^2
//!                                        Pasternak, w = n.(x - p) - offset, t = (I - n n^T)(x - p)
//! ```
//!
//! A [`Crease`] on an edge adds compliance and a rest angle in series with the bending there
//! ([`LayerEnergy::set_creases`]), and a [`LineAnchor`] draws a line to a depth.
//!
//! The rest shape may change: [`LayerEnergy::set_rest_metric`] for lengths and
//! [`LayerEnergy::set_natural_curvatures`] for a sheet that bends by itself; and so may stiffness and what is
//! left of a face ([`LayerEnergy::set_face_parameters`], [`LayerEnergy::set_area_left`]).
//!
//! SI units: metres, newtons, joules. Positions are in space; everything marked *rest* refers to
//! the rest metric. The Hessian is symmetric, its lower triangle in compressed columns over the
//! vertices that are not pinned.
//!
//! ```
//! use nalgebra::Vector3;
//! use ruga_mesh::TriMesh;
//! use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};
//!
//! let rest = [[0.0, 0.0], [1e-3, 0.0], [1e-3, 1e-3], [0.0, 1e-3]]
//!     .map(|[x, y]| Vector3::new(x, y, 0.0));
//! let skin = FaceParameters {
//!     young: 6e8,
//!     poisson: 0.48,
//!     thickness: 1.2e-4,
//!     normal_stiffness: 1e9,
//!     gradient_stiffness: 0.0,
//! };
//! let parameters = LayerParameters::uniform(skin, 2, 2e9, 4);
//! let mesh = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
//! let pinned = [true, false, false, false];
//! let layer = LayerEnergy::new(&mesh, &rest, parameters, &pinned)?;
//!
//! let raised = rest.map(|x| x + Vector3::new(0.0, 0.0, 1e-5));
//! let parts = layer.energy_parts(&raised);
//! // 1/2 K0 w^2 on a square millimetre; a translation strains nothing.
//! assert!((parts.normal - 5e-8).abs() < 1e-20);
//! assert!((layer.value(&raised) - parts.normal).abs() < 1e-18);
//!
//! let mut hessian = vec![0.0; layer.pattern().1.len()];
//! layer.hessian(&raised, &mut hessian, None);
//! assert_eq!(layer.dof_count(), 9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bending_model;
mod collapse;
mod crease;
mod crease_state;
mod energy_parts;
mod layer_bending;
mod layer_creases;
mod layer_energy;
mod layer_foundation;
mod layer_part;
mod line_anchor;
mod natural_curvature;
mod parameters;
mod shared_out;
mod sharp_fold;
mod sheet;
mod sheet_slots;
mod sheet_springs;
mod stencil;
mod upper_sheet;

mod foundation;
mod hinge;
mod hinge_stiffness;
mod layer_springs;
mod membrane;
mod response;
mod response_query;
mod vertex_curvature;

mod error;
mod rest_triangle;
mod stars;

pub use bending_model::BendingModel;
pub use crease::{Crease, FoldSense};
pub use crease_state::CreaseState;
pub use energy_parts::EnergyParts;
pub use layer_energy::LayerEnergy;
pub use layer_foundation::FoundationStiffness;
pub use layer_part::{LayerPart, PartIndex};
pub use line_anchor::{LineAnchor, line_spring_energy, line_spring_pulls};
pub use natural_curvature::MAX_NATURAL_ANGLE;
pub use parameters::{FaceParameters, LayerParameters, MIN_AREA_LEFT};
pub use upper_sheet::UpperSheet;

pub use foundation::{Anchor, NormalFoundation, TangentialSpring};
pub use hinge::{Hinge, HingeState};
pub use hinge_stiffness::{HINGE_EXPONENT, HingeShape, MAX_EDGE_RATIO};
pub use layer_springs::{LayerSpringParameters, LayerSpringState, LayerSprings};
pub use membrane::{Membrane, MembraneState, Stress};
pub use vertex_curvature::StarShape;

pub use response::{ResponseModulus, creased_response, face_corners, response_modulus};
pub use response_query::ResponseQuery;
pub use rest_triangle::{MIN_AREA_RATIO, RestTriangle};

pub use error::ShellError;
