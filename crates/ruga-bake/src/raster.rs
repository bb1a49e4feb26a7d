//! Exact assignment of samples to triangles.

use std::ops::Range;

use nalgebra::Vector2;

/// Corners further than this from the square, in its sides, would overflow the edge functions.
const MAX_TILES: f64 = 8.0;

/// A square of samples over a unit square of texture space, with sub-sample fixed-point coordinates.
///
/// UVs are rounded to at most 2^-27 (a thousandth of a texel even at the largest map), and from
/// there on all decisions are integer: corners shared by two triangles round to the same point, so
/// a sample belongs to exactly one of the triangles around it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampleGrid {
    side: u32,
    subsample_bits: u32,
    /// Lowest U and V of the unit square.
    origin: Vector2<f64>,
}

/// Outcome of placing a triangle on the grid.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Placed {
    /// It may cover samples.
    Inside(GridTriangle),
    /// It lies wholly outside the square.
    Outside,
    /// It has no area, or touches the square but reaches further than eight of its sides away.
    Unusable,
}

/// A triangle in fixed-point coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GridTriangle {
    corners: [[i64; 2]; 3],
    /// Twice the area, negative for clockwise triangles.
    area: i64,
}

/// A run of samples of one row inside a triangle, with barycentric coordinates along it.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// Columns of the samples.
    pub columns: Range<u32>,
    /// Barycentric coordinates of corners 0 and 1 at the first sample.
    pub start: [f64; 2],
    /// Their change from one sample to the next.
    pub step: [f64; 2],
}

impl SampleGrid {
    /// A grid of `side`² samples over the unit square with this lowest U and V; `side` is at most 2^16.
    pub(crate) fn new(side: u32, square: [i32; 2]) -> Self {
        let side_bits = side.next_power_of_two().trailing_zeros();
        Self {
            side,
            subsample_bits: 27 - side_bits,
            origin: Vector2::from(square.map(f64::from)),
        }
    }

    /// Rounds a UV triangle to the grid.
    pub(crate) fn place(&self, uvs: &[Vector2<f64>; 3]) -> Placed {
        let uvs = uvs.map(|uv| uv - self.origin);
        // Tested first: a face outside leaves no gap in the map and is not reported, however far
        // out it lies.
        for axis in 0..2 {
            if uvs.iter().all(|uv| uv[axis] < 0.0) || uvs.iter().all(|uv| uv[axis] > 1.0) {
                return Placed::Outside;
            }
        }
        if uvs.iter().flatten().any(|c| c.abs() > MAX_TILES) {
            return Placed::Unusable;
        }
        // At most 2^27 units per side and 2^31 across all sides that are accepted: products of two
        // differences stay within 2^62.
        let unit = (f64::from(self.side)) * f64::from(1_u32 << self.subsample_bits);
        let corners = uvs.map(|uv| [uv.x, uv.y].map(|c| (c * unit).round() as i64));
        let area = edge_function(corners[0], corners[1], corners[2]);
        if area == 0 {
            return Placed::Unusable;
        }
        Placed::Inside(GridTriangle { corners, area })
    }

    /// Rows of samples that the triangle may cover, inside the square.
    pub(crate) fn rows(&self, triangle: &GridTriangle) -> Range<u32> {
        self.sample_range(triangle.corners.map(|c| c[1]))
    }

    /// The triangles that may touch each band of `band_rows` rows, by number, ascending.
    pub(crate) fn bands(&self, placed: &[Placed], band_rows: u32) -> Vec<Vec<u32>> {
        let mut bands = vec![Vec::new(); self.side.div_ceil(band_rows) as usize];
        for (number, placed) in (0..).zip(placed) {
            if let Placed::Inside(triangle) = placed {
                let rows = self.rows(triangle);
                if !rows.is_empty() {
                    let [first, last] = [rows.start, rows.end - 1].map(|row| row / band_rows);
                    for band in &mut bands[first as usize..=last as usize] {
                        band.push(number);
                    }
                }
            }
        }
        bands
    }

    /// The samples of one row inside the triangle; nothing when there are none.
    pub(crate) fn run(&self, triangle: &GridTriangle, row: u32) -> Option<Run> {
        let columns = self.sample_range(triangle.corners.map(|c| c[0]));
        let first = [self.center(columns.start), self.center(row)];
        let sign = triangle.area.signum();
        let pitch = 1_i64 << self.subsample_bits;
        let [mut begin, mut end] = [0, i64::from(columns.end) - i64::from(columns.start)];
        let mut values = [0; 3];
        let mut steps = [0; 3];
        // Edge functions are linear along the row, so the first and last sample inside follow by
        // division instead of a test of each.
        for corner in 0..3 {
            let tail = triangle.corners[(corner + 1) % 3];
            let head = triangle.corners[(corner + 2) % 3];
            let value = sign * edge_function(tail, head, first);
            let step = -sign * (head[1] - tail[1]) * pitch;
            // Samples exactly on an edge are moved by an infinitesimal (e, e²): that decides every
            // edge and corner for one side only.
            let direction = [sign * (head[0] - tail[0]), sign * (head[1] - tail[1])];
            let owns_edge = direction[1] < 0 || (direction[1] == 0 && direction[0] > 0);
            let least = if owns_edge { 0 } else { 1 };
            // Indices i with value + i step >= least.
            match step.signum() {
                1 => begin = begin.max(div_ceil(least - value, step)),
                -1 => end = end.min((value - least).div_euclid(-step) + 1),
                _ if value < least => return None,
                _ => {}
            }
            values[corner] = value;
            steps[corner] = step;
        }
        if begin >= end {
            return None;
        }
        // The sign of a mirrored triangle is in the values already.
        let scale = 1.0 / triangle.area.abs() as f64;
        Some(Run {
            columns: columns.start + begin as u32..columns.start + end as u32,
            start: [0, 1].map(|c| (values[c] + begin * steps[c]) as f64 * scale),
            step: [0, 1].map(|c| steps[c] as f64 * scale),
        })
    }

    fn center(&self, index: u32) -> i64 {
        (i64::from(index) << self.subsample_bits) + (1_i64 << self.subsample_bits) / 2
    }

    /// Samples whose centres lie between the smallest and largest of the coordinates.
    fn sample_range(&self, coordinates: [i64; 3]) -> Range<u32> {
        let [a, b, c] = coordinates;
        let half = (1_i64 << self.subsample_bits) / 2;
        // A shift rounds down below zero, too, where a division would round towards it.
        let index = |coordinate: i64| (coordinate - half) >> self.subsample_bits;
        let side = i64::from(self.side);
        // Rounded up: a sample exactly on the smallest coordinate may be inside.
        let first = index(a.min(b).min(c) - 1) + 1;
        let last = index(a.max(b).max(c));
        let start = first.clamp(0, side);
        start as u32..(last + 1).clamp(start, side) as u32
    }
}

/// Twice the signed area of `a, b, p`.
fn edge_function(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// `n / d` rounded up, `d > 0`.
fn div_ceil(n: i64, d: i64) -> i64 {
    -((-n).div_euclid(d))
}
