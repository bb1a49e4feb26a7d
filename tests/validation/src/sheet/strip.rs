//! Rectangular meshes in the plane.

use nalgebra::{Vector2, Vector3};
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
}

impl Strip {
    /// Vertices, edges and faces without places.
    ///
    /// # Panics
    /// When the triangles are no manifold.
    pub fn topology(&self) -> TriMesh {
        TriMesh::new(self.points.len(), self.faces.clone()).expect("a strip is a mesh")
    }

    /// A mesh of a flat rectangle as a strip.
    pub fn of(mesh: &SurfaceMesh, rectangle: &Rectangle) -> Self {
        let positions = mesh.positions.as_slice().iter();
        let faces = mesh.mesh.faces().as_slice().iter();
        Self {
            points: positions.map(|p| p.xy()).collect(),
            faces: faces.map(|face| face.map(|v| v.0)).collect(),
            length: rectangle.length,
            width: rectangle.width,
        }
    }

    /// Where the points are, about the middle of the length, when that is compressed by `strain`, m.
    pub fn compressed(&self, strain: f64) -> Vec<Vector3<f64>> {
        let place =
            |p: &Vector2<f64>| Vector3::new((p.x - 0.5 * self.length) * (1.0 - strain), p.y, 0.0);
        self.points.iter().map(place).collect()
    }

    /// Which vertices lie at an end.
    pub fn ends(&self) -> Vec<bool> {
        let tolerance = 1e-9 * self.length;
        let is_end = |x: f64| x < tolerance || x > self.length - tolerance;
        self.points.iter().map(|p| is_end(p.x)).collect()
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
    }
}

/// Columns of equilateral triangles across x, so that whole columns are lines of edges along y.
///
/// `columns` spacings fill the length, an even number; the width is `rows` edges.
pub fn upright(length: f64, columns: usize, rows: usize) -> Strip {
    let spacing = length / columns as f64;
    let edge = spacing / 0.75f64.sqrt();
    let width = rows as f64 * edge;
    let column = |i: usize| {
        let shift = if i.is_multiple_of(2) { 0.0 } else { 0.5 };
        let inner = (0..=rows + i % 2).map(move |j| (j as f64 - shift).clamp(0.0, rows as f64));
        inner.map(move |y| Vector2::new(i as f64 * spacing, y * edge))
    };
    let points: Vec<_> = (0..=columns).flat_map(column).collect();
    Strip {
        faces: delaunay(&points, edge),
        points,
        length,
        width,
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
