//! Intrinsic Delaunay triangulation: edges flipped on their lengths alone, vertices left where they are.

use std::collections::{BTreeMap, VecDeque};

use ruga_mesh::{EdgeId, Id, PerEdge, TriMesh};

use crate::BurnError;

/// A half-edge without a neighbour on the other side.
const BORDER: u32 = u32::MAX;
/// Least area of a triangle, in squares of its longest edge. Below, rounding of the lengths alone
/// decides the angles.
const LEAST_SHAPE: f64 = 1e-6;
/// A sum of cotangents this far below zero, as a share of its terms, is rounding and not an edge to flip.
pub(crate) const FLIP_TOLERANCE: f64 = 1e-10;
/// Flips per edge after which flipping stops. Delaunay flipping ends by itself; this bounds what
/// rounding may do in meshes of slivers.
const MOST_FLIPS_PER_EDGE: usize = 50;

/// Triangles that know the lengths of their edges and their neighbours, but no positions.
///
/// Half-edge `3 f + i` is edge `i` of triangle `f`, counter-clockwise. After flips two triangles may
/// share two edges, and an edge may begin and end at one vertex; both are right on a curved surface,
/// where straightest ways are not unique.
pub(crate) struct IntrinsicMesh {
    origins: Vec<u32>,
    twins: Vec<u32>,
    lengths: Vec<f64>,
    /// Shares of the given triangles in those that flips have changed.
    mixtures: BTreeMap<u32, Vec<(u32, f64)>>,
    flips: usize,
}

/// An edge between two vertices, with half the cotangent of the angle opposite in each triangle beside it.
pub(crate) struct IntrinsicEdge {
    pub(crate) vertices: [u32; 2],
    pub(crate) length: f64,
    /// Triangle and half cotangent; the second is absent at a border.
    pub(crate) sides: [Option<(u32, f64)>; 2],
}

impl IntrinsicMesh {
    /// Takes a mesh with the lengths of its edges (m).
    pub(crate) fn new(mesh: &TriMesh, lengths: &PerEdge<f64>) -> Result<Self, BurnError> {
        let mut intrinsic = Self {
            origins: Vec::with_capacity(3 * mesh.face_count()),
            twins: vec![BORDER; 3 * mesh.face_count()],
            lengths: Vec::with_capacity(3 * mesh.face_count()),
            mixtures: BTreeMap::new(),
            flips: 0,
        };
        for (face, corners) in mesh.faces().iter() {
            let edges = mesh.face_edges(face).map(|edge| lengths[edge]);
            if !is_triangle(edges) {
                let face = face.index();
                return Err(BurnError::DegenerateFace { face, edges });
            }
            intrinsic.origins.extend(corners.map(|v| v.0));
            intrinsic.lengths.extend(edges);
        }
        for edge in (0..mesh.edges().len()).map(EdgeId::from_index) {
            if let [Some((f, i)), Some((g, k))] = mesh.edge_sides(edge) {
                let [h, t] = [3 * f.0 + i as u32, 3 * g.0 + k as u32];
                intrinsic.twins[h as usize] = t;
                intrinsic.twins[t as usize] = h;
            }
        }
        Ok(intrinsic)
    }

    /// Flips edges until the angles opposite each sum to at most a half turn.
    ///
    /// Source: Fisher, Springborn, Bobenko, Schröder 2006, *An algorithm for the construction of
    /// intrinsic Delaunay triangulations*.
    pub(crate) fn flip_to_delaunay(&mut self) {
        let mut queue: VecDeque<u32> = (0..self.twins.len() as u32).collect();
        let mut is_queued = vec![true; self.twins.len()];
        let most_flips = MOST_FLIPS_PER_EDGE * self.twins.len();
        while let Some(h) = queue.pop_front() {
            is_queued[h as usize] = false;
            if self.flips >= most_flips || !self.is_to_flip(h) || !self.flip(h) {
                continue;
            }
            let faces = [h / 3, self.twins[h as usize / 3 * 3] / 3];
            for near in faces.into_iter().flat_map(|f| 3 * f..3 * f + 3) {
                if !std::mem::replace(&mut is_queued[near as usize], true) {
                    queue.push_back(near);
                }
            }
        }
    }

    /// Number of flips done.
    pub(crate) fn flips(&self) -> usize {
        self.flips
    }

    /// The shares of the given triangles in those that flips have changed, summing to 1 each.
    pub(crate) fn into_mixtures(self) -> BTreeMap<u32, Vec<(u32, f64)>> {
        self.mixtures
    }

    /// Corners of a triangle.
    pub(crate) fn corners(&self, face: u32) -> [u32; 3] {
        [0, 1, 2].map(|i| self.origins[3 * face as usize + i])
    }

    /// Area of a triangle (m²).
    pub(crate) fn area(&self, face: u32) -> f64 {
        triangle_area([0, 1, 2].map(|i| self.lengths[3 * face as usize + i]))
    }

    /// Every edge once.
    pub(crate) fn edges(&self) -> impl Iterator<Item = IntrinsicEdge> + '_ {
        let halves = (0..self.twins.len() as u32).filter(|&h| self.twins[h as usize] > h);
        halves.map(|h| {
            let t = self.twins[h as usize];
            IntrinsicEdge {
                vertices: [h, next(h)].map(|half| self.origins[half as usize]),
                length: self.lengths[h as usize],
                sides: [
                    Some((h / 3, 0.5 * self.cotangent(h))),
                    (t != BORDER).then(|| (t / 3, 0.5 * self.cotangent(t))),
                ],
            }
        })
    }

    /// Lengths of half-edge `h` and the two that follow it.
    fn triangle(&self, h: u32) -> [f64; 3] {
        [h, next(h), next(next(h))].map(|half| self.lengths[half as usize])
    }

    /// Cotangent of the angle opposite half-edge `h`.
    fn cotangent(&self, h: u32) -> f64 {
        let [base, right, left] = self.triangle(h);
        (right * right + left * left - base * base) / (4.0 * triangle_area([base, right, left]))
    }

    fn is_to_flip(&self, h: u32) -> bool {
        let t = self.twins[h as usize];
        // An edge with one triangle on both sides lies inside it and is Delaunay.
        if t == BORDER || t / 3 == h / 3 {
            return false;
        }
        let [near, far] = [h, t].map(|half| self.cotangent(half));
        near + far < -FLIP_TOLERANCE * (near.abs() + far.abs())
    }

    /// Replaces the edge from `i` to `j` of triangles `i j k` and `j i l` by one from `l` to `k`;
    /// false where rounding would leave a triangle without area.
    fn flip(&mut self, h: u32) -> bool {
        let t = self.twins[h as usize];
        let ([h1, h2], [t1, t2]) = ([next(h), next(next(h))], [next(t), next(next(t))]);
        let [base, right, left] = self.triangle(h);
        let [_, far_left, far_right] = self.triangle(t);
        let across = diagonal(base, [left, right], [far_left, far_right]);
        if !is_triangle([across, left, far_left]) || !is_triangle([across, far_right, right]) {
            return false;
        }
        let (f, g) = (h / 3, t / 3);
        self.mix(f, g);
        let [l, k] = [t2, h2].map(|half| self.origins[half as usize]);
        // Triangle `f` becomes `l k i`, triangle `g` becomes `k l j`.
        let moved = [
            (h2, 3 * f + 1),
            (t1, 3 * f + 2),
            (t2, 3 * g + 1),
            (h1, 3 * g + 2),
        ];
        let place = |half: u32| match moved.iter().find(|(old, _)| *old == half) {
            Some(&(_, new)) => new,
            None => half,
        };
        let kept = moved.map(|(old, _)| {
            let old = old as usize;
            (self.origins[old], self.twins[old], self.lengths[old])
        });
        for ((_, new), (origin, twin, length)) in moved.into_iter().zip(kept) {
            self.set(new, origin, place(twin), length);
            if twin != BORDER {
                self.twins[place(twin) as usize] = new;
            }
        }
        self.set(3 * f, l, 3 * g, across);
        self.set(3 * g, k, 3 * f, across);
        self.flips += 1;
        true
    }

    fn set(&mut self, half: u32, origin: u32, twin: u32, length: f64) {
        let half = half as usize;
        (self.origins[half], self.twins[half], self.lengths[half]) = (origin, twin, length);
    }

    /// Gives both triangles of a flip the mixture of both, weighted by area: the new ones lie across
    /// the old ones.
    fn mix(&mut self, f: u32, g: u32) {
        let areas = [f, g].map(|face| self.area(face));
        let mut mixture: BTreeMap<u32, f64> = BTreeMap::new();
        for (face, area) in [f, g].into_iter().zip(areas) {
            let parts = self.mixtures.remove(&face);
            for (part, share) in parts.unwrap_or_else(|| vec![(face, 1.0)]) {
                *mixture.entry(part).or_default() += share * area / (areas[0] + areas[1]);
            }
        }
        let mixture: Vec<(u32, f64)> = mixture.into_iter().collect();
        self.mixtures.insert(f, mixture.clone());
        self.mixtures.insert(g, mixture);
    }
}

/// The half-edge after `h` in its triangle.
fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// Area of a triangle by its edges, stable for needles.
///
/// Source: Kahan 1986, *Miscalculating area and angles of a needle-like triangle*. Not a number or 0
/// where the lengths are not those of a triangle.
fn triangle_area(mut edges: [f64; 3]) -> f64 {
    edges.sort_by(|a, b| b.total_cmp(a));
    let [a, b, c] = edges;
    0.25 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).sqrt()
}

fn is_triangle(edges: [f64; 3]) -> bool {
    let longest = edges.into_iter().fold(0.0, f64::max);
    triangle_area(edges) > LEAST_SHAPE * longest * longest
}

/// Distance of the apexes of two triangles laid out flat on both sides of `base`.
///
/// `near` and `far` are the lengths from the base's start and from its end to the apex.
fn diagonal(base: f64, near: [f64; 2], far: [f64; 2]) -> f64 {
    let along = |[start, end]: [f64; 2]| (base * base + start * start - end * end) / (2.0 * base);
    let height = |[start, end]: [f64; 2]| 2.0 * triangle_area([base, start, end]) / base;
    (along(near) - along(far)).hypot(height(near) + height(far))
}
