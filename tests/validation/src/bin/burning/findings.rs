//! Everything that the study measures.

use std::error::Error;

use ruga_validation::cpu_seconds;
use ruga_validation::curl_panel::{CurlRun, REPEATS, SHRINKAGE, THICKNESSES, measure_curls};
use ruga_validation::curling_strip::LENGTH;
use ruga_validation::spring_sheet::curl::CurlStrip;
use ruga_validation::spring_sheet::{Mobility, Projection, Solver, SpringLattice, fast_projection};
use serde::{Deserialize, Serialize};

use crate::large::LargeRun;
use crate::pictures::Picture;

/// All of it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Findings {
    pub(crate) curls: Vec<CurlRun>,
    pub(crate) speeds: Vec<Speed>,
    /// Norms of the constraints of red, green, blue and yellow springs over projection steps (cells), figure 8.
    pub(crate) errors: Vec<[f64; 4]>,
    pub(crate) pictures: Vec<Picture>,
    #[serde(default)]
    pub(crate) large: Vec<LargeRun>,
}

/// Time of the seven projection steps that the paper's table 2 calls fully iterated.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Speed {
    pub(crate) springs: usize,
    /// Processor seconds.
    pub(crate) seconds: f64,
    /// Iterations of conjugate gradients, of all 28 systems.
    pub(crate) iterations: usize,
}

/// Cells along a side of square sheets with about as many springs as those of the paper's table 2.
const SIDES: [usize; 5] = [10, 20, 40, 50, 100];

/// Projection steps of the paper's figure 8, and what the corner layer is shorter by there.
const STEPS: usize = 39;
const SHRINKAGE_OF_FIGURE: f64 = 0.1;

impl Findings {
    /// Everything, or the coarser half of it if quick.
    pub(crate) fn measure(quick: bool) -> Result<Self, Box<dyn Error>> {
        let of = |counts: &[usize]| counts[..counts.len() - usize::from(quick)].to_vec();
        eprintln!("curl of strips");
        let mut findings = Self {
            curls: measure_curls(quick)?,
            errors: errors()?,
            ..Self::default()
        };
        for side in of(&SIDES) {
            eprintln!("{side} by {side} cells");
            findings.speeds.push(speed(side)?);
        }
        Ok(findings)
    }
}

/// Norms of the constraints of a strip of 20 by 4 cells, of which one layer is to be shorter at once.
fn errors() -> Result<Vec<[f64; 4]>, Box<dyn Error>> {
    let mut strip = CurlStrip::new([20, 4], 1.0, 0.25, SHRINKAGE_OF_FIGURE)?;
    let settings = Projection {
        steps: STEPS,
        threshold: 0.0,
        ..Projection::default()
    };
    Ok(strip.project(&settings).errors)
}

/// Seven projection steps of a square sheet whose corner layer shrinks.
fn speed(side: usize) -> Result<Speed, Box<dyn Error>> {
    let cell = LENGTH / side as f64;
    let thickness = THICKNESSES[0] * cell;
    let (mut lattice, rest) = SpringLattice::rectangle([side, side], cell, thickness)?;
    let mut shares = vec![1.0; rest.len()];
    shares[..lattice.corner_count()].fill(1.0 - SHRINKAGE);
    lattice.set_volume_shares(&shares)?;
    let mobility = Mobility::printed(&vec![false; rest.len()]);
    let settings = Projection {
        threshold: 0.0,
        ..Projection::default()
    };
    let mut solver = Solver::default();
    let mut best = Speed {
        springs: lattice.spring_count(),
        seconds: f64::INFINITY,
        iterations: 0,
    };
    for _ in 0..REPEATS {
        let mut positions = rest.clone();
        let start = cpu_seconds();
        let report = fast_projection(&lattice, &mobility, &settings, &mut positions, &mut solver);
        best.seconds = best.seconds.min(cpu_seconds() - start);
        best.iterations = report.iterations;
    }
    Ok(best)
}
