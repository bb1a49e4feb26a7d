//! Wavelengths on lattices of different fineness: where the lattice itself begins to wrinkle (RK 7.1:
//! then waves are as long as the lattice has it).

use std::error::Error;

use nalgebra::Vector3;
use ruga_constraint::constraint_rows;
use ruga_stepper::{CellShape, Coupling};
use serde::{Deserialize, Serialize};

use super::isocontours::{Isocontour, Sample, push_together};
use super::{Extent, Slab};

/// Wavelengths to a cell.
const CELLS: [f64; 9] = [0.4, 0.6, 0.75, 0.9, 1.0, 1.2, 1.5, 2.0, 4.0];
const FEW_CELLS: [f64; 2] = [0.75, 1.5];

/// Length between the handles, and width and depth, in wavelengths: about, for they are whole cells, and
/// in the length enough of them that some nodes are free.
const FREE: f64 = 7.2;
const LEAST_CELLS: f64 = 4.0;
const ACROSS: f64 = 2.4;

/// The same skin on one lattice.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct CellLimit {
    /// Wavelengths to a cell.
    pub cell: f64,
    /// What it gave.
    pub found: Isocontour,
}

/// Pushes slabs together that differ in their cells alone; `each` has them as they come.
///
/// # Errors
/// What the simulator refuses.
pub fn cell_limit(extent: Extent, each: &mut dyn FnMut(&CellLimit)) -> Result<(), Box<dyn Error>> {
    let cells: &[f64] = match extent {
        Extent::Full => &CELLS,
        Extent::Quick => &FEW_CELLS,
    };
    for &cell in cells {
        let sample = Sample {
            thickness: 5e-4,
            ratio: 300.0,
        };
        let found = push_together(&slab(sample, cell)?, sample)?;
        each(&CellLimit { cell, found });
    }
    Ok(())
}

fn slab(sample: Sample, cell: f64) -> Result<Slab, Box<dyn Error>> {
    let [along, across] = [FREE, ACROSS].map(|length| (length / cell).round().max(1.0));
    let mut slab = Slab {
        size: Vector3::repeat(1.0),
        // One at either end is held.
        cells: along.max(LEAST_CELLS) as u32 + 2,
        shape: CellShape::Quadratic,
        young: 5e4,
        ratio: sample.ratio,
        thickness: sample.thickness,
        coupling: Coupling::Hybrid,
        sample: constraint_rows,
        points: 8.0,
        is_fitted: true,
        slices: Vec::new(),
    };
    let edge = cell * slab.theory()?.wavelength;
    slab.size = Vector3::new(f64::from(slab.cells), across, across) * edge;
    slab.slices = vec![
        ("left", [-1.0, edge]),
        ("right", [slab.size.x - edge, 2.0 * slab.size.x]),
    ];
    Ok(slab)
}
