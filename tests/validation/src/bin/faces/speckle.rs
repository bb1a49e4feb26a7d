//! Short waves in a relief: the part of its energy that is left by a high-pass filter.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_solver::{ConstraintRows, Kkt, LowerPattern, SolverError};
use ruga_stepper::{FaceState, LayerSurface};

/// Waves shorter than this fraction of the critical wavelength are speckle.
const SHORT: f64 = 0.4;

/// What is short is found by a filter that leaves `(k / k_0)^4 / (1 + (k / k_0)^4)` of a wave, used twice: half of a
/// wave is left at the cut, 5 % at 1.7 times its length, 1 % at 2.2 times. Used once it would leave 11 and 4 % there.
///
/// Cut over `k_0`, as wave numbers: `(1 + sqrt(2))^(1/4)`, where each use of the filter leaves the root of a half.
const CUT: f64 = 1.246_505;

/// Sine of the angle between two sides of a triangle below which it carries no slope.
const FLAT: f64 = 1e-9;

/// Fractions of the integrals of squared heights, and of squared slopes, which normal maps show, in waves
/// shorter than 40 % of the critical wavelength in the `states` of the layer's faces.
pub(crate) fn speckle(layer: &LayerSurface, states: &[FaceState]) -> Result<[f64; 2], SolverError> {
    let heights = heights(layer);
    let mut filter = Filter::new(layer, states)?;
    let once = filter.short(&heights)?;
    let short = filter.short(&once)?;
    let fraction = |energy: &dyn Fn(&[f64]) -> f64| match energy(&heights) {
        whole if whole > 0.0 => energy(&short) / whole,
        _ => 0.0,
    };
    Ok([
        fraction(&|values| filter.dot(values, values)),
        fraction(&|values| filter.slope_energy(values)),
    ])
}

/// Effective strain `e1 + nu e2` that a face feels, 0 where it is stretched: nearly the compression across its waves.
fn effective_strain(state: &FaceState) -> f64 {
    (state.strain_ratio * state.critical_strain).max(0.0)
}

/// Heights of the relief over the driver at all vertices, m.
fn heights(layer: &LayerSurface) -> Vec<f64> {
    let places = layer.relief.iter().zip(&layer.driver_positions);
    let places = places.zip(&layer.driver_normals);
    places
        .map(|((own, below), normal)| (own - below).dot(normal) - layer.offset)
        .collect()
}

/// Cotangent Laplacian `L` with lumped areas `M`, and a filter of them.
///
/// ```text
/// (M + L M^-1 L) y = M h      [ M  L ] [y]   [M h]
///                             [ L -M ] [z] = [ 0 ]      L in units of k_0 squared
/// ```
/// The larger system is solved, because the product is beyond double precision where a mesh has slivers.
struct Filter {
    /// Vertices of an edge, and the cotangent weight.
    edges: Vec<(usize, usize, f64)>,
    areas: Vec<f64>,
    /// The larger matrix, `y` and `z` of every vertex in turn.
    kkt: Kkt,
}

impl Filter {
    fn new(layer: &LayerSurface, states: &[FaceState]) -> Result<Self, SolverError> {
        let places = &layer.driver_positions;
        let mut areas = vec![0.0; places.len()];
        let mut edges = Vec::new();
        // The lower triangle of `L` in units of `k_0` squared, by columns.
        let mut columns: Vec<BTreeMap<usize, f64>> = (0..places.len())
            .map(|v| BTreeMap::from([(v, 0.0)]))
            .collect();
        for (face, state) in layer.faces.iter().zip(states) {
            // Lengths are those of skin as it lies, and waves are as much shorter as it is pressed.
            let wavelength = state.wavelength * (1.0 - effective_strain(state));
            let unit = std::f64::consts::TAU / (SHORT * CUT * wavelength);
            let corners = face.map(|v| v as usize);
            for side in 0..3 {
                let [apex, a, b] = [0, 1, 2].map(|i| corners[(side + i) % 3]);
                let (to_a, to_b): (Vector3<f64>, Vector3<f64>) =
                    (places[a] - places[apex], places[b] - places[apex]);
                let doubled = to_a.cross(&to_b).norm();
                areas[apex] += doubled / 6.0;
                if doubled <= FLAT * to_a.norm() * to_b.norm() {
                    continue;
                }
                // Negative at obtuse angles: without these weights waves would seem shorter than they are. The sum of
                // squared slopes is positive all the same.
                let weight = 0.5 * to_a.dot(&to_b) / doubled;
                edges.push((a, b, weight));
                let weight = weight / (unit * unit);
                *columns[a].entry(a).or_default() += weight;
                *columns[b].entry(b).or_default() += weight;
                *columns[a.min(b)].entry(a.max(b)).or_default() -= weight;
            }
        }
        Ok(Self {
            kkt: factorised(&columns, &areas)?,
            edges,
            areas,
        })
    }

    /// The integral of squared slopes, but for a factor.
    fn slope_energy(&self, values: &[f64]) -> f64 {
        let edges = self.edges.iter();
        edges
            .map(|&(a, b, weight)| weight * (values[a] - values[b]).powi(2))
            .sum()
    }

    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b).zip(&self.areas);
        pairs.map(|((a, b), area)| a * b * area).sum()
    }

    /// What the filter leaves of values.
    fn short(&mut self, values: &[f64]) -> Result<Vec<f64>, SolverError> {
        let weighted = values.iter().zip(&self.areas);
        let right: Vec<f64> = weighted
            .flat_map(|(value, area)| [value * area, 0.0])
            .collect();
        let mut smooth = vec![0.0; right.len()];
        self.kkt.solve(&right, &[], &mut smooth, &mut [])?;
        let pairs = values.iter().zip(smooth.iter().step_by(2));
        Ok(pairs.map(|(own, low)| own - low).collect())
    }
}

/// The factorised matrix of [`Filter`], of the lower triangle of `L` by `columns` and the diagonal of `M`.
fn factorised(columns: &[BTreeMap<usize, f64>], areas: &[f64]) -> Result<Kkt, SolverError> {
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (column, (entries, area)) in columns.iter().zip(areas).enumerate() {
        for part in 0..2 {
            for (&row, &weight) in entries {
                for other in 0..2 {
                    // Of a pair of unknowns of one vertex the lower triangle has one.
                    if row == column && other < part {
                        continue;
                    }
                    rows.push((2 * row + other) as u32);
                    values.push(match (row == column, part, other) {
                        (true, 0, 0) => *area,
                        (true, 1, 1) => -area,
                        _ if part != other => weight,
                        _ => 0.0,
                    });
                }
            }
            starts.push(rows.len());
        }
    }
    let pattern = LowerPattern::new(starts, rows)?;
    let mut kkt = Kkt::new(&pattern, &ConstraintRows::none(pattern.size()), 2)?;
    kkt.factorize(&values, &vec![0.0; pattern.size()])?;
    Ok(kkt)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave 1.7 times as long as the cut, of which 5 % are left, on triangles with angles of 117 degrees.
    #[test]
    fn obtuse_triangles_make_no_short_waves() {
        let (columns, rows) = (120_u32, 52_u32);
        let wave = |y: f64| 0.01 * (std::f64::consts::TAU * y / 17.0).cos();
        let mut layer = LayerSurface::default();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |c| (row, c))) {
            let (x, y) = (f64::from(column) + 0.5 * f64::from(row % 2), f64::from(row));
            layer.driver_positions.push(Vector3::new(x, y, 0.0));
            layer.driver_normals.push(Vector3::z());
            layer.relief.push(Vector3::new(x, y, wave(y)));
        }
        let corners = (0..rows - 1).flat_map(|row| (1..columns).map(move |c| row * columns + c));
        let faces = corners.flat_map(|b| {
            let (a, c, d) = (b - 1, b + columns, b + columns - 1);
            // The longer diagonal.
            match b / columns % 2 {
                0 => [[a, b, c], [a, c, d]],
                _ => [[a, b, d], [b, c, d]],
            }
        });
        layer.faces = faces.collect();
        let state = FaceState {
            wavelength: 17.0 / 1.7 / SHORT,
            ..FaceState::default()
        };
        let states = vec![state; layer.faces.len()];
        let [heights, _] = speckle(&layer, &states).expect("a filter");
        let expected = 0.05 * 0.05;
        assert!((heights / expected - 1.0).abs() < 0.25, "{heights}");
    }
}
