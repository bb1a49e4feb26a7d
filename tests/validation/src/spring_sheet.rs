//! The double layer of springs of Jeong, Kim and Kim 2011, *Shrinkage, wrinkling and ablation of burning
//! cloth and paper*, in the paper's words a body-centred square (BCS) held by successive fast projection.
//!
//! ```text
//! o---B---o     corner particles o in one plane, joined along edges (blue) and across cells (yellow)
//! |\Y   /R|     centre particles x, one per cell, a thickness above it, joined to each other (green)
//! | \ x   |     and each to its four corners (red)
//! o---B---o
//!
//! C = |x_a - x_b|^2/l - l = 0                              one constraint per spring of target length l   (10)
//! (G G^T) lambda = W C,      x <- x - G^T lambda           one set after another: R, G, B, Y         (16, 17, 19)
//! l = l_init (v_0 + v_1)/2                                 v: share of volume that burning left             (6)
//! ```
//!
//! A sheet is a [`SpringLattice`] (which particles each spring joins, and how long it ought to be) and positions in
//! the caller's hands; [`fast_projection`] moves them by a [`Projection`], [`SpringMotion`] by that and inertia.
//! [`Collider`]s stand in their way. [`SpringFire`] has temperatures and masses, which heat, conducted by [`Conduction`],
//! and burning change; [`Remnant`] is what marching triangles leave of the drawn mesh where material has burnt away.
//!
//! The paper contradicts itself or is silent in places. Each has a name here, the printed way beside the mended one:
//! [`Mobility`] (masses, and particles that are held), [`TimeRule`] (the factor `h`), [`BurnRule`] (whether burning heats
//! or cools). [`burning::BurningSheet`] is all of it together, and [`MassSpring`] what the paper compares itself with.
//! Nothing of this is in the
//! product, which has one energy with a rest metric and a natural curvature in place of two layers of springs.
//!
//! Lengths in metres, masses in kilograms, times in seconds.

pub mod burning;
mod collider;
mod conduction;
mod conjugate_gradient;
pub mod curl;
mod heat;
mod lattice;
mod marching;
mod mass_spring;
mod projection;
mod spring_set;
mod time_step;

pub use collider::{Collider, Shape};
pub use conduction::Conduction;
pub use conjugate_gradient::Solver;
pub use heat::{BurnRule, Fuel, HeatBall, SpringFire, SpringState};
pub use lattice::{LEAST_SHARE, SpringLattice};
pub use marching::{Remains, Remnant};
pub use mass_spring::MassSpring;
pub use projection::{Mobility, Projection, ProjectionReport, SpringColour, fast_projection};
pub use spring_set::{SpringError, SpringSet};
pub use time_step::{SpringMotion, TIME_STEP, TimeRule};
