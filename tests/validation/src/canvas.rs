//! A picture that triangles are drawn into, the nearest in front.

use std::path::Path;

use nalgebra::{Vector2, Vector3};
use ruga_io::{IoError, PngTexels, write_png};

use crate::light::{Light, texel};

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;

/// Room around what is drawn, share of the picture's width.
const MARGIN: f64 = 0.03;

/// A white picture, three samples to a pixel's side.
pub struct Canvas {
    width: usize,
    height: usize,
    /// Samples, row by row from the top: distance to the eye's plane (larger is nearer) and light.
    samples: Vec<(f64, Light)>,
    /// Sample coordinates are `scale * place + shift`, V down.
    scale: f64,
    shift: Vector2<f64>,
}

impl Canvas {
    /// A picture `width` pixels wide, and as high as `places` (x right, y up) need.
    pub fn around<'a>(
        places: impl Iterator<Item = &'a Vector2<f64>> + Clone,
        width: usize,
    ) -> Self {
        let low = places
            .clone()
            .fold(Vector2::repeat(f64::INFINITY), |a, b| a.inf(b));
        let high = places.fold(Vector2::repeat(f64::NEG_INFINITY), |a, b| a.sup(b));
        let extent = (high - low).map(|e| e.max(f64::MIN_POSITIVE));
        let room = (1.0 - 2.0 * MARGIN) * (width * SAMPLES) as f64;
        // Tall things are as high as wide ones are wide.
        let scale = room / extent.max();
        let side = |extent: f64| {
            let pixels = scale * extent / SAMPLES as f64 + 2.0 * MARGIN * width as f64;
            (pixels.ceil() as usize).clamp(1, width)
        };
        let [width, height] = [side(extent.x), side(extent.y)];
        let middle = Vector2::new(width as f64, height as f64) * (0.5 * SAMPLES as f64);
        let centre = 0.5 * (low + high);
        Self {
            width,
            height,
            samples: vec![(f64::NEG_INFINITY, Light::repeat(1.0)); width * height * SAMPLES.pow(2)],
            scale,
            shift: middle - scale * Vector2::new(centre.x, -centre.y),
        }
    }

    /// Pixels per unit of length.
    pub fn pixels_per_length(&self) -> f64 {
        self.scale / SAMPLES as f64
    }

    /// Draws a triangle (x right, y up, z towards the eye); `light` is asked for at barycentric
    /// coordinates.
    pub fn triangle(&mut self, corners: [Vector3<f64>; 3], light: impl Fn([f64; 3]) -> Light) {
        let places = corners.map(|p| self.scale * Vector2::new(p.x, -p.y) + self.shift);
        let low = places[0].inf(&places[1]).inf(&places[2]);
        let high = places[0].sup(&places[1]).sup(&places[2]);
        let columns = self.width * SAMPLES;
        let range = |low: f64, high: f64, count: usize| {
            let first = (low - 0.5).ceil().max(0.0) as usize;
            first..((high - 0.5).floor() + 1.0).clamp(0.0, count as f64) as usize
        };
        for row in range(low.y, high.y, self.height * SAMPLES) {
            for column in range(low.x, high.x, columns) {
                let at = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
                let Some(inside) = ruga_mesh::barycentric(places, at) else {
                    return;
                };
                if inside.iter().any(|b| *b < 0.0) {
                    continue;
                }
                let depth = (0..3).map(|i| inside[i] * corners[i].z).sum();
                let sample = &mut self.samples[row * columns + column];
                if depth > sample.0 {
                    *sample = (depth, light(inside));
                }
            }
        }
    }

    /// Red, green and blue of every pixel, row by row from the top.
    fn pixels(&self) -> Vec<u8> {
        let columns = self.width * SAMPLES;
        let mut pixels = Vec::with_capacity(3 * self.width * self.height);
        for pixel in 0..self.width * self.height {
            let (row, column) = (pixel / self.width, pixel % self.width);
            let mut light = Light::zeros();
            for sample in 0..SAMPLES * SAMPLES {
                let (i, j) = (sample / SAMPLES, sample % SAMPLES);
                light += self.samples[(row * SAMPLES + i) * columns + column * SAMPLES + j].1;
            }
            pixels.extend(texel(light / (SAMPLES * SAMPLES) as f64));
        }
        pixels
    }

    /// Writes the picture as PNG.
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        write_png(
            path,
            self.width,
            self.height,
            PngTexels::Rgb8(&self.pixels()),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_triangle_is_seen_and_the_rest_is_white() {
        let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
        let mut canvas = Canvas::around(places.iter(), 50);
        let triangle = |z: f64| places.map(|p| p.push(z));
        let red = Light::new(1.0, 0.0, 0.0);
        canvas.triangle(triangle(1.0), |_| red);
        canvas.triangle(triangle(0.0), |_| Light::zeros());
        assert_eq!([canvas.width, canvas.height], [50, 50]);
        let pixels = canvas.pixels();
        let pixel = |row: usize, column: usize| &pixels[3 * (50 * row + column)..][..3];
        // The right angle is at the lower left.
        assert_eq!(pixel(45, 4), [255, 0, 0]);
        assert_eq!(pixel(10, 40), [255, 255, 255]);
        assert_eq!(pixel(0, 0), [255, 255, 255]);
    }

    #[test]
    fn light_is_asked_for_at_the_right_corner() {
        let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.5]].map(Vector2::from);
        let mut canvas = Canvas::around(places.iter(), 100);
        canvas.triangle(places.map(|p| p.push(0.0)), Vector3::from);
        assert!(canvas.height < 60);
        let pixels = canvas.pixels();
        let last = 3 * (100 * (canvas.height - 5) + 6);
        assert!(pixels[last] > 200 && pixels[last + 1] < 100 && pixels[last + 2] < 100);
    }
}
