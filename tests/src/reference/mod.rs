//! What a simulated film is compared with: the same physics by other means.
//!
//! | reference | exact in | leaves out |
//! |---|---|---|
//! | [`FilmTheory`] | the onset at finite strain | harmonics; the film's force stays at its onset |
//! | [`Chain`] | plane strain, any slope, 64 points per wave | the second direction |
//! | [`Plate`] | two directions, any foundation `K(k)`, no mesh | strains and slopes of the second order |
//!
//! The three agree where more than one of them holds. A chain with the hinges of a mesh
//! ([`BendingLaw::AlongEdges`]) gives the tabulated [`Anchor`]s.

mod analytic;
mod chain;
mod chain_energy;
mod fourier;
mod height_field;
mod plate;
mod relax;

pub use analytic::{Anchor, BendingLaw, FilmTheory, Onset};
pub use chain::{Chain, ChainState};
pub use fourier::Grid;
pub use height_field::{HeightField, Orientation, noise, wave};
pub use plate::{Carrier, Plate};
pub use relax::{RelaxSettings, Relaxed};
