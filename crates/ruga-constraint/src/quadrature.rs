//! The kernel as fixed points in the tangent plane, and their transfer to vertices.

use nalgebra::Vector2;
use ruga_mesh::barycentric;

use crate::Kernel;
use crate::chart::Chart;
use crate::moment_match::{Degradation, match_moments, normalise};

/// Grid steps per support radius. 8.5 gives 253 points: a lattice that samples the kernel to
/// machine precision needs far fewer, but each point also samples the mesh's facets, whose error
/// averages out over the points.
const STEPS_PER_RADIUS: f64 = 8.5;

/// A lattice of equilateral triangles over the support, the centre on a node, one row on the axis.
struct Lattice {
    step: f64,
    /// Largest lattice index in either direction.
    extent: i32,
}

impl Lattice {
    fn over(radius: f64) -> Self {
        Self {
            step: radius / STEPS_PER_RADIUS,
            extent: (STEPS_PER_RADIUS / ROW_HEIGHT).ceil() as i32,
        }
    }

    fn side(&self) -> usize {
        2 * self.extent as usize + 1
    }

    fn place(&self, column: i32, row: i32) -> Vector2<f64> {
        let (column, row) = (f64::from(column), f64::from(row));
        Vector2::new(column + 0.5 * row, ROW_HEIGHT * row) * self.step
    }

    fn index(&self, column: i32, row: i32) -> usize {
        (row + self.extent) as usize * self.side() + (column + self.extent) as usize
    }

    /// The lattice points in the bounding box of a triangle.
    fn near(&self, triangle: [Vector2<f64>; 3]) -> impl Iterator<Item = (i32, i32)> + use<> {
        let limit = f64::from(self.extent);
        let span = move |low: f64, high: f64| {
            let first = (low - SLACK).ceil().clamp(-limit, limit + 1.0) as i32;
            let last = (high + SLACK).floor().clamp(-limit - 1.0, limit) as i32;
            first..=last
        };
        let low = triangle[0].inf(&triangle[1]).inf(&triangle[2]) / self.step;
        let high = triangle[0].sup(&triangle[1]).sup(&triangle[2]) / self.step;
        span(low.y / ROW_HEIGHT, high.y / ROW_HEIGHT).flat_map(move |row| {
            let shift = 0.5 * f64::from(row);
            span(low.x - shift, high.x - shift).map(move |column| (column, row))
        })
    }
}

/// Height of a row of equilateral triangles of side one.
const ROW_HEIGHT: f64 = 0.866_025_403_784_438_6;
/// Points on an edge, to rounding, belong to the triangle.
const SLACK: f64 = 1e-9;

/// A lattice point found on the surface.
struct Sample {
    corners: [u32; 3],
    barycentric: [f64; 3],
}

/// Weights of the chart's vertices: `w_i = Σ_q g_q φ_i(u_q)` with φ the hat functions.
///
/// Points beyond the border are left out; the others are then rescaled to the centroid of the
/// clipped kernel, which a lattice alone would miss by part of a step.
pub(crate) fn quadrature_weights(
    chart: &Chart,
    kernel: &Kernel,
) -> (Vec<f64>, Result<(), Degradation>) {
    let lattice = Lattice::over(kernel.radius());
    let mut is_found = vec![false; lattice.side() * lattice.side()];
    let (mut samples, mut places, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for &corners in &chart.faces {
        let triangle = corners.map(|s| chart.places[s as usize]);
        for (column, row) in lattice.near(triangle) {
            let place = lattice.place(column, row);
            let weight = kernel.weight(place.norm());
            let found = &mut is_found[lattice.index(column, row)];
            if *found || weight <= 0.0 {
                continue;
            }
            if let Some(barycentric) = inside(triangle, place) {
                *found = true;
                samples.push(Sample {
                    corners,
                    barycentric,
                });
                places.push(place);
                weights.push(weight);
            }
        }
    }
    let target = chart.clipped_centroid(kernel);
    let outcome = match_moments(&places, &mut weights, target, kernel.radius());
    (gather(chart, &samples, &weights), outcome)
}

fn inside(triangle: [Vector2<f64>; 3], place: Vector2<f64>) -> Option<[f64; 3]> {
    let mut weights = barycentric(triangle, place)?;
    if weights.iter().any(|&b| b < -SLACK) {
        return None;
    }
    weights.iter_mut().for_each(|b| *b = b.max(0.0));
    normalise(&mut weights);
    Some(weights)
}

fn gather(chart: &Chart, samples: &[Sample], weights: &[f64]) -> Vec<f64> {
    let mut gathered = vec![0.0; chart.vertices.len()];
    for (sample, weight) in samples.iter().zip(weights) {
        for (slot, b) in sample.corners.iter().zip(sample.barycentric) {
            gathered[*slot as usize] += b * weight;
        }
    }
    gathered
}
