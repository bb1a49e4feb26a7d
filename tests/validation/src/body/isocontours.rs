//! Wavelengths of slabs that are pushed together, over thickness and modulus ratio (RK, figure 7).
//!
//! With all lengths scaled alike nothing changes, so the five thicknesses of one modulus ratio share
//! a block, and so its lattice: between the handles it is six wavelengths of the thickest skin long
//! and nine of the thinnest. The blocks of different ratios are the same in wavelengths.

use std::error::Error;

use nalgebra::Vector3;
use ruga_constraint::constraint_rows;
use ruga_material::MaterialError;
use ruga_stepper::{CellShape, Coupling};
use serde::{Deserialize, Serialize};

use super::slab::{coupling_name, push};
use super::{Extent, Sheet, Slab};

/// Thickness of the skin in the middle of the plot, m.
const THICKNESS: f64 = 5e-4;

/// Thickest skin over the thinnest.
const SPREAD: f64 = 1.5;

/// Modulus ratios, a half power of ten apart.
const RATIOS: [f64; 5] = [30.0, 95.0, 300.0, 950.0, 3000.0];

/// Wavelengths of the thickest skin to a cell. On cells shorter than a wavelength the lattice itself
/// wrinkles, every second cell, together with the skin.
const CELL: f64 = 1.2;

/// Cells along, across and down.
const CELLS: [u32; 3] = [7, 2, 2];

/// Cells from an end to where the strain is even: that of the handle and half a one more.
const UNEVEN: f64 = 1.5;

/// Shortening of the slab at the end, in critical strains. Handles hold more than their cells, and
/// what bulges takes some from the skin, which is left with about one and a half.
const STRAIN: f64 = 1.4;

/// Where wavelengths are measured: soon after the onset, and at the end.
const KEYS: [f64; 2] = [0.85, 1.0];

/// Edges per wavelength: between draft and standard.
const POINTS: f64 = 8.0;

/// Height in skin thicknesses from which on there are wrinkles.
const LEAST_AMPLITUDE: f64 = 0.05;

/// One thickness and ratio.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Sample {
    /// Of the skin, m.
    pub thickness: f64,
    /// Of skin and inside.
    pub ratio: f64,
}

/// What a sample gave.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Isocontour {
    /// Thickness and ratio.
    pub sample: Sample,
    /// How skin and inside hold together.
    pub coupling: String,
    /// Theory's wavelength at rest: `lambda_c (1 + eps_c/2)` for a strain that is finite, m.
    pub predicted: f64,
    /// Measured in the middle at rest soon after the onset and at the end; nothing where nothing
    /// wrinkled, m.
    pub measured: [Option<f64>; 2],
    /// The simulator's own measure at the end, m.
    pub reported: Option<f64>,
    /// Effective compression of the surface below the skin in the middle, in critical strains.
    pub demand: [f64; 2],
    /// Height of the waves in skin thicknesses.
    pub amplitude: f64,
    /// Depth of the block, m.
    pub depth: f64,
    /// Vertices of the skin.
    pub vertices: usize,
    /// Whether every step found its equilibrium.
    pub converged: bool,
    /// Time that it took, s.
    pub seconds: f64,
}

impl Isocontour {
    /// Relative errors of the wavelength.
    pub fn errors(&self) -> [Option<f64>; 2] {
        let error = |measured: f64| measured / self.predicted - 1.0;
        self.measured.map(|measured| measured.map(error))
    }
}

/// Simulates all samples with both couplings; `each` has them as they come.
///
/// # Errors
/// What the simulator refuses.
pub fn isocontours(
    extent: Extent,
    each: &mut dyn FnMut(&Isocontour),
) -> Result<(), Box<dyn Error>> {
    for coupling in [Coupling::Hybrid, Coupling::Constraint] {
        for sample in samples(extent) {
            each(&push_together(&Slab::of_sample(sample, coupling)?, sample)?);
        }
    }
    Ok(())
}

/// Whether a volume is made of a sample too: of three thicknesses and three ratios.
pub fn is_compared(sample: Sample) -> bool {
    let is_one_of =
        |value: f64, values: [f64; 3]| values.iter().any(|own| (value / own - 1.0).abs() < 1e-9);
    let thicknesses = [-0.5, 0.0, 0.5].map(|power| THICKNESS * SPREAD.powf(power));
    is_one_of(sample.thickness, thicknesses)
        && is_one_of(sample.ratio, [RATIOS[0], RATIOS[2], RATIOS[4]])
}

fn samples(extent: Extent) -> Vec<Sample> {
    let picked: &[usize] = match extent {
        Extent::Full => &[0, 1, 2, 3, 4],
        Extent::Quick => &[0, 4],
    };
    let sample = |i: usize, j: usize| Sample {
        thickness: THICKNESS * SPREAD.powf(0.25 * i as f64 - 0.5),
        ratio: RATIOS[j],
    };
    let ratios = picked.iter();
    ratios
        .flat_map(|&j| picked.iter().map(move |&i| sample(i, j)))
        .collect()
}

impl Slab {
    /// The block of a modulus ratio with a skin on it, held by its outermost cells.
    ///
    /// # Errors
    /// Impossible materials.
    pub(super) fn of_sample(sample: Sample, coupling: Coupling) -> Result<Self, MaterialError> {
        let mut slab = Self {
            size: Vector3::repeat(1.0),
            cells: CELLS[0],
            shape: CellShape::Quadratic,
            young: 5e4,
            ratio: sample.ratio,
            thickness: THICKNESS * SPREAD.sqrt(),
            coupling,
            sample: constraint_rows,
            points: POINTS,
            is_fitted: true,
            slices: Vec::new(),
        };
        let cell = CELL * slab.theory()?.wavelength;
        slab.thickness = sample.thickness;
        slab.size = Vector3::from(CELLS.map(|cells| f64::from(cells) * cell));
        slab.slices = vec![
            ("left", [-1.0, cell]),
            ("right", [slab.size.x - cell, 2.0 * slab.size.x]),
        ];
        Ok(slab)
    }
}

/// Moves the outermost cells of a slab towards each other, and measures its skin.
pub(super) fn push_together(slab: &Slab, sample: Sample) -> Result<Isocontour, Box<dyn Error>> {
    let theory = slab.theory()?;
    let cell = slab.size.x / f64::from(slab.cells);
    let free = slab.size.x - 2.0 * cell;
    let way = 0.5 * free * STRAIN * theory.critical_strain;
    let run = slab.simulate(vec![push("left", way), push("right", -way)], &KEYS)?;
    let middle = [UNEVEN * cell, slab.size.x - UNEVEN * cell];
    let poisson = slab.materials().0.poisson;
    let demand = |sheet: &Sheet| {
        let [along, across] = sheet.compression(middle);
        (along + poisson * across) / theory.critical_strain
    };
    let wavelength = |sheet: &Sheet| {
        let is_wrinkled = sheet.amplitude(middle) > LEAST_AMPLITUDE * slab.thickness;
        is_wrinkled.then(|| sheet.wavelength(middle)).flatten()
    };
    let sheets = [&run.sheets[0], &run.sheets[1]];
    Ok(Isocontour {
        sample,
        coupling: coupling_name(slab.coupling).to_owned(),
        predicted: theory.wavelength * (1.0 + 0.5 * theory.critical_strain),
        measured: sheets.map(wavelength),
        reported: run.report.wavelength,
        demand: sheets.map(demand),
        amplitude: sheets[1].amplitude(middle) / slab.thickness,
        depth: slab.size.z,
        vertices: run.report.vertices,
        converged: run.converged,
        seconds: run.seconds,
    })
}
