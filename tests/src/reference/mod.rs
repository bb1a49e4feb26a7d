//! What a simulated film is compared with: the same physics by other means.
//!
//! | reference | exact in | leaves out |
//! |---|---|---|
//! | [`FilmTheory`] | the onset at finite strain | harmonics; the film's force stays at its onset |
//! | [`Chain`] | plane strain, any slope, 64 points per wave | the second direction |
//! | [`Plate`] | two directions, any foundation `K(k)`, no mesh | strains and slopes of the second order |
//!
//!
//! [`ShellPatch`] is the simulator's own shell on the periodic base of a plate, and
//! [`StretchedSheet`] one on no base; [`HeightField`] measures the patterns of either.
//!
//! The three agree where more than one of them holds. A chain with the hinges of a mesh
//! ([`BendingLaw::AlongEdges`]) gives the tabulated [`Anchor`]s.

mod analytic;
mod chain;
mod chain_energy;
mod fourier;
mod height_field;
mod periodic_mesh;
mod periodic_shell;
mod plate;
mod relax;
mod shell_patch;
mod square_driver;
mod stretched_sheet;

pub use analytic::{Anchor, BendingLaw, FilmTheory, Onset};
pub use chain::{Chain, ChainState};
pub use fourier::Grid;
pub use height_field::{HeightField, Orientation, noise, wave};
pub use plate::{Carrier, Plate};
pub use relax::{RelaxSettings, Relaxed};
pub use shell_patch::{PatchRows, ShellPatch};
pub use square_driver::shrinking_square;
pub use stretched_sheet::{SheetState, StretchedSheet, square};
