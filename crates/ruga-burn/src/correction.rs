//! Numerical diffusivity and rate with which the discrete front has the speed and width of the exact one.

use crate::wave::Wave;
use crate::{BurnLaw, Front};

/// Factors on diffusivity and burning rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Correction {
    pub(crate) diffusivity: f64,
    pub(crate) burn_rate: f64,
}

/// Corrections for speed factors between two bounds, tabulated because each takes a root.
pub(crate) struct CorrectionTable {
    /// Natural logarithm of the least speed factor and of the ratio between entries.
    start: f64,
    stride: f64,
    entries: Vec<Entry>,
}

/// What the front of one speed factor needs of the time step; the mesh comes in by each vertex' spacing.
#[derive(Clone, Copy)]
struct Entry {
    width: f64,
    diffusivity: f64,
    burn_rate: f64,
}

/// Entries of a table of factors that differ.
const ENTRIES: usize = 17;
/// Height of an equilateral triangle of edge 1: the distance of its rows, to which the error of a mesh
/// of about equilateral triangles belongs. On a square grid with diagonals it is that of the grid lines.
const ROW: f64 = 0.866;

impl CorrectionTable {
    /// Corrections for substeps of `substep` (s), of sheets whose speed factors lie between `least` and `most`.
    pub(crate) fn new(law: &BurnLaw, substep: f64, [least, most]: [f64; 2]) -> Self {
        let count = if most > least { ENTRIES } else { 1 };
        let start = least.ln();
        let stride = (most.ln() - start) / (count.max(2) - 1) as f64;
        let factors = (0..count).map(|k| (start + k as f64 * stride).exp());
        Self {
            start,
            stride,
            entries: factors.map(|f| Entry::new(law, f, substep)).collect(),
        }
    }

    /// The correction at a vertex with a speed factor and a mean edge of `spacing` (m).
    pub(crate) fn at(&self, factor: f64, spacing: f64) -> Correction {
        let last = self.entries.len() - 1;
        if last == 0 {
            return self.entries[0].on_mesh(spacing);
        }
        let place = ((factor.ln() - self.start) / self.stride).clamp(0.0, last as f64);
        let low = (place as usize).min(last - 1);
        let between = |a: f64, b: f64| a + (place - low as f64) * (b - a);
        let [a, b] = [low, low + 1].map(|k| self.entries[k].on_mesh(spacing));
        Correction {
            diffusivity: between(a.diffusivity, b.diffusivity),
            burn_rate: between(a.burn_rate, b.burn_rate),
        }
    }
}

impl Entry {
    fn new(law: &BurnLaw, factor: f64, substep: f64) -> Self {
        let local = law.faster(factor);
        // Where no front lives there is none to correct.
        Front::of(&local)
            .ok()
            .and_then(|front| Self::of_front(&local, &front, substep))
            .unwrap_or(Self {
                width: f64::INFINITY,
                diffusivity: 1.0,
                burn_rate: 1.0,
            })
    }

    fn of_front(law: &BurnLaw, front: &Front, substep: f64) -> Option<Self> {
        let loss_rate = law.loss_time.map_or(0.0, f64::recip);
        let (speed, width) = (front.speed, front.width);
        let unit_time = law.diffusivity / (speed * speed);
        let wave = Wave {
            heat_ratio: law.heat_ratio(),
            loss: unit_time * loss_rate,
            step: 0.0,
        };
        let stepped = Wave {
            step: substep / unit_time,
            ..wave
        };
        // The implicit step sees exp(-x/w) rise by this rate where the front moves, instead of c/w.
        let rise = -(-speed * substep / width).exp_m1() / substep;
        Some(Self {
            width,
            diffusivity: (rise + loss_rate) / (speed / width + loss_rate),
            burn_rate: stepped.burning_number()? / wave.burning_number()?,
        })
    }

    /// Adds what a mesh of mean edge `spacing` (m) needs.
    fn on_mesh(&self, spacing: f64) -> Correction {
        let row = ROW * spacing / self.width;
        // exp(-x/w) on rows: (2 cosh(row) - 2)/row² times its second derivative.
        let half = 0.5 * row;
        let conduction = if half > 0.0 {
            (half / half.sinh()).powi(2)
        } else {
            1.0
        };
        Correction {
            diffusivity: self.diffusivity * conduction,
            burn_rate: self.burn_rate,
        }
    }
}
