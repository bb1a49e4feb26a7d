//! Layout of UVs in the plane.

use std::collections::HashMap;

use nalgebra::Vector2;

use crate::triangle_overlap::{area, shared_area};
use crate::uv_check::MIN_AREA;

/// Part of a tile by which an island may reach over its tile's border: a margin that was left too
/// small, not a layout that repeats.
const MARGIN: f64 = 0.02;

/// Extent and orientation of the UVs of some faces.
///
/// Shares are parts, 0 to 1, of the weights of all faces that have an area in UV.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvLayout {
    /// The smallest U and V of all faces.
    pub low: Vector2<f64>,
    /// The largest U and V.
    pub high: Vector2<f64>,
    /// Share inside the square `[0, 1]²`, which maps show.
    pub inside: f64,
    /// Share of the islands that lie in several tiles: on layouts that are larger than the square,
    /// but not on those that spread whole islands over tiles (UDIM).
    pub astride: f64,
    /// Share of the faces that are mirrored: clockwise as seen in the image, V down.
    pub mirrored: f64,
}

/// Looks at the UVs of every face's corners, V down; `weights` are, say, the faces' areas in space.
///
/// Faces whose UVs are not finite take no part. `None` when no face has an area in UV.
pub fn uv_layout(uvs: &[[Vector2<f64>; 3]], weights: &[f64]) -> Option<UvLayout> {
    let finite = |uv: &[Vector2<f64>; 3]| uv.iter().flatten().all(|c| c.is_finite());
    let faces: Vec<(&[Vector2<f64>; 3], f64)> = uvs
        .iter()
        .zip(weights.iter().copied())
        .filter(|(uv, weight)| finite(uv) && area(uv).abs() > MIN_AREA && *weight > 0.0)
        .collect();
    let total: f64 = faces.iter().map(|(_, weight)| weight).sum();
    if faces.is_empty() || !total.is_finite() {
        return None;
    }
    let share = |part: &dyn Fn(usize, &[Vector2<f64>; 3]) -> f64| {
        let parts = faces.iter().enumerate();
        let sum: f64 = parts.map(|(i, (uv, weight))| weight * part(i, uv)).sum();
        sum / total
    };
    let corners = || faces.iter().flat_map(|(uv, _)| uv.iter());
    let islands = Islands::of(&faces);
    Some(UvLayout {
        low: corners().fold(*corners().next()?, |low, uv| low.inf(uv)),
        high: corners().fold(*corners().next()?, |high, uv| high.sup(uv)),
        inside: share(&|_, uv| inside(uv)),
        astride: share(&|i, _| f64::from(islands.is_astride(i))),
        mirrored: share(&|_, uv| f64::from(area(uv) > 0.0)),
    })
}

/// The smallest and largest UV of the island that each face lies in: of the faces that hang together by
/// corners of the same UV. Faces without an area in UV, or whose UVs are not finite, have `None`.
pub fn island_boxes(uvs: &[[Vector2<f64>; 3]]) -> Vec<Option<[Vector2<f64>; 2]>> {
    let has_area = |uv: &[Vector2<f64>; 3]| {
        uv.iter().flatten().all(|c| c.is_finite()) && area(uv).abs() > MIN_AREA
    };
    let faces: Vec<(&[Vector2<f64>; 3], f64)> = uvs
        .iter()
        .filter(|uv| has_area(uv))
        .map(|uv| (uv, 1.0))
        .collect();
    let islands = Islands::of(&faces);
    let mut boxes = (0..faces.len()).map(|face| islands.extent(face));
    uvs.iter()
        .map(|uv| has_area(uv).then(|| boxes.next()).flatten())
        .collect()
}

/// Part of a triangle's area in the square.
fn inside(uv: &[Vector2<f64>; 3]) -> f64 {
    if uv.iter().flatten().all(|c| (0.0..=1.0).contains(c)) {
        return 1.0;
    }
    if (0..2).any(|axis| uv.iter().all(|p| p[axis] <= 0.0) || uv.iter().all(|p| p[axis] >= 1.0)) {
        return 0.0;
    }
    // The square as two triangles, which is what the clipping knows.
    let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from);
    let shared = shared_area(uv, &[a, b, c]) + shared_area(uv, &[a, c, d]);
    // Rounding of the two parts may exceed the whole.
    (shared / area(uv).abs()).min(1.0)
}

/// Faces that hang together by corners of the same UV.
struct Islands {
    /// A face of the same island that comes no later, or the face itself.
    earlier: Vec<usize>,
    /// Smallest and largest UVs of the island, at its first face.
    boxes: Vec<[Vector2<f64>; 2]>,
}

impl Islands {
    fn of(faces: &[(&[Vector2<f64>; 3], f64)]) -> Self {
        let boxes = faces
            .iter()
            .map(|([a, b, c], _)| [a.inf(b).inf(c), a.sup(b).sup(c)]);
        let mut islands = Self {
            earlier: (0..faces.len()).collect(),
            boxes: boxes.collect(),
        };
        let mut first_at: HashMap<[u64; 2], usize> = HashMap::new();
        for (face, (uvs, _)) in faces.iter().enumerate() {
            for uv in *uvs {
                // Adding zero makes one of the two zeros.
                let key = [uv.x + 0.0, uv.y + 0.0].map(f64::to_bits);
                let other = *first_at.entry(key).or_insert(face);
                islands.join(face, other);
            }
        }
        islands
    }

    fn join(&mut self, a: usize, b: usize) {
        let [a, b] = [a, b].map(|face| self.first(face));
        // The earlier face stays the root, where the island's box is.
        let [kept, gone] = [a.min(b), a.max(b)];
        self.earlier[gone] = kept;
        let [low, high] = self.boxes[gone];
        self.boxes[kept] = [
            self.boxes[kept][0].inf(&low),
            self.boxes[kept][1].sup(&high),
        ];
    }

    /// The island's first face; shortens the way there (path halving).
    fn first(&mut self, mut face: usize) -> usize {
        while self.earlier[face] != face {
            self.earlier[face] = self.earlier[self.earlier[face]];
            face = self.earlier[face];
        }
        face
    }

    /// Smallest and largest UVs of the island of a face.
    fn extent(&self, mut face: usize) -> [Vector2<f64>; 2] {
        while self.earlier[face] != face {
            face = self.earlier[face];
        }
        self.boxes[face]
    }

    fn is_astride(&self, face: usize) -> bool {
        let [low, high] = self.extent(face);
        // Astride: a border of the tiles lies between low and high, margins apart.
        (0..2).any(|axis| (low[axis] + MARGIN).floor() + 1.0 < high[axis] - MARGIN)
    }
}
