//! Singular values of a deformation, with a sign.

use nalgebra::{Matrix3, Vector3};

/// `F = U diag(stretches) V^T` with proper rotations `U` and `V`.
///
/// Stretches are sorted by size, largest first; only the last one, the smallest, can be negative:
/// then the deformation turns space inside out (Irving, Teran and Fedkiw 2004, section 4).
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignedSvd {
    pub(crate) left: Matrix3<f64>,
    pub(crate) stretches: Vector3<f64>,
    pub(crate) right: Matrix3<f64>,
}

/// Cosine of the angle between columns below which they count as orthogonal.
const ORTHOGONAL: f64 = 1e-16;

/// Rounds of rotations; it takes four or five, as they converge quadratically.
const MAX_SWEEPS: usize = 16;

impl SignedSvd {
    /// One-sided Jacobi rotations: unlike methods that square `F`, they keep the digits of small
    /// stretches, and with them those of the rotation close to inversion.
    ///
    /// A matrix with entries that are not finite has stretches that are not a number.
    pub(crate) fn new(f: &Matrix3<f64>) -> Self {
        if !f.iter().all(|c| c.is_finite()) {
            return Self {
                left: Matrix3::identity(),
                stretches: Vector3::repeat(f64::NAN),
                right: Matrix3::identity(),
            };
        }
        let mut columns = *f;
        let mut right = Matrix3::identity();
        for _ in 0..MAX_SWEEPS {
            let turned =
                [[0, 1], [0, 2], [1, 2]].map(|p| orthogonalise(&mut columns, &mut right, p));
            if turned == [false; 3] {
                break;
            }
        }
        sort_columns(&mut columns, &mut right);
        let left = left_rotation(&columns, &right);
        // Projections and not lengths, which would lose the sign.
        let stretches = Vector3::from_fn(|k, _| left.column(k).dot(&columns.column(k)));
        Self {
            left,
            stretches,
            right,
        }
    }
}

/// Rotates two columns until they are orthogonal; whether they were not.
fn orthogonalise(a: &mut Matrix3<f64>, v: &mut Matrix3<f64>, [p, q]: [usize; 2]) -> bool {
    let [pp, qq] = [p, q].map(|k| a.column(k).norm_squared());
    let pq = a.column(p).dot(&a.column(q));
    if pq.abs() <= ORTHOGONAL * (pp.sqrt() * qq.sqrt()) {
        return false;
    }
    let zeta = (qq - pp) / (2.0 * pq);
    // The smaller of the two angles that make the columns orthogonal: the larger one swaps them as
    // well, and the rounds need not converge. Columns of equal length give zero, whose sign is one,
    // and turn by 45 degrees.
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = cosine * tangent;
    for matrix in [a, v] {
        let (x, y) = (matrix.column(p).into_owned(), matrix.column(q).into_owned());
        matrix.set_column(p, &(x * cosine - y * sine));
        matrix.set_column(q, &(x * sine + y * cosine));
    }
    true
}

/// Longest column first. A swap changes one sign, so that `v` stays a proper rotation.
fn sort_columns(a: &mut Matrix3<f64>, v: &mut Matrix3<f64>) {
    for [p, q] in [[0, 1], [1, 2], [0, 1]] {
        if a.column(p).norm_squared() < a.column(q).norm_squared() {
            for matrix in [&mut *a, &mut *v] {
                let x = matrix.column(p).into_owned();
                let y = matrix.column(q).into_owned();
                matrix.set_column(p, &y);
                matrix.set_column(q, &-x);
            }
        }
    }
}

/// Unit vectors along the columns; where a column vanishes, whatever completes a rotation.
fn left_rotation(columns: &Matrix3<f64>, right: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b]: [Vector3<f64>; 2] = [0, 1].map(|k| columns.column(k).into_owned());
    let Some(first) = a.try_normalize(f64::MIN_POSITIVE) else {
        // Of a zero matrix R is then the identity.
        return *right;
    };
    let reject = |x: Vector3<f64>| x - first * first.dot(&x);
    // A second column below the rounding of the first has no direction of its own.
    let second = if b.norm() > f64::EPSILON * a.norm() {
        reject(b).normalize()
    } else {
        // The coordinate axis that lies furthest from the first.
        let mut axis = Vector3::zeros();
        axis[first.iamin()] = 1.0;
        reject(axis).normalize()
    };
    // The third is not taken from its column: so this is a proper rotation, and where space is
    // inside out the sign goes to the last stretch, the smallest.
    Matrix3::from_columns(&[first, second, first.cross(&second)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    fn check(f: &Matrix3<f64>) {
        let SignedSvd {
            left,
            stretches,
            right,
        } = SignedSvd::new(f);
        let size = f.amax().max(f64::MIN_POSITIVE);
        let product = left * Matrix3::from_diagonal(&stretches) * right.transpose();
        assert!((product - f).amax() < 4e-15 * size, "{f} {stretches}");
        for rotation in [left, right] {
            let unit = rotation.transpose() * rotation - Matrix3::identity();
            assert!(unit.amax() < 4e-15 && rotation.determinant() > 0.0);
        }
        assert!(stretches[0] >= stretches[1] && stretches[1] >= stretches[2].abs() - 1e-15 * size);
    }

    #[test]
    fn any_matrix_is_put_together_again() {
        let mut rng = Pcg64::seed_from_u64(3);
        for round in 0..3000 {
            let f = Matrix3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            // Nearly flat, nearly a line, and nearly nothing in every direction.
            let [a, b] = [
                [1.0, 1.0],
                [1e-8, 1.0],
                [1e-12, 1e-9],
                [1.0, 0.0],
                [0.0, 0.0],
            ][round % 5];
            check(&(f * Matrix3::from_diagonal(&Vector3::new(1.0, b, a)) * f.transpose()));
            check(&(f * Matrix3::from_diagonal(&Vector3::new(a, 1.0, b))));
        }
    }

    #[test]
    fn special_matrices() {
        check(&Matrix3::zeros());
        check(&Matrix3::identity());
        check(&-Matrix3::identity());
        check(&Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0)));
        check(&(Vector3::new(0.0, 3.0, 0.0) * Vector3::new(1.0, 0.0, 2.0).transpose()));
        let broken = SignedSvd::new(&Matrix3::repeat(f64::INFINITY));
        assert!(broken.stretches.iter().all(|s| s.is_nan()));
    }
}
