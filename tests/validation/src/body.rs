//! What a soft body under a skin has to show (Rémillard and Kry 2013, RK): slabs that are pushed and
//! bent, and what is measured on them.
//!
//! | part | figure of RK | measured |
//! |---|---|---|
//! | [`isocontours`] | 7 | wavelength against theory, over thickness and modulus ratio |
//! | [`dense`] | 6 | wavelength against that of a volume |
//! | [`cell_limit`] | | wavelength against theory, over the lattice's fineness |
//! | [`artefact`] | 4 | how far the skin's curvature follows the lattice's cells |
//! | [`locality`] | 3 | wrinkles outside the part of a bar that is bent |
//! | [`sizes`] | table 1 | time of a frame at the paper's sizes |
//! | [`Cushion`] | | a thousand steps in time of a body that bounces and is pressed |

mod artefact;
mod cell_limit;
mod cushion;
mod dense;
mod isocontours;
mod locality;
mod sheet;
mod sizes;
mod slab;
mod stopwatch;

pub use artefact::{Artefact, artefact};
pub use cell_limit::{CellLimit, cell_limit};
pub use cushion::{Cushion, Thrown};
pub use dense::{Dense, dense};
pub use isocontours::{Isocontour, Sample, is_compared, isocontours};
pub use locality::{Locality, locality};
pub use sheet::Sheet;
pub use sizes::{Kind, Row, Size, SizedBody, sizes};
pub use slab::{Slab, SlabRun, coupling_name, push};
pub use stopwatch::Times;

/// How much of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All samples: about half an hour on one core.
    Full,
    /// The corners of what is sampled: one to two minutes.
    Quick,
}
