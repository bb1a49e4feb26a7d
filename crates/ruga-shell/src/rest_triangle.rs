//! A face's rest shape in its own plane.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::ShellError;

/// A rest triangle is refused when its area is below this share of its longest edge squared.
///
/// Heights then stay above 2e-6 of an edge, so that shape gradients and hinge angles keep ten
/// digits.
pub const MIN_AREA_RATIO: f64 = 1e-6;

/// Rest shape of one face in its local frame: origin at corner 0, axes those of
/// [`triangle_frame`](ruga_mesh::triangle_frame).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestTriangle {
    /// Corners 1 and 2 seen from corner 0 (m).
    edges: [Vector2<f64>; 2],
    /// Gradients of the linear shape functions of corners 1 and 2 (1/m).
    gradients: [Vector2<f64>; 2],
    area: f64,
}

impl RestTriangle {
    /// Lays three points into their plane. `face` is the index that an error names.
    ///
    /// # Errors
    /// [`ShellError::DegenerateFace`] below [`MIN_AREA_RATIO`].
    pub fn new(corners: &[Vector3<f64>; 3], face: usize) -> Result<Self, ShellError> {
        let along = corners[1] - corners[0];
        let aside = corners[2] - corners[0];
        let length = along.norm();
        // Two corners at one place have no direction; the zero area is refused below.
        let foot = if length > 0.0 {
            along.dot(&aside) / length
        } else {
            0.0
        };
        // The root of |aside|^2 - foot^2 would lose half of a thin triangle's digits.
        let height = along.cross(&aside).norm() / length.max(f64::MIN_POSITIVE);
        Self::from_edges(
            [Vector2::new(length, 0.0), Vector2::new(foot, height)],
            face,
        )
    }

    /// This triangle with its plane stretched by `stretch` (2×2, local frame): the rest metric
    /// becomes `S^T S`.
    ///
    /// # Errors
    /// [`ShellError::InvertedStretch`] unless `det S > 0`; [`ShellError::DegenerateFace`].
    pub fn stretched(&self, stretch: &Matrix2<f64>, face: usize) -> Result<Self, ShellError> {
        let determinant = stretch.determinant();
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(ShellError::InvertedStretch { face, determinant });
        }
        Self::from_edges(self.edges.map(|edge| stretch * edge), face)
    }

    fn from_edges(edges: [Vector2<f64>; 2], face: usize) -> Result<Self, ShellError> {
        let [u, v] = edges;
        let area = 0.5 * u.perp(&v);
        let longest = u
            .norm_squared()
            .max(v.norm_squared())
            .max((v - u).norm_squared());
        let minimum = MIN_AREA_RATIO * longest;
        // Negated so that NaN is refused too.
        if !(area >= minimum && area > 0.0 && area.is_finite()) {
            return Err(ShellError::DegenerateFace {
                face,
                area,
                minimum,
            });
        }
        let gradients = [
            Vector2::new(v.y, -v.x) / (2.0 * area),
            Vector2::new(-u.y, u.x) / (2.0 * area),
        ];
        Ok(Self {
            edges,
            gradients,
            area,
        })
    }

    /// Area (m²).
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Gradients of the linear shape functions of the three corners (1/m), local frame.
    pub fn shape_gradients(&self) -> [Vector2<f64>; 3] {
        let [g1, g2] = self.gradients;
        [-(g1 + g2), g1, g2]
    }

    /// Longest edge over shortest.
    pub fn edge_ratio(&self) -> f64 {
        let [u, v] = self.edges;
        let lengths = [u.norm(), v.norm(), (v - u).norm()];
        lengths.iter().copied().fold(0.0, f64::max)
            / lengths.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Unit vectors along the edge that begins at corner `tail`, and from it into the triangle, as columns.
    pub(crate) fn edge_frame(&self, tail: usize) -> Matrix2<f64> {
        let corner = [Vector2::zeros(), self.edges[0], self.edges[1]];
        let along = (corner[(tail + 1) % 3] - corner[tail]).normalize();
        Matrix2::from_columns(&[along, Vector2::new(-along.y, along.x)])
    }

    /// The corner opposite an edge, seen from that edge: `(length, foot, height)`.
    ///
    /// The edge runs from corner `tail` to the next one; `foot` is the fraction of the edge at
    /// which the perpendicular from the opposite corner meets it.
    ///
    /// # Panics
    /// When `tail` is not 0, 1 or 2.
    pub fn seen_from_edge(&self, tail: usize) -> (f64, f64, f64) {
        let corner = [Vector2::zeros(), self.edges[0], self.edges[1]];
        let edge = corner[(tail + 1) % 3] - corner[tail];
        let apex = corner[(tail + 2) % 3] - corner[tail];
        let length = edge.norm();
        (
            length,
            edge.dot(&apex) / (length * length),
            2.0 * self.area / length,
        )
    }
}
