//! Where wrinkles are when a bar is bent at one end only (RK, figure 3).

use std::error::Error;

use nalgebra::Vector3;
use ruga_constraint::{SampleConstraints, constraint_rows};
use ruga_stepper::{CellShape, Coupling, Motion};
use serde::{Deserialize, Serialize};

use super::Slab;
use super::artefact::turn;
use crate::baselines::global_rows;

/// Compression of the top where the bar is bent, in critical strains.
const STRAIN: f64 = 2.2;

/// Cells along, across and down, and wavelengths to a cell.
const CELLS: [u32; 3] = [12, 2, 2];
const CELL: f64 = 1.2;

/// Cells between which the bar is bent: from a handle at its end to one before its middle.
const BENT: [f64; 2] = [1.0, 5.0];

/// Wavelengths beside the bent part that belong to it: a wave does not end at once.
const MARGIN: f64 = 0.5;

/// Name and way in which a skin is held: every coupling that there is, and by global functions.
const HOLDINGS: [(&str, Coupling, SampleConstraints); 4] = [
    ("hybrid", Coupling::Hybrid, constraint_rows),
    ("elastic", Coupling::Elastic, constraint_rows),
    ("hard rows", Coupling::Constraint, constraint_rows),
    ("spectral", Coupling::Constraint, global_rows),
];

/// Where the wrinkles of a bent bar are.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Locality {
    /// How skin and inside hold together.
    pub coupling: String,
    /// Share of the squared heights outside the bent part.
    pub outside: f64,
    /// Amplitude in the bent part, in skin thicknesses.
    pub amplitude: f64,
    /// Place of every column in wavelengths, and RMS height there in thicknesses.
    pub profile: Vec<[f64; 2]>,
    /// From where to where the bar is bent, in wavelengths.
    pub bent: [f64; 2],
    /// Whether every step found its equilibrium.
    pub converged: bool,
}

/// Bends the same bar with every coupling.
///
/// # Errors
/// What the simulator refuses.
pub fn locality() -> Result<Vec<Locality>, Box<dyn Error>> {
    HOLDINGS.into_iter().map(measure).collect()
}

fn measure(
    (name, coupling, sample): (&str, Coupling, SampleConstraints),
) -> Result<Locality, Box<dyn Error>> {
    let mut slab = Slab {
        size: Vector3::repeat(1.0),
        cells: CELLS[0],
        shape: CellShape::Quadratic,
        young: 5e4,
        ratio: 100.0,
        thickness: 5e-4,
        coupling,
        sample,
        points: 8.0,
        is_fitted: true,
        slices: Vec::new(),
    };
    let theory = slab.theory()?;
    let cell = CELL * theory.wavelength;
    slab.size = Vector3::from(CELLS.map(|cells| f64::from(cells) * cell));
    let bent = BENT.map(|place| place * cell);
    slab.slices = vec![
        ("end", [-1.0, bent[0]]),
        ("middle", [bent[1], bent[1] + cell]),
    ];
    let compression = STRAIN * theory.critical_strain;
    let bend = bend("end", compression, (bent, slab.size.z));
    let run = slab.simulate(vec![bend], &[1.0])?;
    let squares = run.sheets[0].squares();
    let margin = MARGIN * theory.wavelength;
    let inside = [bent[0] - margin, bent[1] + margin];
    let total: f64 = squares.iter().map(|column| column[1]).sum();
    let is_outside = |place: f64| place < inside[0] || place > inside[1];
    let outside = squares.iter().filter(|column| is_outside(column[0]));
    let profile = squares
        .iter()
        .map(|[x, square]| [x / theory.wavelength, square.sqrt() / slab.thickness]);
    Ok(Locality {
        coupling: name.to_owned(),
        outside: outside.map(|column| column[1]).sum::<f64>() / total,
        amplitude: run.sheets[0].amplitude(bent) / slab.thickness,
        profile: profile.collect(),
        bent: bent.map(|place| place / theory.wavelength),
        converged: run.converged,
    })
}

/// A slab as high as that, bent upwards between two places along x by the slice at the first so that
/// its top is compressed.
pub(super) fn bend(of: &str, compression: f64, ([from, to], height): ([f64; 2], f64)) -> Motion {
    // An arc whose middle line keeps its length: its end is lifted, and nearer.
    let free = to - from;
    let angle = compression * free / (0.5 * height);
    let mut bend = turn(of, angle, [from, 0.5 * height]);
    let arc = Vector3::new(1.0 - angle.sin() / angle, 0.0, (1.0 - angle.cos()) / angle);
    bend.keyframes[0].translation = free * arc;
    bend
}
