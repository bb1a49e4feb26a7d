//! Whether a mesh's UVs can carry a map.

use nalgebra::Vector2;
use rayon::prelude::*;

/// What stands in the way of baking to these UVs, by face.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct UvReport {
    /// Faces with a UV that is not finite; they take no part in the other checks.
    pub missing: Vec<u32>,
    /// Faces that reach out of `[0, 1]²` by more than 1e-6.
    pub outside: Vec<u32>,
    /// `(face, earlier face)`: every face that overlaps an earlier one, with the first such one.
    pub overlaps: Vec<(u32, u32)>,
    /// Faces whose UVs are mirrored: counter-clockwise with V down.
    pub mirrored: Vec<u32>,
    /// Faces whose UV area is below 1e-12.
    pub zero_area: Vec<u32>,
}

/// UV area, in units of the tile, below which a face has none: a millionth of a texel of a 1K map.
const MIN_AREA: f64 = 1e-12;

/// UVs exported as 32-bit floats miss the border of the tile by less than this.
const OUTSIDE_TOLERANCE: f64 = 1e-6;

/// Shared area, relative to the smaller face, above which two faces overlap.
const OVERLAP_TOLERANCE: f64 = 1e-6;

/// Checks the UVs of every face's corners, V down.
///
/// Faces overlap when they share more than a millionth of the smaller one's area, so common edges
/// and corners are no overlap, whether or not they are the same vertices; a chart folded over an
/// edge is. A stack of n identical faces gives n - 1 pairs.
pub fn check_uvs(uvs: &[[Vector2<f64>; 3]]) -> UvReport {
    let faces_where = |test: &(dyn Fn(&[Vector2<f64>; 3]) -> bool + Sync)| -> Vec<u32> {
        (0..uvs.len() as u32)
            .filter(|&face| test(&uvs[face as usize]))
            .collect()
    };
    let present = |uv: &[Vector2<f64>; 3]| uv.iter().flatten().all(|c| c.is_finite());
    let out = |c: &f64| *c < -OUTSIDE_TOLERANCE || *c > 1.0 + OUTSIDE_TOLERANCE;
    UvReport {
        missing: faces_where(&|uv| !present(uv)),
        outside: faces_where(&|uv| present(uv) && uv.iter().flatten().any(out)),
        overlaps: overlaps(
            uvs,
            &faces_where(&|uv| present(uv) && area(uv).abs() > MIN_AREA),
        ),
        mirrored: faces_where(&|uv| present(uv) && area(uv) > MIN_AREA),
        zero_area: faces_where(&|uv| present(uv) && area(uv).abs() <= MIN_AREA),
    }
}

fn area([a, b, c]: &[Vector2<f64>; 3]) -> f64 {
    (b - a).perp(&(c - a)) / 2.0
}

fn overlaps(uvs: &[[Vector2<f64>; 3]], faces: &[u32]) -> Vec<(u32, u32)> {
    let grid = FaceGrid::new(uvs, faces);
    faces
        .par_iter()
        .filter_map(|&face| Some((face, grid.first_overlap(uvs, face)?)))
        .collect()
}

/// Faces by the cells that their bounding boxes touch.
struct FaceGrid {
    low: Vector2<f64>,
    cell: Vector2<f64>,
    side: usize,
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl FaceGrid {
    /// About one cell per face.
    fn new(uvs: &[[Vector2<f64>; 3]], faces: &[u32]) -> Self {
        let mut low = Vector2::repeat(f64::INFINITY);
        let mut high = Vector2::repeat(f64::NEG_INFINITY);
        for &face in faces {
            for uv in &uvs[face as usize] {
                low = low.inf(uv);
                high = high.sup(uv);
            }
        }
        let side = ((faces.len() as f64).sqrt() as usize).clamp(1, 2048);
        let cell = (high - low) / side as f64;
        let mut grid = Self {
            low,
            cell,
            side,
            starts: vec![0; side * side + 1],
            faces: Vec::new(),
        };
        grid.fill(uvs, faces);
        grid
    }

    fn fill(&mut self, uvs: &[[Vector2<f64>; 3]], faces: &[u32]) {
        let mut starts = vec![0_u32; self.side * self.side + 1];
        for &face in faces {
            self.for_cells(&uvs[face as usize], |cell| starts[cell + 1] += 1);
        }
        for cell in 0..self.side * self.side {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut filled = vec![0; starts[self.side * self.side] as usize];
        for &face in faces {
            self.for_cells(&uvs[face as usize], |cell| {
                filled[next[cell] as usize] = face;
                next[cell] += 1;
            });
        }
        self.starts = starts;
        self.faces = filled;
    }

    fn for_cells(&self, uv: &[Vector2<f64>; 3], mut visit: impl FnMut(usize)) {
        let low = uv[0].inf(&uv[1]).inf(&uv[2]);
        let high = uv[0].sup(&uv[1]).sup(&uv[2]);
        let index = |p: Vector2<f64>, axis: usize| {
            let at = (p[axis] - self.low[axis]) / self.cell[axis];
            (at.max(0.0) as usize).min(self.side - 1)
        };
        for row in index(low, 1)..=index(high, 1) {
            for column in index(low, 0)..=index(high, 0) {
                visit(row * self.side + column);
            }
        }
    }

    /// The first face before `face` that overlaps it.
    fn first_overlap(&self, uvs: &[[Vector2<f64>; 3]], face: u32) -> Option<u32> {
        let mut first = face;
        self.for_cells(&uvs[face as usize], |cell| {
            let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
            for &other in &self.faces[range] {
                // Faces of a cell are in ascending order.
                if other >= first {
                    break;
                }
                if overlap(&uvs[face as usize], &uvs[other as usize]) {
                    first = other;
                }
            }
        });
        (first < face).then_some(first)
    }
}

/// Whether two triangles share more than [`OVERLAP_TOLERANCE`] of the smaller one's area.
fn overlap(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> bool {
    if separated(a, b) || separated(b, a) {
        return false;
    }
    let smaller = area(a).abs().min(area(b).abs());
    shared_area(a, b) > OVERLAP_TOLERANCE * smaller
}

/// Whether an edge line of `a` has `a` on one side and `b` on the other.
fn separated(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> bool {
    let sign = area(a).signum();
    (0..3).any(|i| {
        let edge = (a[(i + 1) % 3] - a[i]) * sign;
        b.iter().all(|p| edge.perp(&(p - a[i])) <= 0.0)
    })
}

/// Area of the intersection: `a` clipped by the three edges of `b` (Sutherland & Hodgman 1974).
fn shared_area(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> f64 {
    // Relative to a corner, so that small triangles far from the origin keep their digits.
    let origin = b[0];
    let sign = area(b).signum();
    let mut polygon: Vec<Vector2<f64>> = a.iter().map(|p| p - origin).collect();
    for i in 0..3 {
        let start = b[i] - origin;
        let edge = (b[(i + 1) % 3] - b[i]) * sign;
        let inside: Vec<f64> = polygon.iter().map(|p| edge.perp(&(p - start))).collect();
        let mut clipped = Vec::with_capacity(polygon.len() + 1);
        for at in 0..polygon.len() {
            let next = (at + 1) % polygon.len();
            if inside[at] >= 0.0 {
                clipped.push(polygon[at]);
            }
            if (inside[at] >= 0.0) != (inside[next] >= 0.0) {
                let t = inside[at] / (inside[at] - inside[next]);
                clipped.push(polygon[at] + (polygon[next] - polygon[at]) * t);
            }
        }
        polygon = clipped;
    }
    let fan = |i: usize| (polygon[i] - polygon[0]).perp(&(polygon[i + 1] - polygon[0]));
    (1..polygon.len().saturating_sub(1))
        .map(fan)
        .sum::<f64>()
        .abs()
        / 2.0
}
