//! Wavelengths of embedded skins against those of volumes (RK, figure 6).

use std::error::Error;

use ruga_stepper::Coupling;
use serde::{Deserialize, Serialize};

use super::{Isocontour, Sample, Slab};
use crate::reference::DenseBlock;

/// Wavelengths among which a volume's is looked for, over that of theory.
const RANGE: [f64; 2] = [0.8, 1.25];

/// One skin on a block, in both ways.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub struct Dense {
    /// Thickness and ratio.
    pub sample: Sample,
    /// Wavelength of the volume at its onset, at rest, m.
    pub volume: f64,
    /// Its onset over the critical strain of theory.
    pub onset: f64,
    /// Wavelength of the embedded skin at its end, at rest, m.
    pub embedded: Option<f64>,
}

impl Dense {
    /// Relative error of the embedded skin.
    pub fn error(&self) -> Option<f64> {
        self.embedded.map(|embedded| embedded / self.volume - 1.0)
    }
}

/// Finds the onset of a volume that has the skin and the block of a sample that was simulated with the
/// default coupling.
///
/// # Errors
/// Impossible materials.
pub fn dense(embedded: &Isocontour) -> Result<Dense, Box<dyn Error>> {
    let slab = Slab::of_sample(embedded.sample, Coupling::Hybrid)?;
    let theory = slab.theory()?;
    let (skin, inside) = slab.materials();
    let onset = DenseBlock::new(skin, inside).onset(RANGE.map(|share| share * theory.wavelength));
    Ok(Dense {
        sample: embedded.sample,
        volume: onset.wavelength,
        onset: onset.strain / theory.critical_strain,
        embedded: embedded.measured[1],
    })
}
