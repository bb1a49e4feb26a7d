//! Symmetric 2x2 tensors in a tangent frame.

use nalgebra::{Matrix3, Vector3};

use crate::tensor3::Tensor3;

/// A symmetric tensor in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tensor2 {
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) yy: f64,
}

impl Tensor2 {
    /// The tangent part of a tensor in space.
    pub(crate) fn in_frame(tensor: &Matrix3<f64>, frame: &[Vector3<f64>; 2]) -> Self {
        Self::of(&Tensor3::from_matrix(tensor), frame)
    }

    /// The tangent part of a packed tensor in space.
    pub(crate) fn of(tensor: &Tensor3, frame: &[Vector3<f64>; 2]) -> Self {
        let [x, y] = frame;
        let (mx, my) = (tensor.times(x), tensor.times(y));
        Self {
            xx: x.dot(&mx),
            xy: y.dot(&mx),
            yy: y.dot(&my),
        }
    }

    pub(crate) fn in_space(self, frame: &[Vector3<f64>; 2]) -> Matrix3<f64> {
        let [x, y] = frame;
        let mixed = x * y.transpose();
        x * x.transpose() * self.xx
            + (mixed + mixed.transpose()) * self.xy
            + y * y.transpose() * self.yy
    }

    /// Eigenvalues, larger first.
    pub(crate) fn eigenvalues(self) -> [f64; 2] {
        let (mean, half) = ((self.xx + self.yy) / 2.0, (self.xx - self.yy) / 2.0);
        let radius = half.hypot(self.xy);
        [mean + radius, mean - radius]
    }

    /// Unit eigenvector of the larger eigenvalue.
    fn eigenvector(self) -> [f64; 2] {
        // A round tensor gets the first axis instead of a division of zero by zero.
        let angle = self.xy.atan2((self.xx - self.yy) / 2.0) / 2.0;
        [angle.cos(), angle.sin()]
    }

    /// The tensor with each eigenvalue replaced.
    pub(crate) fn map_eigenvalues(self, map: impl Fn(f64) -> f64) -> Self {
        let ([first, second], [c, s]) = (self.eigenvalues().map(map), self.eigenvector());
        Self {
            xx: first * c * c + second * s * s,
            xy: (first - second) * c * s,
            yy: first * s * s + second * c * c,
        }
    }

    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            xx: self.xx * factor,
            xy: self.xy * factor,
            yy: self.yy * factor,
        }
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        Self {
            xx: self.xx - other.xx,
            xy: self.xy - other.xy,
            yy: self.yy - other.yy,
        }
    }

    pub(crate) fn determinant(self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// Says whether no eigenvalue is negative.
    pub(crate) fn is_nonnegative(self) -> bool {
        self.xx >= 0.0 && self.yy >= 0.0 && self.determinant() >= 0.0
    }

    /// The coarsest tensor that asks for edges no longer than either of the two does, by their
    /// simultaneous diagonalisation; both must be positive definite.
    pub(crate) fn finest(self, other: Self) -> Self {
        // self = L Lᵀ; in the frame of L it is the identity and the other has eigenvalues to
        // compare with one.
        let l0 = self.xx.sqrt();
        let l1 = self.xy / l0;
        // Rounding may take what is nearly singular to zero or below.
        let l2 = (self.yy - l1 * l1).max(f64::MIN_POSITIVE).sqrt();
        let a = other.xx / l0;
        let b = (other.xy - l1 * a) / l2;
        let in_frame = Self {
            xx: a / l0,
            xy: b / l0,
            yy: ((other.yy - l1 * (other.xy / l0)) / l2 - (l1 / l0) * (b)) / l2,
        };
        let m = in_frame.map_eigenvalues(|value| value.max(1.0));
        let (p, q) = (l0 * m.xx, l1 * m.xx + l2 * m.xy);
        let r = l1 * m.xy + l2 * m.yy;
        Self {
            xx: l0 * p,
            xy: l0 * q,
            yy: l1 * q + l2 * r,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(m: Tensor2, x: f64, y: f64) -> f64 {
        m.xx * x * x + 2.0 * m.xy * x * y + m.yy * y * y
    }

    #[test]
    fn the_finest_of_two_is_as_fine_as_both_in_every_direction() {
        let first = Tensor2 {
            xx: 3.0,
            xy: 0.7,
            yy: 0.5,
        };
        let second = Tensor2 {
            xx: 0.4,
            xy: -0.3,
            yy: 2.0,
        };
        for (m, n) in [(first, second), (second, first)] {
            let both = m.finest(n);
            let mut closest = f64::INFINITY;
            for i in 0..180 {
                let (y, x) = (f64::from(i) / 180.0 * std::f64::consts::PI).sin_cos();
                let excess = length(both, x, y) - length(m, x, y).max(length(n, x, y));
                assert!(excess > -1e-12, "{excess}");
                closest = closest.min(excess);
            }
            assert!(
                closest < 1e-2,
                "the result touches both ellipses: {closest}"
            );
        }
        assert!((first.finest(first).xy - first.xy).abs() < 1e-12);
    }

    #[test]
    fn eigenvalues_build_the_tensor_again() {
        let tensor = Tensor2 {
            xx: 1.0,
            xy: -2.0,
            yy: 5.0,
        };
        let again = tensor.map_eigenvalues(|v| v);
        assert!((again.xx - 1.0).abs() + (again.xy + 2.0).abs() + (again.yy - 5.0).abs() < 1e-12);
    }
}
