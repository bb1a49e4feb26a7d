//! Short waves in a relief: the part of its energy that a low-pass filter takes away.

use nalgebra::Vector3;
use ruga_stepper::LayerSurface;

/// Waves shorter than this fraction of the critical wavelength are speckle.
const SHORT: f64 = 0.4;

/// The filter keeps `1 / (1 + (k / k_cut)^4)` of a wave: half at the cut, 94 % at twice its length. A steeper one
/// cannot be solved for in double precision where a mesh has slivers.
const POWER: usize = 2;

/// Where the iterative solution of the filter ends.
const ITERATIONS: usize = 3000;
const TOLERANCE: f64 = 1e-4;

/// Fractions of the integrals of squared heights, and of squared slopes, which normal maps show, in waves
/// shorter than 40 % of the critical wavelength (m) that `wavelength` knows of every face.
pub(crate) fn speckle(layer: &LayerSurface, wavelength: impl Fn(usize) -> f64) -> [f64; 2] {
    let heights = heights(layer);
    let filter = Filter::new(layer, wavelength);
    let smooth = filter.smooth(&heights);
    let pairs = heights.iter().zip(&smooth);
    let short: Vec<f64> = pairs.map(|(own, low)| own - low).collect();
    let fraction = |energy: &dyn Fn(&[f64]) -> f64| match energy(&heights) {
        whole if whole > 0.0 => energy(&short) / whole,
        _ => 0.0,
    };
    [
        fraction(&|values| filter.dot(values, values)),
        fraction(&|values| filter.slope_energy(values)),
    ]
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
        let mut areas = vec![0.0; places.len()];
        let mut edges = Vec::new();
        for (number, face) in layer.faces.iter().enumerate() {
            let cut = std::f64::consts::TAU / (SHORT * wavelength(number));
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

    /// The values without short waves, by conjugate gradients.
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
