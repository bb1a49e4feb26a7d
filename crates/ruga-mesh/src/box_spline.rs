//! The quartic box spline of the three-direction lattice: Loop's surface over a regular face.

use nalgebra::{SMatrix, SVector};

/// Value and derivatives by the barycentric coordinates of corners 1 and 2: `f, u, v, uu, uv, vv`.
pub(crate) type Derivatives = SVector<f64, 6>;
/// The derivatives of the twelve basis functions, one column for each control point.
///
/// ```text
///          6---7
///         / \ / \
///       11---2---10         controls 0 1 2: the face itself
///       / \ / \ / \         3 4 5: across edges 01, 12, 20
///      5---*---*---4        6..12: two further neighbours of each corner
/// ```
/// See [`CONTROLS`] for the exact order.
pub(crate) type Basis = SMatrix<f64, 6, CONTROLS>;

/// Control points of a regular face.
///
/// Corner `i` is control `i`; the apex across edge `i` (from corner `i` to `i + 1`) is `3 + i`; of
/// the two remaining neighbours of corner `i`, `6 + 2 i` is opposite corner `i + 2` (the third
/// corner mirrored at corner `i`) and `7 + 2 i` opposite corner `i + 1`.
pub(crate) const CONTROLS: usize = 12;

/// Twelve times a basis function: coefficients and exponents of the barycentric coordinates.
type Quartic = [(f64, [usize; 3])];

// Stam, *Evaluation of Loop subdivision surfaces*, 1998, appendix A. His twelve polynomials are
// three, up to a permutation of the coordinates: b4, b3 and b1.
const CORNER: [(f64, [usize; 3]); 15] = [
    (6.0, [4, 0, 0]),
    (24.0, [3, 1, 0]),
    (24.0, [3, 0, 1]),
    (24.0, [2, 2, 0]),
    (60.0, [2, 1, 1]),
    (24.0, [2, 0, 2]),
    (8.0, [1, 3, 0]),
    (36.0, [1, 2, 1]),
    (36.0, [1, 1, 2]),
    (8.0, [1, 0, 3]),
    (1.0, [0, 4, 0]),
    (6.0, [0, 3, 1]),
    (12.0, [0, 2, 2]),
    (6.0, [0, 1, 3]),
    (1.0, [0, 0, 4]),
];
const ACROSS: [(f64, [usize; 3]); 9] = [
    (1.0, [4, 0, 0]),
    (2.0, [3, 0, 1]),
    (6.0, [3, 1, 0]),
    (6.0, [2, 1, 1]),
    (12.0, [2, 2, 0]),
    (6.0, [1, 2, 1]),
    (6.0, [1, 3, 0]),
    (2.0, [0, 3, 1]),
    (1.0, [0, 4, 0]),
];
const OUTER: [(f64, [usize; 3]); 2] = [(1.0, [4, 0, 0]), (2.0, [3, 1, 0])];

/// The basis at the barycentric coordinates `(1 - u - v, u, v)`.
pub(crate) fn basis(u: f64, v: f64) -> Basis {
    // All twelve functions are combined from the same fifteen monomials.
    let monomials = monomials(u, v);
    let combine = |quartic: &Quartic, axes: [usize; 3]| {
        let mut sum = Derivatives::zeros();
        for (coefficient, exponents) in quartic {
            let mut powers = [0; 3];
            (0..3).for_each(|i| powers[axes[i]] = exponents[i]);
            sum += monomials[powers[0]][powers[1]] * (coefficient / 12.0);
        }
        sum
    };
    let mut result = Basis::zeros();
    for corner in 0..3 {
        let (next, last) = ((corner + 1) % 3, (corner + 2) % 3);
        let forwards = [corner, next, last];
        let backwards = [corner, last, next];
        result.set_column(corner, &combine(&CORNER, forwards));
        result.set_column(3 + corner, &combine(&ACROSS, forwards));
        result.set_column(6 + 2 * corner, &combine(&OUTER, forwards));
        result.set_column(7 + 2 * corner, &combine(&OUTER, backwards));
    }
    result
}

/// The monomials of degree four, by the exponents of the first two coordinates.
fn monomials(u: f64, v: f64) -> [[Derivatives; 5]; 5] {
    let [a, b, c] = [1.0 - u - v, u, v].map(powers);
    let mut result = [[Derivatives::zeros(); 5]; 5];
    for i in 0..=4 {
        for j in 0..=4 - i {
            let [[a0, a1, a2], [b0, b1, b2], [c0, c1, c2]] = [a[i], b[j], c[4 - i - j]];
            // The first coordinate falls where the others grow.
            result[i][j] = Derivatives::from([
                a0 * b0 * c0,
                (a0 * b1 - a1 * b0) * c0,
                (a0 * c1 - a1 * c0) * b0,
                (a0 * b2 - 2.0 * a1 * b1 + a2 * b0) * c0,
                a0 * b1 * c1 - a1 * (b1 * c0 + b0 * c1) + a2 * b0 * c0,
                (a0 * c2 - 2.0 * a1 * c1 + a2 * c0) * b0,
            ]);
        }
    }
    result
}

/// The powers zero to four, each with its first two derivatives.
fn powers(x: f64) -> [[f64; 3]; 5] {
    [
        [1.0, 0.0, 0.0],
        [x, 1.0, 0.0],
        [x * x, 2.0 * x, 2.0],
        [x * x * x, 3.0 * x * x, 6.0 * x],
        [x * x * x * x, 4.0 * x * x * x, 12.0 * x * x],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// The controls' places in the lattice whose face is the unit triangle.
    fn lattice() -> Vec<Vector2<f64>> {
        let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
        vec![
            a,
            b,
            c,
            a + b - c,
            b + c - a,
            c + a - b,
            2.0 * a - c,
            2.0 * a - b,
            2.0 * b - a,
            2.0 * b - c,
            2.0 * c - b,
            2.0 * c - a,
        ]
    }

    #[test]
    fn quadratics_of_the_parameter_are_exact() {
        // Box splines of this lattice map a quadratic to itself plus a constant.
        for (u, v) in [(0.0, 0.0), (0.3, 0.5), (0.1, 0.05), (0.5, 0.5), (1.0, 0.0)] {
            let basis = basis(u, v);
            let sum = |f: &dyn Fn(Vector2<f64>) -> f64| -> Derivatives {
                let points = lattice().into_iter().enumerate();
                points.map(|(i, p)| basis.column(i) * f(p)).sum()
            };
            let near = |got: Derivatives, wanted: [f64; 6]| {
                assert!((got - Derivatives::from(wanted)).amax() < 1e-14, "{got}");
            };
            near(sum(&|_| 1.0), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            near(sum(&|p| p.x), [u, 1.0, 0.0, 0.0, 0.0, 0.0]);
            near(sum(&|p| p.y), [v, 0.0, 1.0, 0.0, 0.0, 0.0]);
            let third = 1.0 / 3.0;
            near(
                sum(&|p| p.x * p.x),
                [u * u + third, 2.0 * u, 0.0, 2.0, 0.0, 0.0],
            );
            near(
                sum(&|p| p.x * p.y),
                [u * v - 0.5 * third, v, u, 0.0, 1.0, 0.0],
            );
        }
    }

    #[test]
    fn no_weight_is_negative() {
        for i in 0..=10 {
            for j in 0..=10 - i {
                let basis = basis(f64::from(i) / 10.0, f64::from(j) / 10.0);
                assert!(basis.row(0).iter().all(|&w| w >= -1e-16));
            }
        }
    }
}
