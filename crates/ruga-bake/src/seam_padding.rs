//! Padding that continues a chart with what lies beyond its seam.

use nalgebra::{Matrix2, Vector2, Vector3};
use rayon::prelude::*;

use crate::seams::{Across, Seams};
use crate::{BakeError, Coverage, Detail, WrinkleMap};

/// Rounds in which padding is read from padding: at the border itself, two charts depend on each
/// other's, with a weight of at most a quarter each time.
const ROUNDS: usize = 4;

/// Texels beside a seam that are continued at most: far smaller levels of detail read no further, and
/// the time grows with them.
const WIDEST: u32 = 64;

/// Nothing is nearer.
const NO_EDGE: u32 = u32::MAX;

impl WrinkleMap {
    /// Extends every UV island of the maps of one mesh by `padding` texels as [`Self::pad`] does, and
    /// replaces what lies before a seam by what lies behind it: filtered across the border of a chart, a map
    /// then has the same normal on both sides.
    ///
    /// A texel beside a seam takes the values at the place that its own place continues to on the
    /// unrolled surface, in whichever of `maps` it lies, interpolated, with directions turned into the
    /// chart's tangent frame. Beside an open border of the mesh, and where no map shows what lies beyond, it
    /// keeps those of the nearest texel.
    ///
    /// # Errors
    /// Those of [`Self::pad`]; [`BakeError::LengthMismatch`] when the maps differ in size or details.
    pub fn pad_across(maps: &mut [Self], seams: &Seams<'_>, padding: u32) -> Result<(), BakeError> {
        let details = |map: &Self| map.details.iter().map(|d| d.detail).collect::<Vec<_>>();
        for map in maps.iter() {
            map.same_size(&maps[0])?;
            if details(map) != details(&maps[0]) {
                return Err(BakeError::LengthMismatch {
                    array: "details",
                    found: map.details.len(),
                    expected: maps[0].details.len(),
                });
            }
        }
        for map in maps.iter_mut() {
            map.pad(seams.uvs(), padding)?;
        }
        let shown: Vec<[i32; 2]> = maps.iter().map(|map| map.square).collect();
        let of_map = maps.iter().map(|map| map.continued(seams, &shown, padding));
        let continued: Vec<Vec<Continued>> = of_map.collect();
        for _ in 0..ROUNDS {
            // All are read before the first is written: their order does not count.
            let read = |texels: &Vec<Continued>| -> Vec<Texel> {
                let texels = texels.par_iter();
                texels
                    .map(|texel| maps[texel.map].read(&texel.across))
                    .collect()
            };
            let values: Vec<Vec<Texel>> = continued.iter().map(read).collect();
            for ((map, continued), values) in maps.iter_mut().zip(&continued).zip(values) {
                for (texel, values) in continued.iter().zip(values) {
                    map.write(texel.texel, &values);
                }
            }
        }
        Ok(())
    }

    /// Padded texels whose nearest border edge has skin beyond, with the place that continues them in one of
    /// the maps of these squares.
    fn continued(&self, seams: &Seams<'_>, shown: &[[i32; 2]], padding: u32) -> Vec<Continued> {
        let side = self.size as usize;
        let origin = Vector2::from(self.square.map(f64::from));
        let border = seams.border();
        let mut nearest = vec![(f32::INFINITY, NO_EDGE); self.coverage.len()];
        for (number, edge) in (0..).zip(&border) {
            let ends = seams.ends(*edge).map(|uv| (uv - origin) * side as f64);
            let reach = f64::from(padding.min(WIDEST)) + 1.0;
            let range = |axis: usize| {
                let (a, b) = (ends[0][axis], ends[1][axis]);
                let first = (a.min(b) - reach).clamp(0.0, side as f64) as usize;
                first..((a.max(b) + reach).clamp(0.0, side as f64) as usize)
            };
            for row in range(1) {
                for column in range(0) {
                    let texel = row * side + column;
                    if self.coverage[texel] == Coverage::Padded {
                        let squared = squared_distance(ends, centre(texel, side)) as f32;
                        if squared < nearest[texel].0 {
                            nearest[texel] = (squared, number);
                        }
                    }
                }
            }
        }
        let texels = nearest.par_iter().enumerate();
        texels
            .filter(|(_, (_, edge))| *edge != NO_EDGE)
            .filter_map(|(texel, (_, edge))| {
                let uv = centre(texel, side) / side as f64 + origin;
                let across = seams.across(border[*edge as usize], &uv)?;
                // By its triangle: a place on the border of two squares could be either's.
                let square = square_of(&seams.uvs()[across.triangle as usize]);
                let map = shown.iter().position(|shown| *shown == square)?;
                Some(Continued { texel, map, across })
            })
            .collect()
    }

    /// Values at a place in another chart, bilinear, in the tangent frame of the one that it continues.
    fn read(&self, across: &Across) -> Texel {
        let origin = Vector2::from(self.square.map(f64::from));
        let weights = self.bilinear(&(across.uv - origin));
        let sum = |channel: &dyn Fn(usize) -> f32| -> f64 {
            let parts = weights.iter();
            parts.map(|(at, w)| w * f64::from(channel(*at))).sum()
        };
        let normal = Vector3::from([0, 1, 2].map(|c| sum(&|at| self.normals[at][c])));
        let normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let details = self.details.iter().map(|map| {
            let channels = map.detail.channels();
            let values = (0..channels).map(|c| sum(&|at| map.values[at * channels + c]));
            let mut values: Vec<f64> = values.collect();
            match map.detail {
                Detail::Displacement => turn(&across.turn, &mut values),
                Detail::ObjectNormal => {
                    let length = values.iter().map(|c| c * c).sum::<f64>().sqrt();
                    values.iter_mut().for_each(|c| *c /= length.max(1e-9));
                }
                // Numbers without a direction.
                Detail::Occlusion
                | Detail::Curvature
                | Detail::Compression
                | Detail::Mask
                | Detail::Char
                | Detail::Ash
                | Detail::Temperature
                | Detail::Thickness => {}
            }
            values
        });
        let mut directions = [normal.x, normal.y, normal.z];
        turn(&across.turn, &mut directions);
        Texel {
            normal: directions,
            height: sum(&|at| self.heights[at]),
            details: details.flatten().map(|value| value as f32).collect(),
        }
    }

    fn write(&mut self, texel: usize, values: &Texel) {
        self.normals[texel] = values.normal.map(|c| c as f32);
        self.heights[texel] = values.height as f32;
        let mut next = values.details.iter();
        for map in &mut self.details {
            let channels = map.detail.channels();
            let own = &mut map.values[texel * channels..(texel + 1) * channels];
            own.iter_mut()
                .zip(&mut next)
                .for_each(|(own, new)| *own = *new);
        }
    }

    /// The four texels around a texture coordinate, with weights.
    fn bilinear(&self, uv: &Vector2<f64>) -> [(usize, f64); 4] {
        let side = self.size as usize;
        let split = |c: f64| {
            let place = (c * side as f64 - 0.5).clamp(0.0, (side - 1) as f64);
            let low = place.floor();
            (
                [low as usize, (low as usize + 1).min(side - 1)],
                place - low,
            )
        };
        let ([left, right], x) = split(uv.x);
        let ([top, bottom], y) = split(uv.y);
        [
            (top * side + left, (1.0 - x) * (1.0 - y)),
            (top * side + right, x * (1.0 - y)),
            (bottom * side + left, (1.0 - x) * y),
            (bottom * side + right, x * y),
        ]
    }
}

/// A texel of padding with the place across the seam that it continues.
struct Continued {
    texel: usize,
    /// Number of the map that shows it.
    map: usize,
    across: Across,
}

/// The unit square that the middle of a triangle lies in.
fn square_of(uvs: &[Vector2<f64>; 3]) -> [i32; 2] {
    let middle = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
    [middle.x, middle.y].map(|c| c.floor() as i32)
}

/// What a texel of padding takes.
struct Texel {
    normal: [f64; 3],
    height: f64,
    /// Channels of all detail maps, one after the other.
    details: Vec<f32>,
}

/// Turns the first two of some coordinates.
fn turn(by: &Matrix2<f64>, coordinates: &mut [f64]) {
    let turned = by * Vector2::new(coordinates[0], coordinates[1]);
    coordinates[0] = turned.x;
    coordinates[1] = turned.y;
}

/// Centre of a texel, in texels.
fn centre(texel: usize, side: usize) -> Vector2<f64> {
    Vector2::new((texel % side) as f64 + 0.5, (texel / side) as f64 + 0.5)
}

fn squared_distance([a, b]: [Vector2<f64>; 2], p: Vector2<f64>) -> f64 {
    let edge = b - a;
    let part = ((p - a).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
    let part = if part.is_nan() { 0.0 } else { part };
    (p - a - edge * part).norm_squared()
}
