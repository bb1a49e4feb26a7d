//! Everything that the study measures.

use std::error::Error;

use ruga_validation::cpu_seconds;
use ruga_validation::curling_strip::{LENGTH, WIDTH, curling_strip};
use ruga_validation::spring_sheet::curl::CurlStrip;
use ruga_validation::spring_sheet::{Mobility, Projection, Solver, SpringLattice, fast_projection};
use serde::{Deserialize, Serialize};

/// All of it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Findings {
    pub(crate) curls: Vec<Curl>,
    pub(crate) speeds: Vec<Speed>,
}

/// A strip that one method bent.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Curl {
    /// Whether springs did; otherwise the product.
    pub(crate) is_springs: bool,
    /// Distance of the two layers in cells of the springs.
    pub(crate) thickness: f64,
    /// Projections of the springs, or triangles across the product's strip.
    pub(crate) number: usize,
    /// Mean curvature over that wanted.
    pub(crate) curl: f64,
    /// Processor seconds.
    pub(crate) seconds: f64,
    /// Processor seconds after which the product, on its way there, is as near as the springs get.
    pub(crate) as_near: Option<f64>,
}

impl Curl {
    /// What the curvature is off by, over that wanted.
    pub(crate) fn error(&self) -> f64 {
        (self.curl - 1.0).abs()
    }
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

/// Distances of the two layers, in cells.
pub(crate) const THICKNESSES: [f64; 2] = [0.25, 0.0625];

/// Cells of the strip of springs: four across, as the coarsest of the product's meshes.
const CELLS: [usize; 2] = [40, 4];

/// What the corner layer is shorter by.
const SHRINKAGE: f64 = 0.02;

/// Projections after which springs are looked at.
pub(crate) const PROJECTIONS: [usize; 5] = [1, 7, 50, 200, 1000];

/// Triangles across the product's strip. Two are too few where layers are close: they cannot bend that far.
const ACROSS: [usize; 5] = [2, 4, 8, 16, 24];

/// Share of triangles too large for their natural curvature above which a strip is left out.
const MOST_CAPPED: f64 = 0.05;

/// Cells along a side of square sheets with about as many springs as those of the paper's table 2.
const SIDES: [usize; 5] = [10, 20, 40, 50, 100];

/// Times that a run is made; the quickest counts.
const REPEATS: usize = 3;

/// Seconds from which on a run is made once.
const LONG: f64 = 1.0;

impl Findings {
    /// Everything, or the coarser half of it if quick.
    pub(crate) fn measure(quick: bool) -> Result<Self, Box<dyn Error>> {
        let of = |counts: &[usize]| counts[..counts.len() - usize::from(quick)].to_vec();
        let mut findings = Self::default();
        for thickness in THICKNESSES {
            eprintln!("curl, layers {thickness} of a cell apart");
            let mut best = springs(thickness, &of(&PROJECTIONS))?;
            for _ in 1..REPEATS {
                let again = springs(thickness, &of(&PROJECTIONS))?;
                for (best, again) in best.iter_mut().zip(again) {
                    best.seconds = best.seconds.min(again.seconds);
                }
            }
            let near = best.iter().map(Curl::error).fold(f64::INFINITY, f64::min);
            findings.curls.append(&mut best);
            for across in of(&ACROSS) {
                findings.curls.extend(product(thickness, across, near)?);
            }
        }
        for side in of(&SIDES) {
            eprintln!("{side} by {side} cells");
            findings.speeds.push(speed(side)?);
        }
        Ok(findings)
    }
}

fn strip(thickness: f64) -> Result<CurlStrip, Box<dyn Error>> {
    let cell = WIDTH / CELLS[1] as f64;
    Ok(CurlStrip::new(CELLS, cell, thickness * cell, SHRINKAGE)?)
}

/// Curl by springs after numbers of projections, without the time of setting up.
fn springs(thickness: f64, projections: &[usize]) -> Result<Vec<Curl>, Box<dyn Error>> {
    let mut strip = strip(thickness)?;
    let (mut done, mut seconds) = (0, 0.0);
    let mut curls = Vec::new();
    for &number in projections {
        let settings = Projection {
            steps: number - done,
            threshold: 0.0,
            ..Projection::default()
        };
        let start = cpu_seconds();
        strip.project(&settings);
        seconds += cpu_seconds() - start;
        done = number;
        curls.push(Curl {
            is_springs: true,
            thickness,
            number,
            curl: strip.curl(),
            seconds,
            as_near: None,
        });
    }
    Ok(curls)
}

/// Curl by the product, of a strip that wants the same curvature, and when it is as `near` to that; nothing if its
/// triangles are too large.
fn product(thickness: f64, across: usize, near: f64) -> Result<Option<Curl>, Box<dyn Error>> {
    let wanted = strip(thickness)?.wanted;
    let sheet = thickness * WIDTH / CELLS[1] as f64;
    let mut best = curling_strip(across, wanted, sheet)?;
    for _ in 1..REPEATS {
        if best.total_seconds() < LONG {
            let again = curling_strip(across, wanted, sheet)?;
            if again.total_seconds() < best.total_seconds() {
                best = again;
            }
        }
    }
    if !best.converged {
        return Err(format!("{across} triangles across do not come to rest").into());
    }
    let share = best.capped as f64 / best.faces as f64;
    eprintln!(
        "{across} triangles across, {} Newton steps, {:.1} % of them too large",
        best.steps,
        100.0 * share
    );
    let mut way = best.curls.iter().zip(&best.seconds);
    let as_near = way.find(|(curl, _)| (*curl - 1.0).abs() <= near);
    Ok((share < MOST_CAPPED).then_some(Curl {
        is_springs: false,
        thickness,
        number: across,
        curl: best.curl(),
        seconds: best.total_seconds(),
        as_near: as_near.map(|(_, seconds)| *seconds),
    }))
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
