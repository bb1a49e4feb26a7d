//! Short waves in a relief: the part of its energy that a low-pass filter takes away.

use nalgebra::Vector3;
use ruga_stepper::{FaceState, LayerSurface};

/// Waves shorter than this fraction of the critical wavelength are speckle.
const SHORT: f64 = 0.4;

/// What is short is found by a filter that takes `1 / (1 + (k / k_0)^4)` off a wave, used twice: half of a wave is left
/// at the cut, 5 % at 1.7 times its length, 1 % at 2.2 times. A power of eight in one filter cannot be solved for in
/// double precision where a mesh has slivers; a single one of four counts a fifth of waves that are 1.5 times as long as
/// the cut, which squeezed skin on a lid has.
const POWER: usize = 2;

/// `k_cut / k_0`: at the cut the filter leaves the root of a half, `(k_cut / k_0)^4 = 1 + sqrt(2)`.
const CUT: f64 = 1.246_479;

/// Where the iterative solution of the filter ends.
const ITERATIONS: usize = 3000;
const TOLERANCE: f64 = 1e-4;

/// Fractions of the integrals of squared heights, and of squared slopes, which normal maps show, in waves
/// shorter than 40 % of the critical wavelength (m) that `wavelength` knows of every face.
pub(crate) fn speckle(layer: &LayerSurface, wavelength: impl Fn(usize) -> f64) -> [f64; 2] {
    let heights = heights(layer);
    let filter = Filter::new(layer, wavelength);
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

/// Compression that a face of the layer feels, 0 where it is stretched.
fn compression(state: &FaceState) -> f64 {
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
    /// Vertices of an edge, the cotangent weight, and that in units of the squared wavenumber of the cut.
    edges: Vec<(usize, usize, [f64; 2])>,
    areas: Vec<f64>,
}

impl Filter {
    fn new(layer: &LayerSurface, wavelength: impl Fn(usize) -> f64) -> Self {
        let places = &layer.driver_positions;
        let states = layer.face_states.as_ref();
        let mut areas = vec![0.0; places.len()];
        let mut edges = Vec::new();
        for (number, face) in layer.faces.iter().enumerate() {
            // Lengths are those of skin as it lies, and waves are as much shorter as it is pressed.
            let pressed = states.map_or(0.0, |states| compression(&states[number]));
            let shortest = SHORT * CUT * wavelength(number) * (1.0 - pressed);
            let cut = std::f64::consts::TAU / shortest;
            let corners = face.map(|v| v as usize);
            for side in 0..3 {
                let [apex, a, b] = [0, 1, 2].map(|i| corners[(side + i) % 3]);
                let (to_a, to_b): (Vector3<f64>, Vector3<f64>) =
                    (places[a] - places[apex], places[b] - places[apex]);
                let doubled = to_a.cross(&to_b).norm().max(f64::MIN_POSITIVE);
                areas[apex] += doubled / 6.0;
                // Obtuse angles would make the Laplacian indefinite.
                let weight = (0.5 * to_a.dot(&to_b) / doubled).max(0.0);
                edges.push((a, b, [weight, weight / (cut * cut)]));
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
