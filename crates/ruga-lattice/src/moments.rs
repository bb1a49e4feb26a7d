//! Volume, centre and spread of a piece of the body, from its border alone.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Integrals of 1, `X` and `X X^T` over a solid, `X` from the lower corner of its cell (m³ to m⁵).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) volume: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

/// Integrals of 1, `u` and `u u^T` over a plane region, `u` from the lower corner of its square.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Section {
    pub(crate) area: f64,
    first: Vector2<f64>,
    second: Matrix2<f64>,
}

/// Barycentric coordinates `(1 - 2 a, a, a)` and weight of three points each: exact to the fourth
/// degree (Dunavant 1985, degree 4).
const TRIANGLE_RULE: [[f64; 2]; 2] = [
    [0.445_948_490_915_965, 0.223_381_589_678_011],
    [0.091_576_213_509_771, 0.109_951_743_655_322],
];

impl Moments {
    /// Adds what a triangle of the border contributes by the divergence theorem: the flux along x
    /// of the integral of each integrand over x.
    pub(crate) fn add_triangle(&mut self, [a, b, c]: &[Vector3<f64>; 3]) {
        let across = (b - a).cross(&(c - a)).x / 2.0;
        // Second moments need the third degree, x^3/3 and x y^2.
        for [share, weight] in TRIANGLE_RULE {
            for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
                let point = p * (1.0 - 2.0 * share) + (q + r) * share;
                self.add_flux(&point, across * weight);
            }
        }
    }

    fn add_flux(&mut self, p: &Vector3<f64>, weight: f64) {
        let along = weight * p.x;
        self.volume += along;
        self.first += along * Vector3::new(p.x / 2.0, p.y, p.z);
        let half = |y: f64| p.x * y / 2.0;
        self.add_second(
            along,
            [p.x * p.x / 3.0, half(p.y), half(p.z)],
            &Matrix2::new(p.y * p.y, p.y * p.z, p.y * p.z, p.z * p.z),
        );
    }

    /// Adds what the section with the cell's upper end along x contributes, `width` from the lower.
    pub(crate) fn add_upper_end(&mut self, width: f64, section: &Section) {
        // Along x this end alone counts: the cell's sides have no flux along x, and at its lower
        // end x is zero.
        let Section {
            area,
            first,
            second,
        } = section;
        self.volume += width * area;
        self.first += width * Vector3::new(width * area / 2.0, first.x, first.y);
        let half = |y: f64| width * y / 2.0;
        let with_x = [width * width * area / 3.0, half(first.x), half(first.y)];
        self.add_second(width, with_x, second);
    }

    fn add_second(&mut self, factor: f64, with_x: [f64; 3], others: &Matrix2<f64>) {
        let [xx, xy, xz] = with_x;
        let second = Matrix3::new(
            xx, xy, xz, xy, others.m11, others.m12, xz, others.m21, others.m22,
        );
        self.second += second * factor;
    }

    /// Centroid, from the lower corner of the cell (m).
    pub(crate) fn centre(&self) -> Vector3<f64> {
        self.first / self.volume
    }

    /// Covariance of the places in the solid (m²).
    pub(crate) fn spread(&self) -> Matrix3<f64> {
        let centre = self.centre();
        self.second / self.volume - centre * centre.transpose()
    }
}

impl Section {
    /// Adds the triangle between the square's corner and a piece of the outline.
    pub(crate) fn add_segment(&mut self, [a, b]: &[Vector2<f64>; 2]) {
        // Areas have a sign: what lies outside the region is added once and taken off once, so that
        // the corner may be anywhere.
        let area = 0.5 * (a.x * b.y - a.y * b.x);
        self.area += area;
        self.first += (a + b) * (area / 3.0);
        let sum = a + b;
        let squares = a * a.transpose() + b * b.transpose() + sum * sum.transpose();
        self.second += squares * (area / 12.0);
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.area += other.area;
        self.first += other.first;
        self.second += other.second;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_and_a_prism_have_their_textbook_moments() {
        let corners =
            [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 5.0]].map(Vector3::from);
        let mut solid = Moments::default();
        for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            solid.add_triangle(&face.map(|v| corners[v]));
        }
        assert!((solid.volume - 5.0).abs() < 1e-13);
        assert!((solid.centre() - Vector3::new(0.5, 0.75, 1.25)).norm() < 1e-13);
        // Variance 3/80 a^2 along the legs, covariance -1/80 a b between them.
        let spread = solid.spread() * 80.0;
        let expected = Matrix3::new(12.0, -6.0, -10.0, -6.0, 27.0, -15.0, -10.0, -15.0, 75.0);
        assert!((spread - expected).norm() < 1e-11, "{spread}");

        // The prism over the triangle (0,0) (2,0) (0,3) in y and z, from x = 0 to 4.
        let corners = [[0.0, 0.0], [2.0, 0.0], [0.0, 3.0]].map(Vector2::from);
        let mut section = Section::default();
        for [i, j] in [[0, 1], [1, 2], [2, 0]] {
            section.add_segment(&[corners[i], corners[j]]);
        }
        let mut prism = Moments::default();
        prism.add_upper_end(4.0, &section);
        assert!((prism.volume - 12.0).abs() < 1e-13);
        assert!((prism.centre() - Vector3::new(2.0, 2.0 / 3.0, 1.0)).norm() < 1e-13);
        let spread = prism.spread() * 36.0;
        let expected = Matrix3::new(48.0, 0.0, 0.0, 0.0, 8.0, -6.0, 0.0, -6.0, 18.0);
        assert!((spread - expected).norm() < 1e-11, "{spread}");
    }
}
