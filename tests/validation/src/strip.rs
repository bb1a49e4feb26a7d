//! Rectangular meshes in the plane.

use std::f64::consts::PI;

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::TriMesh;
use ruga_remesh::SurfaceMesh;

use crate::Rectangle;

/// A meshed rectangle `[0, length] x [0, width]`.
#[derive(Clone, Debug)]
pub struct Strip {
    /// Vertices.
    pub points: Vec<Vector2<f64>>,
    /// Triangles, counter-clockwise.
    pub faces: Vec<[u32; 3]>,
    /// Extent along x, m.
    pub length: f64,
    /// Extent along y, m.
    pub width: f64,
    /// Whether the end at `length` is the one at 0.
    pub is_closed: bool,
}

impl Strip {
    /// Vertices, edges and faces without places.
    ///
    /// # Panics
    /// When the triangles are no manifold.
    pub fn topology(&self) -> TriMesh {
        TriMesh::new(self.points.len(), self.faces.clone()).expect("a strip is a mesh")
    }

    /// A mesh of the plane as a strip.
    pub fn of(mesh: &SurfaceMesh, rectangle: &Rectangle) -> Self {
        let positions = mesh.positions.as_slice().iter();
        let faces = mesh.mesh.faces().as_slice().iter();
        Self {
            points: positions.map(|p| p.xy()).collect(),
            faces: faces.map(|face| face.map(|v| v.0)).collect(),
            length: rectangle.length,
            width: rectangle.width,
            is_closed: false,
        }
    }

    /// The same mesh stretched along x.
    pub fn stretched(&self, factor: f64) -> Self {
        let mut stretched = self.clone();
        stretched.length *= factor;
        for point in &mut stretched.points {
            point.x *= factor;
        }
        stretched
    }

    /// Which vertices lie at an end.
    pub fn ends(&self) -> Vec<bool> {
        let tolerance = 1e-9 * self.length;
        let is_end = |x: f64| x < tolerance || x > self.length - tolerance;
        self.points
            .iter()
            .map(|p| !self.is_closed && is_end(p.x))
            .collect()
    }

    /// Twice the length over the number of half-waves that fits `heights` best, in material
    /// coordinates: the strongest sine with nodes at both pinned ends. From four times the
    /// `expected` wavelength down: an offset of the whole strip is no wave.
    pub(crate) fn wavelength(&self, heights: &[f64], areas: &[f64], expected: f64) -> f64 {
        let strength = |half_waves: usize| -> f64 {
            let k = PI * half_waves as f64 / self.length;
            heights
                .iter()
                .zip(&self.points)
                .zip(areas)
                .map(|((w, p), a)| w * (k * p.x).sin() * a)
                .sum::<f64>()
                .abs()
        };
        let [fewest, most] = [0.5, 4.0].map(|per| per * self.length / expected);
        let best = (fewest as usize..=most as usize)
            .max_by(|&a, &b| strength(a).total_cmp(&strength(b)))
            .unwrap_or(1);
        2.0 * self.length / best as f64
    }
}

/// Rows of equilateral triangles along x, cut straight at both ends.
///
/// `columns` edges fill the length; the width is `rows` rows high.
pub fn equilateral(length: f64, columns: usize, rows: usize) -> Strip {
    let edge = length / columns as f64;
    let height = edge * 0.75f64.sqrt();
    let mut points = Vec::new();
    for j in 0..=rows {
        let y = j as f64 * height;
        if j % 2 == 0 {
            points.extend((0..=columns).map(|i| Vector2::new(i as f64 * edge, y)));
        } else {
            points.push(Vector2::new(0.0, y));
            points.extend((0..columns).map(|i| Vector2::new((i as f64 + 0.5) * edge, y)));
            points.push(Vector2::new(length, y));
        }
    }
    Strip {
        faces: delaunay(&points, edge),
        points,
        length,
        width: rows as f64 * height,
        is_closed: false,
    }
}

/// Rows of equilateral triangles around a tube: `columns` edges and `rows` rows.
pub fn equilateral_tube(length: f64, columns: usize, rows: usize) -> Strip {
    let edge = length / columns as f64;
    let height = edge * 0.75f64.sqrt();
    let vertex = |i: usize, j: usize| (j * columns + i % columns) as u32;
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for j in 0..=rows {
        let (odd, y) = (j % 2, j as f64 * height);
        let shift = 0.5 * odd as f64;
        points.extend((0..columns).map(|i| Vector2::new((i as f64 + shift) * edge, y)));
        for i in (0..columns).filter(|_| j < rows) {
            // Odd rows stand half an edge further.
            let [here, next] = [i, i + 1].map(|i| vertex(i, j));
            let [above, after] = [i, i + 1].map(|i| vertex(i, j + 1));
            faces.extend(if odd == 0 {
                [[here, next, above], [next, after, above]]
            } else {
                [[here, next, after], [here, after, above]]
            });
        }
    }
    Strip {
        points,
        faces,
        length,
        width: rows as f64 * height,
        is_closed: true,
    }
}

/// Random points of the same density, smoothed: what a remesher leaves behind.
pub fn unstructured(length: f64, columns: usize, rows: usize, seed: u64) -> Strip {
    let mut strip = equilateral(length, columns, rows);
    let edge = length / columns as f64;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let width = strip.width;
    let inside = |p: &Vector2<f64>| {
        p.x > 0.1 * edge
            && p.x < length - 0.1 * edge
            && p.y > 0.1 * edge
            && p.y < width - 0.1 * edge
    };
    for p in strip.points.iter_mut().filter(|p| inside(p)) {
        let x = p.x + random.random_range(-0.45..0.45) * edge;
        let y = p.y + random.random_range(-0.45..0.45) * edge;
        *p = Vector2::new(
            x.clamp(0.3 * edge, length - 0.3 * edge),
            y.clamp(0.3 * edge, width - 0.3 * edge),
        );
    }
    for _ in 0..3 {
        strip.faces = delaunay(&strip.points, edge);
        smooth(&mut strip, &inside);
    }
    strip.faces = delaunay(&strip.points, edge);
    strip
}

/// Moves every inner vertex halfway to the mean of its neighbours.
fn smooth(strip: &mut Strip, inside: &impl Fn(&Vector2<f64>) -> bool) {
    let mut sums = vec![(Vector2::zeros(), 0.0); strip.points.len()];
    for face in &strip.faces {
        for corner in 0..3 {
            let (a, b) = (face[corner] as usize, face[(corner + 1) % 3] as usize);
            sums[a].0 += strip.points[b];
            sums[b].0 += strip.points[a];
            sums[a].1 += 1.0;
            sums[b].1 += 1.0;
        }
    }
    for (p, (sum, count)) in strip.points.iter_mut().zip(&sums) {
        if inside(p) {
            *p = *p * 0.5 + sum / *count * 0.5;
        }
    }
}

fn delaunay(points: &[Vector2<f64>], edge: f64) -> Vec<[u32; 3]> {
    let input: Vec<delaunator::Point> = points
        .iter()
        .map(|p| delaunator::Point { x: p.x, y: p.y })
        .collect();
    delaunator::triangulate(&input)
        .triangles
        .chunks_exact(3)
        .map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]];
            let area = (points[b] - points[a]).perp(&(points[c] - points[a]));
            if area > 0.0 {
                ([a as u32, b as u32, c as u32], area)
            } else {
                ([a as u32, c as u32, b as u32], -area)
            }
        })
        // The hull of a straight border has triangles of rounding errors.
        .filter(|(_, area)| *area > 1e-6 * edge * edge)
        .map(|(face, _)| face)
        .collect()
}
