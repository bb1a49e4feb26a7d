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
///
/// Both come from the leading error terms of the scheme, which [`Wave`] solves for. Errors of the speed on
/// strips, in per cent, at `n` cells per width, without and with correction, in substeps in which the front goes
/// 0.2 and 0.5 cells:
/// ```text
/// p        n    0.2            0.5           |  p        n    0.2            0.5
/// 2.00     2   -10.0   -0.8   -19     -19 *  |  5.71     2    -3.6    0.4    -7.6   2.9
/// 2.00     4    -4.9    0.0   -10.7    1.5   |  5.71     4    -1.7    0.1    -4.0   0.5
/// 2.00     8    -2.5    0.0    -5.7    0.3   |  5.71     8    -0.9    0.0    -2.0   0.1
/// 3.43     2    -5.5    0.3   -11.1    4.8   |  14.3     2    -2.0    0.3    -4.4   1.9
/// 3.43     4    -2.6    0.1    -5.9    0.7   |  14.3     4    -1.0    0.1    -2.3   0.4
/// 3.43     8    -1.3    0.0    -3.1    0.1   |  14.3     8    -0.5    0.0    -1.1   0.1
/// * the fuel of a vertex burns in a few substeps: no correction is found
/// ```
/// At 1.5, where the burning zone is 0.6 widths long, 2 cells leave 9 and 4 cells leave 0.5.
pub(crate) struct CorrectionTable {
    /// Natural logarithm of the least speed factor and of the ratio between entries.
    start: f64,
    stride: f64,
    entries: Vec<Entry>,
}

/// The correction for one speed factor, without that of the mesh, which each vertex adds by its spacing.
#[derive(Clone, Copy)]
struct Entry {
    /// Width of the front (m).
    width: f64,
    diffusivity: f64,
    burn_rate: f64,
    /// Growth of the rate per square of rows per width.
    rate_growth: f64,
}

/// Entries of a table of factors that differ.
const ENTRIES: usize = 17;
/// Distance of the rows in a mesh of equilateral triangles of edge 1. Rows make up the error of a front along
/// them; in every other direction of such a mesh it has the same leading term. On a square grid with
/// diagonals, mean edges times this number are the grid lines' distance.
const ROW: f64 = 0.866;
/// Widest row that is corrected, in widths of the front. A front that is narrower is not resolved, and terms of second
/// order in the row say nothing of it.
const WIDEST_ROW: f64 = 0.7;
/// Factors on the rate within which corrections are kept, for the same reason: at heat ratios near 1 the
/// burning zone may be shorter than a row although the width is not.
const RATES: [f64; 2] = [0.5, 2.0];

impl CorrectionTable {
    /// Corrections for substeps of `substep` (s) on a mesh with a mean edge of `mean_edge` (m), of sheets
    /// whose speed factors lie between `least` and `most`.
    pub(crate) fn new(
        law: &BurnLaw,
        substep: f64,
        mean_edge: f64,
        [least, most]: [f64; 2],
    ) -> Self {
        let count = if most > least { ENTRIES } else { 1 };
        let start = least.ln();
        let stride = (most.ln() - start) / (count.max(2) - 1) as f64;
        let factors = (0..count).map(|k| (start + k as f64 * stride).exp());
        let entry = |factor| Entry::new(&law.faster(factor), substep, mean_edge);
        Self {
            start,
            stride,
            entries: factors.map(entry).collect(),
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
    fn new(law: &BurnLaw, substep: f64, mean_edge: f64) -> Self {
        let front = Front::of(law).ok();
        let entry = front.and_then(|front| Self::of_front(law, &front, substep, mean_edge));
        // Where no front lives, or the substep is too long for one, there is none to correct.
        entry.unwrap_or(Self {
            width: f64::INFINITY,
            diffusivity: 1.0,
            burn_rate: 1.0,
            rate_growth: 0.0,
        })
    }

    fn of_front(law: &BurnLaw, front: &Front, substep: f64, mean_edge: f64) -> Option<Self> {
        let loss_rate = law.loss_time.map_or(0.0, f64::recip);
        let (speed, width) = (front.speed, front.width);
        let unit = law.diffusivity / speed;
        let exact = Wave::exact(law.heat_ratio(), unit / speed * loss_rate);
        let stepped = Wave {
            step: substep * speed / unit,
            ..exact
        };
        let row = (ROW * mean_edge).min(WIDEST_ROW * width);
        let meshed = Wave {
            spread: (row / unit).powi(2) / 12.0,
            ..stepped
        };
        let [exact, stepped, meshed] = [exact, stepped, meshed].map(|wave| wave.burning_number());
        // The implicit step sees exp(-x/w) rise by this rate where the front moves, instead of c/w.
        let rise = -(-speed * substep / width).exp_m1() / substep;
        Some(Self {
            width,
            diffusivity: (rise + loss_rate) / (speed / width + loss_rate),
            burn_rate: stepped? / exact?,
            rate_growth: (meshed? / stepped? - 1.0) * (width / row).powi(2),
        })
    }

    /// Adds what a mesh of mean edge `spacing` (m) needs.
    fn on_mesh(&self, spacing: f64) -> Correction {
        let row = (ROW * spacing / self.width).min(WIDEST_ROW);
        // On rows, the second difference of exp(-x/w) is (2 cosh(row) - 2)/row² times its derivative.
        let half = 0.5 * row;
        let conduction = if half > 0.0 { half / half.sinh() } else { 1.0 };
        Correction {
            diffusivity: self.diffusivity * conduction * conduction,
            burn_rate: (self.burn_rate * (1.0 + self.rate_growth * row * row))
                .clamp(RATES[0], RATES[1]),
        }
    }
}
