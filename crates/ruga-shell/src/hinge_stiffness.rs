//! The stiffness that makes hinges bend like a plate.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{FaceId, Id};

use crate::RestTriangle;
use crate::natural_curvature::side_fold;

/// Default exponent of the per-hinge factor.
///
/// 0 (the plain D/3 hinge) is 2-12 % too stiff on unstructured meshes, 1 is 2-5 % too soft; 0.5
/// keeps the plate modulus within 2 % at 12 points per wavelength on smoothed meshes.
pub const HINGE_EXPONENT: f64 = 0.5;

/// Above this ratio of longest to shortest edge in either triangle the factor is not applied.
///
/// On a mesh that is stretched as a whole no scalar factor works, and this one makes things worse.
pub const MAX_EDGE_RATIO: f64 = 1.5;

/// Two triangles unfolded flat about their common edge.
///
/// Each brings its own rest shape; the edge's length is the mean of what the two say, which differ
/// only under a rest stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HingeShape {
    length: f64,
    feet: [f64; 2],
    heights: [f64; 2],
    areas: f64,
    edge_ratio: f64,
}

impl HingeShape {
    /// `left` winds the edge from its corner `tail`; `right` winds it back from its corner `head`.
    ///
    /// # Panics
    /// When `tail` or `head` is not 0, 1 or 2.
    pub fn new(left: &RestTriangle, tail: usize, right: &RestTriangle, head: usize) -> Self {
        let (left_length, left_foot, left_height) = left.seen_from_edge(tail);
        let (right_length, right_foot, right_height) = right.seen_from_edge(head);
        Self {
            length: 0.5 * (left_length + right_length),
            // The right face winds the edge the other way, so that its foot counts from the head.
            feet: [left_foot, 1.0 - right_foot],
            heights: [left_height, right_height],
            areas: left.area() + right.area(),
            edge_ratio: left.edge_ratio().max(right.edge_ratio()),
        }
    }

    /// The faces on the two sides of an inner edge, each with the corner at which the edge begins; where they are the
    /// same one, the right face is the mirror image of the left one.
    pub(crate) fn between(
        [(left, tail), (right, head)]: [(FaceId, usize); 2],
        rest: &[RestTriangle],
    ) -> Self {
        let shape = Self::new(&rest[left.index()], tail, &rest[right.index()], head);
        let feet = match left == right {
            true => [shape.feet[0]; 2],
            false => shape.feet,
        };
        Self { feet, ..shape }
    }

    /// Length of the edge (m).
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Derivative of the angle by the height of tail, head, left and right apex above the plane, for
    /// angles that are positive in a valley: opposite to those of [`HingeState`](crate::HingeState).
    pub fn angle_by_height(&self) -> [f64; 4] {
        let [left, right] = self.heights.map(|height| 1.0 / height);
        let head = -(self.feet[0] * left + self.feet[1] * right);
        [-(head + left + right), head, left, right]
    }

    /// Angle (rad m), positive on crests, of the piecewise linear surfaces through quadratic ones: one per
    /// unit component of curvature, see [`StarShape`](crate::StarShape), along the edge and to its left.
    pub(crate) fn quadratic_fold(&self) -> Vector3<f64> {
        let edge = Vector2::new(self.length, 0.0);
        let [left, right] = self.heights;
        let apex = |foot: f64, y: f64| Vector2::new(foot * self.length, y);
        side_fold(&edge, &apex(self.feet[0], left), left)
            + side_fold(&edge, &apex(self.feet[1], -right), right)
    }

    /// Hinge stiffness `k` (J) for the plate modulus `modulus` (N m).
    ///
    /// `k = k0 f^p`, `k0 = D l^2/(A1 + A2)`, `f = D (A1 + A2)/(3 m k0)`: `k0` is exact on
    /// equilateral triangles, and `f` sets the energy of this hinge under a unit cylinder, averaged
    /// over its directions, to that of the plate. `p` is `exponent`, or 0 above
    /// [`MAX_EDGE_RATIO`].
    pub fn stiffness(&self, modulus: f64, exponent: f64) -> f64 {
        let plain = modulus * self.length * self.length / self.areas;
        // Across the long side of triangles stretched 2:1 hinges with the whole factor bend with
        // .36 of the plate's modulus, plain ones with .79: a mean over directions cannot mend one
        // direction.
        if self.edge_ratio > MAX_EDGE_RATIO {
            return plain;
        }
        // An edge owns a third of the area of each of its faces.
        let factor = modulus * self.areas / (3.0 * self.mean_square_angle() * plain);
        plain * factor.powf(exponent)
    }

    /// Mean of theta² over all directions of a cylinder of unit curvature (m²).
    fn mean_square_angle(&self) -> f64 {
        // The origin is arbitrary: a plane through the four points folds nothing, so that moving it
        // changes none of the sums.
        let by_height = self.angle_by_height();
        let points = [
            (-0.5 * self.length, 0.0),
            (0.5 * self.length, 0.0),
            ((self.feet[0] - 0.5) * self.length, self.heights[0]),
            ((self.feet[1] - 0.5) * self.length, -self.heights[1]),
        ];
        let (mut a, mut b, mut s) = (0.0, 0.0, 0.0);
        for (g, (x, y)) in by_height.into_iter().zip(points) {
            a += 0.5 * g * x * x;
            b += 0.5 * g * y * y;
            s += g * x * y;
        }
        // Over all directions cos^4 has the mean 3/8, cos^2 sin^2 the mean 1/8.
        (3.0 * a * a + 3.0 * b * b + 2.0 * a * b + s * s) / 8.0
    }
}
