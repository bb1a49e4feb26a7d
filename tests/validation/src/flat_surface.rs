//! A layer over a rectangle, asked by place: heights, lines across its wrinkles, wavelengths.

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};
use ruga_bake::{BakeSettings, TangentFrame, bake};
use ruga_mesh::{Id, PerFace, PlanarLookup};
use ruga_stepper::LayerSurface;

use crate::skin::relief;

/// Wavelengths at which a peak is looked for: half a per cent apart over a factor of three.
const WAVELENGTHS: usize = 200;

/// A layer over a rectangle that its texture covers once, whatever has become of the rectangle.
pub struct FlatSurface<'a> {
    layer: &'a LayerSurface,
    /// Places of its vertices in the rectangle, from the middle, m.
    rest: Vec<Vector2<f64>>,
    lookup: PlanarLookup,
}

/// Heights along lines in x, evenly sampled.
#[derive(Clone, Debug)]
pub struct Lines {
    /// Distance between two samples at rest, m.
    pub step: f64,
    /// Heights, m.
    pub heights: Vec<Vec<f64>>,
}

impl<'a> FlatSurface<'a> {
    /// Takes a layer over a rectangle of this extent at rest (m).
    pub fn new(layer: &'a LayerSurface, [length, width]: [f64; 2]) -> Self {
        let place = |uv: Vector2<f64>| Vector2::new((uv.x - 0.5) * length, (uv.y - 0.5) * width);
        let triangles: PerFace<_> = layer.uvs.iter().map(|face| face.map(place)).collect();
        let mut rest = vec![Vector2::zeros(); layer.positions.len()];
        for (face, corners) in layer.faces.iter().zip(triangles.as_slice()) {
            for (v, corner) in face.iter().zip(corners) {
                rest[*v as usize] = *corner;
            }
        }
        Self {
            layer,
            rest,
            lookup: PlanarLookup::new(triangles),
        }
    }

    /// Distance of the layer from the driver at rest, m.
    pub fn offset(&self) -> f64 {
        self.layer.offset
    }

    /// Position in space of the layer's material at a place of the rectangle, m.
    ///
    /// # Panics
    /// When the layer does not reach there.
    pub fn position(&self, place: Vector2<f64>) -> Vector3<f64> {
        let point = self.lookup.locate(place).expect("a place of the layer");
        let corners = self.layer.faces[point.face.index()];
        let corners = corners.map(|v| self.layer.positions[v as usize]);
        let weighted = corners.iter().zip(point.barycentric);
        weighted.map(|(x, weight)| x * weight).sum()
    }

    /// Height of every vertex over the driver, m.
    fn heights(&self) -> Vec<f64> {
        let layer = self.layer;
        let lifted = layer.positions.iter().zip(&layer.driver_positions);
        let lifted = lifted.zip(&layer.driver_normals);
        lifted
            .map(|((x, p), n)| (x - p).dot(n) - layer.offset)
            .collect()
    }

    /// Heights along `count` lines in a rectangle of this extent about the middle (m).
    ///
    /// # Panics
    /// When the layer does not reach there.
    pub fn lines(&self, [length, width]: [f64; 2], step: f64, count: usize) -> Lines {
        let samples = (length / step) as usize;
        let step = length / samples as f64;
        let all = self.heights();
        let height = |place: Vector2<f64>| {
            let point = self.lookup.locate(place).expect("a place of the layer");
            let corners = self.layer.faces[point.face.index()].iter();
            let weighted = corners.zip(point.barycentric);
            weighted.map(|(v, weight)| all[*v as usize] * weight).sum()
        };
        let line = |j: usize| -> Vec<f64> {
            let y = ((j as f64 + 0.5) / count as f64 - 0.5) * width;
            let place = |i: usize| Vector2::new(i as f64 * step - 0.5 * length, y);
            (0..=samples).map(|i| height(place(i))).collect()
        };
        Lines {
            step,
            heights: (0..count).map(line).collect(),
        }
    }

    /// Mean height of the vertices in a rectangle of this extent about the middle, and `sqrt(2)` RMS
    /// height about that, m.
    pub fn moments(&self, [length, width]: [f64; 2]) -> [f64; 2] {
        let mut areas = vec![0.0; self.rest.len()];
        for face in self.layer.faces.iter() {
            let [a, b, c] = face.map(|v| self.rest[v as usize]);
            let area = 0.5 * (b - a).perp(&(c - a)).abs();
            for v in face {
                areas[*v as usize] += area / 3.0;
            }
        }
        let (mut total, mut sum, mut square) = (0.0, 0.0, 0.0);
        for ((place, area), height) in self.rest.iter().zip(areas).zip(self.heights()) {
            if 2.0 * place.x.abs() < length && 2.0 * place.y.abs() < width {
                total += area;
                sum += area * height;
                square += area * height * height;
            }
        }
        let mean = sum / total;
        [mean, (2.0 * (square / total - mean * mean)).sqrt()]
    }
}

impl Lines {
    /// The wavelength inside `range` (m) at which the heights have most power; `None` when that is an end
    /// of the range, and no peak.
    pub fn peak(&self, range: [f64; 2]) -> Option<f64> {
        let ratio = (range[1] / range[0]).powf(1.0 / WAVELENGTHS as f64);
        let wavelength = |i: f64| range[0] * ratio.powf(i);
        let powers: Vec<f64> = (0..=WAVELENGTHS)
            .map(|i| self.power(wavelength(i as f64)))
            .collect();
        let best = (0..=WAVELENGTHS).max_by(|&a, &b| powers[a].total_cmp(&powers[b]));
        let best = best.filter(|best| (1..WAVELENGTHS).contains(best))?;
        // The top of the parabola through the three greatest.
        let [before, top, after] = [best - 1, best, best + 1].map(|i| powers[i]);
        let shift = 0.5 * (before - after) / (before - 2.0 * top + after);
        Some(wavelength(best as f64 + shift))
    }

    /// Mean over the lines of the squared amplitude of the wave of length `wavelength` (m), under a
    /// Hann window, m².
    pub fn power(&self, wavelength: f64) -> f64 {
        let of_line = |heights: &Vec<f64>| {
            let count = heights.len();
            let mean = heights.iter().sum::<f64>() / count as f64;
            let (mut real, mut imaginary, mut weights) = (0.0, 0.0, 0.0);
            for (i, height) in heights.iter().enumerate() {
                let weight = (PI * i as f64 / (count - 1) as f64).sin().powi(2);
                let (sin, cos) = (TAU * i as f64 * self.step / wavelength).sin_cos();
                real += weight * (height - mean) * cos;
                imaginary += weight * (height - mean) * sin;
                weights += weight;
            }
            4.0 * (real * real + imaginary * imaginary) / (weights * weights)
        };
        self.heights.iter().map(of_line).sum::<f64>() / self.heights.len() as f64
    }
}

/// Texels along a side of the map that normals are read from.
const TEXELS: usize = 512;

/// Normals of the layer's normal map along rows of texels, and where along U these are from the middle
/// of the texture, from -1/2 to 1/2: of every `strides[0]`-th texel in every `strides[1]`-th row, in the
/// `shares` of width and height about the middle.
///
/// The driver is a plane whose texture lies along x and y.
///
/// # Panics
/// When the baker refuses the layer.
pub fn baked_lines(
    layer: &LayerSurface,
    shares: [f64; 2],
    strides: [usize; 2],
) -> Vec<Vec<(f64, Vector3<f64>)>> {
    let flat = TangentFrame {
        normal: Vector3::z(),
        tangent: Vector3::x(),
        sign: -1.0,
    };
    let triangles = layer.artist.iter().map(|of| of.0 as usize + 1).max();
    let settings = BakeSettings {
        size: TEXELS as u32,
        ..BakeSettings::default()
    };
    let map = bake(
        &relief(layer),
        &vec![[flat; 3]; triangles.unwrap_or(0)],
        &settings,
    );
    let map = map.expect("a layer that can be baked");
    let texels = |share: f64, stride: usize| {
        let reach = (0.5 * share * TEXELS as f64) as usize;
        (TEXELS / 2 - reach..TEXELS / 2 + reach).step_by(stride)
    };
    let normal = |row: usize, column: usize| {
        let along = (column as f64 + 0.5) / TEXELS as f64 - 0.5;
        let [x, y, z] = map.normals[row * TEXELS + column].map(f64::from);
        (along, Vector3::new(x, y, z))
    };
    let line = |row: usize| texels(shares[0], strides[0]).map(move |column| normal(row, column));
    texels(shares[1], strides[1])
        .map(|row| line(row).collect())
        .collect()
}
