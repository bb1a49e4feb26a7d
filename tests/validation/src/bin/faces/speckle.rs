//! Short waves in a relief: the part of its energy that is left by a high-pass filter.

use nalgebra::Vector3;
use ruga_stepper::{FaceState, LayerSurface};

/// Waves shorter than this fraction of the critical wavelength are speckle.
const SHORT: f64 = 0.4;

/// What is short is found by a filter that leaves `(k / k_0)^4 / (1 + (k / k_0)^4)` of a wave, used twice: half of a
/// wave is left at the cut, 5 % at 1.7 times its length, 1 % at 2.2 times. Used once it would leave 11 and 4 % there;
/// a power of eight cannot be solved for in double precision where a mesh has slivers.
const POWER: usize = 2;

/// Cut over `k_0`, as wave numbers: `(1 + sqrt(2))^(1/4)`, where each use of the filter leaves the root of a half.
const CUT: f64 = 1.246_505;

/// Where the iterative solution of the filter ends.
const ITERATIONS: usize = 3000;
const TOLERANCE: f64 = 1e-4;

/// Fractions of the integrals of squared heights, and of squared slopes, which normal maps show, in waves
/// shorter than 40 % of the critical wavelength in the `states` of the layer's faces.
pub(crate) fn speckle(layer: &LayerSurface, states: &[FaceState]) -> [f64; 2] {
    let heights = heights(layer);
    let filter = Filter::new(layer, states);
    let short = filter.short(&filter.short(&heights));
    let fraction = |energy: &dyn Fn(&[f64]) -> f64| match energy(&heights) {
        whole if whole > 0.0 => energy(&short) / whole,
        _ => 0.0,
    };
    [
        fraction(&|values| filter.dot(values, values)),
        fraction(&|values| filter.slope_energy(values)),
    ]
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

/// Cotangent Laplacian with lumped areas.
struct Filter {
    /// Vertices of an edge, the cotangent weight, and that in units of `k_0` squared.
    edges: Vec<(usize, usize, [f64; 2])>,
    areas: Vec<f64>,
}

impl Filter {
    fn new(layer: &LayerSurface, states: &[FaceState]) -> Self {
        let places = &layer.driver_positions;
        let mut areas = vec![0.0; places.len()];
        let mut edges = Vec::new();
        for (face, state) in layer.faces.iter().zip(states) {
            // Lengths are those of skin as it lies, and waves are as much shorter as it is pressed.
            let wavelength = state.wavelength * (1.0 - effective_strain(state));
            let unit = std::f64::consts::TAU / (SHORT * CUT * wavelength);
            let corners = face.map(|v| v as usize);
            for side in 0..3 {
                let [apex, a, b] = [0, 1, 2].map(|i| corners[(side + i) % 3]);
                let (to_a, to_b): (Vector3<f64>, Vector3<f64>) =
                    (places[a] - places[apex], places[b] - places[apex]);
                let doubled = to_a.cross(&to_b).norm().max(f64::MIN_POSITIVE);
                areas[apex] += doubled / 6.0;
                // Negative at obtuse angles: without these weights waves would seem shorter than they are. The sum of
                // squared slopes is positive all the same.
                let weight = 0.5 * to_a.dot(&to_b) / doubled;
                edges.push((a, b, [weight, weight / (unit * unit)]));
            }
        }
        Self { edges, areas }
    }

    /// `M^-1 L` of some values.
    fn laplacian(&self, values: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; values.len()];
        for &(a, b, [_, weight]) in &self.edges {
            let flow = weight * (values[a] - values[b]);
            result[a] += flow;
            result[b] -= flow;
        }
        for (value, area) in result.iter_mut().zip(&self.areas) {
            *value /= area.max(f64::MIN_POSITIVE);
        }
        result
    }

    fn applied(&self, values: &[f64]) -> Vec<f64> {
        let mut power = values.to_vec();
        for _ in 0..POWER {
            power = self.laplacian(&power);
        }
        values
            .iter()
            .zip(power)
            .map(|(own, high)| own + high)
            .collect()
    }

    /// The integral of squared slopes, but for a factor.
    fn slope_energy(&self, values: &[f64]) -> f64 {
        let edges = self.edges.iter();
        edges
            .map(|&(a, b, [weight, _])| weight * (values[a] - values[b]).powi(2))
            .sum()
    }

    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b).zip(&self.areas);
        pairs.map(|((a, b), area)| a * b * area).sum()
    }

    /// What the filter leaves of values.
    fn short(&self, values: &[f64]) -> Vec<f64> {
        let pairs = values.iter().zip(self.smooth(values));
        pairs.map(|(own, low)| own - low).collect()
    }

    /// What the filter takes off, by conjugate gradients.
    fn smooth(&self, values: &[f64]) -> Vec<f64> {
        let mut result = values.to_vec();
        let mut residual: Vec<f64> = {
            let applied = self.applied(&result);
            values.iter().zip(applied).map(|(own, a)| own - a).collect()
        };
        let mut direction = residual.clone();
        let mut size = self.dot(&residual, &residual);
        let enough = TOLERANCE * TOLERANCE * self.dot(values, values);
        for _ in 0..ITERATIONS {
            if size <= enough {
                break;
            }
            let applied = self.applied(&direction);
            let step = size / self.dot(&direction, &applied);
            for i in 0..result.len() {
                result[i] += step * direction[i];
                residual[i] -= step * applied[i];
            }
            let next = self.dot(&residual, &residual);
            for (own, new) in direction.iter_mut().zip(&residual) {
                *own = new + next / size * *own;
            }
            size = next;
        }
        if size > enough {
            eprintln!("the filter of short waves has not converged in {ITERATIONS} iterations");
        }
        result
    }
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
        let [heights, _] = speckle(&layer, &states);
        let expected = 0.05 * 0.05;
        assert!((heights / expected - 1.0).abs() < 0.25, "{heights}");
    }
}
