//! What a simulated film is compared with: the same physics by other means.
//!
//! | reference | exact in | leaves out |
//! |---|---|---|
//! | [`FilmTheory`] | the onset at finite strain | harmonics; the film's force stays at its onset |
//! | [`Chain`] | plane strain, any slope, 64 points per wave | the second direction |
//! | [`CreasedChain`] | plane strain, any slope, a crease with rest angle or anchor | the second direction |
//! | [`Plate`] | two directions, any foundation `K(k)`, no mesh | strains and slopes of the second order |
//! | [`DenseBlock`] | the onset of a skin and a block that are one volume | what follows the onset |
//!
//! [`ShellPatch`] is the simulator's own shell on the periodic base of a plate, and
//! [`StretchedSheet`] one on no base; [`HeightField`] measures the patterns of either.
//!
//! The three agree where more than one of them holds. A chain with the hinges of a mesh
//! ([`BendingLaw::AlongEdges`]) gives the tabulated [`Anchor`]s.

mod analytic;
mod chain;
mod chain_energy;
mod creased_chain;
mod dense_block;
mod dense_newton;
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
pub use creased_chain::{COMPRESSIONS, CreasedChain, CreasedState, LinkLaw};
pub use dense_block::DenseBlock;
pub use fourier::Grid;
pub use height_field::{HeightField, Orientation, noise, wave};
pub use plate::{Carrier, Plate};
pub use relax::{RelaxSettings, Relaxed};
pub use shell_patch::{PatchRows, ShellPatch};
pub use square_driver::shrinking_square;
pub use stretched_sheet::{SheetState, StretchedSheet, square};

/// Place of the minimum of a function with a single one, by the golden section, within a
/// `tolerance` of it.
fn lowest(mut low: f64, mut high: f64, tolerance: f64, value: impl Fn(f64) -> f64) -> f64 {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let [mut a, mut b] = [high - share * (high - low), low + share * (high - low)];
    let [mut at_a, mut at_b] = [value(a), value(b)];
    // Near its minimum a function is flat: the place is known to about the root of its rounding.
    while high - low > tolerance * high {
        if at_a < at_b {
            high = b;
            (b, at_b) = (a, at_a);
            a = high - share * (high - low);
            at_a = value(a);
        } else {
            low = a;
            (a, at_a) = (b, at_b);
            b = low + share * (high - low);
            at_b = value(b);
        }
    }
    0.5 * (low + high)
}
