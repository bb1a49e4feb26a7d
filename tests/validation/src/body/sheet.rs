//! The skin of a slab over its material coordinates.

use nalgebra::{Vector2, Vector3};
use ruga_stepper::LayerSurface;

/// Distance from a triangle, in its own sizes or steps of the grid, up to which a point lies in it.
const ON_BORDER: f64 = 1e-6;

/// Heights and places of a skin on a regular grid of its material, x along the slab.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Grid points along x and y.
    count: [usize; 2],
    /// From one to the next at rest, m.
    spacing: [f64; 2],
    /// Of the skin, row by row along x, m.
    positions: Vec<Vector3<f64>>,
    /// Of the lattice's surface below, m.
    below: Vec<Vector3<f64>>,
    /// From there to the skin along the normal, m.
    heights: Vec<f64>,
}

impl Sheet {
    /// Of a slab's top of a `size` (m), whose texture is the left half of the image: from its triangles, which
    /// lie as they like, with as many grid points as these have corners.
    pub(super) fn new(layer: &LayerSurface, size: [f64; 2]) -> Self {
        let cell = (2.0 * size[0] * size[1] / layer.faces.len() as f64).sqrt();
        let count = size.map(|side| (side / cell).round() as usize + 1);
        let mut sheet = Self {
            count,
            spacing: [0, 1].map(|c| size[c] / (count[c] - 1) as f64),
            positions: vec![Vector3::repeat(f64::NAN); count[0] * count[1]],
            below: vec![Vector3::repeat(f64::NAN); count[0] * count[1]],
            heights: vec![f64::NAN; count[0] * count[1]],
        };
        for (face, uvs) in layer.faces.iter().zip(layer.uvs.iter()) {
            let corners = uvs.map(|uv| {
                let place = [2.0 * uv.x, uv.y];
                Vector2::from_fn(|c, _| place[c] * (count[c] - 1) as f64)
            });
            sheet.fill(layer, face.map(|v| v as usize), corners);
        }
        assert!(
            sheet.heights.iter().all(|height| height.is_finite()),
            "the layer covers all of the top"
        );
        sheet
    }

    /// Interpolates at the grid points in a triangle with these `corners` in steps of the grid.
    fn fill(&mut self, layer: &LayerSurface, face: [usize; 3], corners: [Vector2<f64>; 3]) {
        let [a, b, c] = corners;
        let area = (b - a).perp(&(c - a));
        let [low, high] = [a.inf(&b).inf(&c), a.sup(&b).sup(&c)];
        let range = |axis: usize| {
            // Points on a border are off it by rounding.
            let first = (low[axis] - ON_BORDER).ceil().max(0.0) as usize;
            let last = (high[axis] + ON_BORDER).floor().max(0.0) as usize;
            first..=last.min(self.count[axis] - 1)
        };
        let [columns, rows] = [range(0), range(1)];
        for j in rows {
            for i in columns.clone() {
                let p = Vector2::new(i as f64, j as f64);
                let weights = [(b, c), (c, a), (a, b)].map(|(q, r)| (q - p).perp(&(r - p)) / area);
                if weights.iter().any(|weight| *weight < -ON_BORDER) {
                    continue;
                }
                let mean = |of: &[Vector3<f64>]| {
                    let terms = face.iter().zip(weights);
                    terms.map(|(&v, weight)| of[v] * weight).sum()
                };
                let height = |v: usize| {
                    let deviation = layer.positions[v] - layer.driver_positions[v];
                    deviation.dot(&layer.driver_normals[v])
                };
                let at = self.at(i, j);
                self.positions[at] = mean(&layer.positions);
                self.below[at] = mean(&layer.driver_positions);
                let terms = face.iter().zip(weights);
                self.heights[at] = terms.map(|(&v, weight)| height(v) * weight).sum();
            }
        }
    }

    /// Grid points along x between two places (m).
    fn columns(&self, [from, to]: [f64; 2]) -> std::ops::RangeInclusive<usize> {
        let first = (from / self.spacing[0]).ceil().max(0.0) as usize;
        let last = (to / self.spacing[0]).floor() as usize;
        first..=last.min(self.count[0] - 1)
    }

    /// Rows of the middle half, away from the borders along x.
    fn rows(&self) -> std::ops::Range<usize> {
        self.count[1] / 4..self.count[1] - self.count[1] / 4
    }

    fn at(&self, i: usize, j: usize) -> usize {
        j * self.count[0] + i
    }

    /// Median distance of neighbouring crossings of the mean in the same direction, along x between
    /// two places and at rest, m: local, so that the slab's length does not choose it.
    pub fn wavelength(&self, between: [f64; 2]) -> Option<f64> {
        let mut lengths: Vec<f64> = self
            .rows()
            .flat_map(|j| self.crossing_distances(j, between))
            .collect();
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).copied()
    }

    fn crossing_distances(&self, row: usize, between: [f64; 2]) -> Vec<f64> {
        let columns = self.columns(between);
        let heights: Vec<f64> = columns.map(|i| self.heights[self.at(i, row)]).collect();
        let mean = heights.iter().sum::<f64>() / heights.len().max(1) as f64;
        let mut crossings: Vec<f64> = Vec::new();
        for (i, ends) in heights.windows(2).enumerate() {
            let [a, b] = [ends[0] - mean, ends[1] - mean];
            if (a < 0.0) != (b < 0.0) {
                crossings.push((i as f64 + a / (a - b)) * self.spacing[0]);
            }
        }
        crossings.windows(3).map(|ends| ends[2] - ends[0]).collect()
    }

    /// `sqrt(2)` times the RMS height between two places (m), m.
    pub fn amplitude(&self, between: [f64; 2]) -> f64 {
        let columns = self.columns(between);
        let squares = &self.squares()[columns.clone()];
        let sum: f64 = squares.iter().map(|column| column[1]).sum();
        (2.0 * sum / squares.len().max(1) as f64).sqrt()
    }

    /// Compression of the surface below along x between two places (m) and across there.
    pub fn compression(&self, between: [f64; 2]) -> [f64; 2] {
        let columns = self.columns(between);
        let rows = self.rows();
        let (first, last) = (*columns.start(), *columns.end());
        let (middle, row) = ((first + last) / 2, self.count[1] / 2);
        let length = |a: usize, b: usize| (self.below[b] - self.below[a]).norm();
        let along = length(self.at(first, row), self.at(last, row));
        let across = length(self.at(middle, rows.start), self.at(middle, rows.end - 1));
        [
            1.0 - along / ((last - first) as f64 * self.spacing[0]),
            1.0 - across / ((rows.len() - 1) as f64 * self.spacing[1]),
        ]
    }

    /// Place (m) of every column, and the mean square of the heights there, m^2.
    pub(super) fn squares(&self) -> Vec<[f64; 2]> {
        let rows = self.rows();
        let square = |i: usize| {
            let sum: f64 = rows
                .clone()
                .map(|j| self.heights[self.at(i, j)].powi(2))
                .sum();
            sum / rows.len() as f64
        };
        (0..self.count[0])
            .map(|i| [i as f64 * self.spacing[0], square(i)])
            .collect()
    }

    /// Angles of the skin in the plane of x and z along the middle, each with its place (m), between
    /// two places.
    pub(super) fn angles(&self, between: [f64; 2]) -> Vec<[f64; 2]> {
        let of = &self.positions;
        let row = self.count[1] / 2;
        let columns: Vec<usize> = self.columns(between).collect();
        let angle = |ends: &[usize]| {
            let way = of[self.at(ends[1], row)] - of[self.at(ends[0], row)];
            let place = 0.5 * (ends[0] + ends[1]) as f64 * self.spacing[0];
            [place, way.z.atan2(way.x)]
        };
        columns.windows(2).map(angle).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A sheet of 10 cm by 2 cm, compressed by 3 %, whose height is `wave` of x.
    fn sheet(wave: impl Fn(f64) -> f64) -> Sheet {
        let count = [101, 9];
        let place = |k: usize| [(k % count[0]) as f64 * 1e-3, (k / count[0]) as f64 * 2.5e-3];
        let places: Vec<[f64; 2]> = (0..count[0] * count[1]).map(place).collect();
        let below = places.iter().map(|[x, y]| Vector3::new(0.97 * x, *y, 0.0));
        let below: Vec<_> = below.collect();
        let heights: Vec<f64> = places.iter().map(|[x, _]| wave(*x)).collect();
        let lifted = below.iter().zip(&heights);
        Sheet {
            count,
            spacing: [1e-3, 2.5e-3],
            positions: lifted.map(|(p, h)| p + Vector3::z() * *h).collect(),
            below,
            heights,
        }
    }

    #[test]
    fn a_wave_is_as_long_and_as_high_as_it_is() {
        let length = 0.0123;
        let sheet = sheet(|x| 2e-4 + 1e-3 * (TAU * x / length).sin());
        let found = sheet.wavelength([0.01, 0.09]).expect("waves");
        assert!((found / length - 1.0).abs() < 2e-3, "{found}");
        let [along, across] = sheet.compression([0.01, 0.09]);
        assert!((along - 0.03).abs() < 1e-9 && across.abs() < 1e-9);
        let amplitude = sheet.amplitude([0.0, 0.1]);
        let expected = (1e-6_f64 + 2.0 * 4e-8).sqrt();
        assert!((amplitude / expected - 1.0).abs() < 0.02, "{amplitude}");
    }

    #[test]
    fn what_does_not_wave_has_no_wavelength() {
        assert_eq!(sheet(|x| x).wavelength([0.0, 0.1]), None);
    }
}
