//! UV seams: what lies on the other side of the border of a chart.

use nalgebra::{Matrix2, Rotation3, Vector2, Vector3};

use crate::detail_bake::orthonormal;
use crate::error::{all_finite, all_in_range, same_length};
use crate::face_adjacency::{NONE, adjacent_faces};
use crate::{BakeError, TangentFrame};

/// Part of a border edge next to its ends from which no way across starts: through a vertex it would
/// not be clear into which triangle.
const END: f64 = 0.02;

/// Triangles that one way across passes at most.
const MOST_STEPS: usize = 64;

/// The charts of the artist's mesh, and how they hang together in space.
#[derive(Debug, Clone)]
pub struct Seams<'a> {
    positions: &'a [Vector3<f64>],
    triangles: &'a [[u32; 3]],
    uvs: &'a [[Vector2<f64>; 3]],
    frames: &'a [[TangentFrame; 3]],
    /// The triangle across the edge opposite each corner, or [`NONE`].
    adjacent: Vec<[u32; 3]>,
}

/// An edge of a triangle at which its chart ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BorderEdge {
    triangle: u32,
    /// The corner opposite to it.
    corner: usize,
}

/// Place in another chart that continues a chart beyond its border.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Across {
    /// Texture coordinate there.
    pub uv: Vector2<f64>,
    /// The triangle of the artist's mesh that it lies in.
    pub triangle: u32,
    /// Turn, or reflection, of the tangent plane there into that of the chart.
    pub turn: Matrix2<f64>,
}

impl<'a> Seams<'a> {
    /// Finds the borders of the charts.
    ///
    /// # Shapes and units
    /// `positions` (m) are of vertices that are one wherever the surface is joined, and `triangles` index
    /// them; `uvs` (V down) and `frames` are of the triangles' corners.
    ///
    /// # Errors
    /// [`BakeError::LengthMismatch`], [`BakeError::IndexOutOfRange`], [`BakeError::NotFinite`].
    pub fn new(
        positions: &'a [Vector3<f64>],
        triangles: &'a [[u32; 3]],
        uvs: &'a [[Vector2<f64>; 3]],
        frames: &'a [[TangentFrame; 3]],
    ) -> Result<Self, BakeError> {
        same_length("uvs", uvs.len(), triangles.len())?;
        same_length("frames", frames.len(), triangles.len())?;
        all_in_range("triangles", triangles, positions.len())?;
        all_finite("positions", positions, |p| p.iter().all(|c| c.is_finite()))?;
        all_finite("uvs", uvs, |corners| {
            corners.iter().flatten().all(|c| c.is_finite())
        })?;
        Ok(Self {
            positions,
            triangles,
            uvs,
            frames,
            adjacent: adjacent_faces(triangles),
        })
    }

    /// Texture coordinates of the corners of every triangle.
    pub(crate) fn uvs(&self) -> &'a [[Vector2<f64>; 3]] {
        self.uvs
    }

    /// All edges at which a chart ends, with or without skin beyond.
    pub(crate) fn border(&self) -> Vec<BorderEdge> {
        let edges = (0..self.triangles.len() as u32)
            .flat_map(|triangle| (0..3).map(move |corner| BorderEdge { triangle, corner }));
        edges.filter(|edge| self.is_border(*edge)).collect()
    }

    /// The ends of an edge in UV.
    pub(crate) fn ends(&self, edge: BorderEdge) -> [Vector2<f64>; 2] {
        let uvs = &self.uvs[edge.triangle as usize];
        [1, 2].map(|step| uvs[(edge.corner + step) % 3])
    }

    fn is_border(&self, edge: BorderEdge) -> bool {
        let across = self.adjacent[edge.triangle as usize][edge.corner];
        if across == NONE {
            return true;
        }
        let vertices = self.triangles[edge.triangle as usize];
        [1, 2].into_iter().any(|step| {
            let corner = (edge.corner + step) % 3;
            let other = self.corner_of(across, vertices[corner]);
            other.is_none_or(|other| {
                self.uvs[across as usize][other] != self.uvs[edge.triangle as usize][corner]
            })
        })
    }

    fn corner_of(&self, triangle: u32, vertex: u32) -> Option<usize> {
        let corners = &self.triangles[triangle as usize];
        corners.iter().position(|&v| v == vertex)
    }

    /// The place that a texture coordinate outside a chart continues to, over a border edge of it.
    ///
    /// The plane of the edge's triangle goes on beyond the edge, and the surface there is unrolled into
    /// it, triangle by triangle along the straight way from the edge. `None` where the surface ends, or
    /// `uv` lies inside the triangle.
    pub(crate) fn across(&self, edge: BorderEdge, uv: &Vector2<f64>) -> Option<Across> {
        let [tail, head] = [1, 2].map(|step| (edge.corner + step) % 3);
        let vertices = self.triangles[edge.triangle as usize];
        let at = |corner: usize| self.positions[vertices[corner] as usize];
        let length = (at(head) - at(tail)).norm();
        // The plane has the edge on its first axis and the triangle below it.
        let own = unrolled([at(tail), at(head), at(edge.corner)], -1.0)?;
        let uvs = &self.uvs[edge.triangle as usize];
        let place = barycentric([uvs[tail], uvs[head], uvs[edge.corner]], uv)?;
        let target = Vector2::new(place[1] * length, 0.0) + own * place[2];
        if target.y <= 0.0 {
            return None;
        }
        let along = uvs[head] - uvs[tail];
        let nearest = (uv - uvs[tail]).dot(&along) / along.norm_squared();
        let start = Vector2::new(nearest.clamp(END, 1.0 - END) * length, 0.0);
        self.walk(edge, (start, target), length)
    }

    fn walk(
        &self,
        edge: BorderEdge,
        (start, target): (Vector2<f64>, Vector2<f64>),
        length: f64,
    ) -> Option<Across> {
        let vertices = self.triangles[edge.triangle as usize];
        let (mut triangle, mut corner) = (edge.triangle, edge.corner);
        // The crossed edge, its vertices in the plane: the first on the right of the way as seen from
        // the triangle's inside, so that the next apex lies on the left of the edge.
        let mut ends = [1, 2].map(|step| vertices[(edge.corner + step) % 3]);
        let mut places = [Vector2::zeros(), Vector2::new(length, 0.0)];
        let mut turn = Matrix2::identity();
        for _ in 0..MOST_STEPS {
            let next = self.adjacent[triangle as usize][corner];
            if next == NONE {
                return None;
            }
            let crossed = BorderEdge { triangle, corner };
            let [a, b] = ends.map(|vertex| self.corner_of(next, vertex));
            let (a, b) = (a?, b?);
            if self.is_border(crossed) {
                let part = crossing(places, start, target);
                turn *= self.turn(crossed, next, ends, part)?;
            }
            let apex = (0..3).find(|&c| c != a && c != b)?;
            let corners = self.triangles[next as usize];
            let at = |c: usize| self.positions[corners[c] as usize];
            let local = unrolled([at(a), at(b), at(apex)], 1.0)?;
            let axis = (places[1] - places[0]).try_normalize(0.0)?;
            let place = places[0] + axis * local.x + Vector2::new(-axis.y, axis.x) * local.y;
            let weights = barycentric([places[0], places[1], place], &target)?;
            if weights.iter().all(|w| *w >= -1e-9) {
                let uvs = &self.uvs[next as usize];
                let uv = uvs[a] * weights[0] + uvs[b] * weights[1] + uvs[apex] * weights[2];
                return Some(Across {
                    uv,
                    triangle: next,
                    turn,
                });
            }
            // The way leaves over the edge on whose side of the apex it passes.
            let is_left = (target - start).perp(&(place - start)) > 0.0;
            let apex_vertex = corners[apex];
            // Seen along the way the first end is on the left, the second on the right.
            match is_left {
                true => (ends[0], places[0], corner) = (apex_vertex, place, a),
                false => (ends[1], places[1], corner) = (apex_vertex, place, b),
            }
            triangle = next;
        }
        None
    }

    /// Turn of tangent coordinates beyond an edge into those of the near side, at a part of the way
    /// between its ends.
    ///
    /// Where the shading has a hard edge, the normal beyond is first turned into the near one: what
    /// lies flat stays flat.
    fn turn(
        &self,
        near: BorderEdge,
        beyond: u32,
        ends: [u32; 2],
        part: f64,
    ) -> Option<Matrix2<f64>> {
        let frame = |triangle: u32| -> Option<[Vector3<f64>; 3]> {
            let frames = &self.frames[triangle as usize];
            let [a, b] = ends.map(|vertex| self.corner_of(triangle, vertex));
            let (a, b) = (frames[a?], frames[b?]);
            let blend = |x: Vector3<f64>, y: Vector3<f64>| x * (1.0 - part) + y * part;
            let (normal, tangent) = (blend(a.normal, b.normal), blend(a.tangent, b.tangent));
            Some(orthonormal(normal, tangent, a.sign))
        };
        let [t, b, n] = frame(near.triangle)?;
        let [other_t, other_b, other_n] = frame(beyond)?;
        let level = Rotation3::rotation_between(&other_n, &n)?;
        let [x, y] = [level * other_t, level * other_b];
        Some(Matrix2::new(t.dot(&x), t.dot(&y), b.dot(&x), b.dot(&y)))
    }
}

/// Part of the way between two places at which a straight way crosses.
fn crossing([a, b]: [Vector2<f64>; 2], start: Vector2<f64>, target: Vector2<f64>) -> f64 {
    let way = target - start;
    let [left, right] = [a, b].map(|p| way.perp(&(p - start)));
    let part = left / (left - right);
    if part.is_finite() {
        part.clamp(0.0, 1.0)
    } else {
        0.5
    }
}

/// The third corner of a triangle in the plane, its first at the origin and its second on the first
/// axis; `side` is the sign of its second coordinate. `None` without a length of the first edge.
fn unrolled([a, b, c]: [Vector3<f64>; 3], side: f64) -> Option<Vector2<f64>> {
    let axis = (b - a).try_normalize(0.0)?;
    let x = axis.dot(&(c - a));
    let y = (c - a - axis * x).norm();
    Some(Vector2::new(x, side * y))
}

/// Barycentric coordinates in the plane; `None` in a triangle without area.
fn barycentric([a, b, c]: [Vector2<f64>; 3], p: &Vector2<f64>) -> Option<[f64; 3]> {
    let area = (b - a).perp(&(c - a));
    let [u, v] = [(c - b).perp(&(p - b)), (a - c).perp(&(p - c))].map(|part| part / area);
    let weights = [u, v, 1.0 - u - v];
    weights.iter().all(|w| w.is_finite()).then_some(weights)
}
