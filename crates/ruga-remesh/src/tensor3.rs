//! Symmetric tensors in space, in the six numbers that they have.
//!
//! A remesh of a large mesh waits for memory most of the time, so what it reads at every step is
//! kept small.

use std::ops::{Add, Mul};

use nalgebra::{Matrix3, Vector3};

/// A symmetric 3x3 tensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tensor3 {
    diagonal: [f64; 3],
    /// Entries yz, xz, xy.
    off: [f64; 3],
}

impl Tensor3 {
    pub(crate) fn from_matrix(m: &Matrix3<f64>) -> Self {
        Self {
            diagonal: [m.m11, m.m22, m.m33],
            off: [m.m23, m.m13, m.m12],
        }
    }

    pub(crate) fn matrix(self) -> Matrix3<f64> {
        let ([xx, yy, zz], [yz, xz, xy]) = (self.diagonal, self.off);
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// `M u`.
    pub(crate) fn times(&self, u: &Vector3<f64>) -> Vector3<f64> {
        let ([xx, yy, zz], [yz, xz, xy]) = (self.diagonal, self.off);
        Vector3::new(
            xx * u.x + xy * u.y + xz * u.z,
            xy * u.x + yy * u.y + yz * u.z,
            xz * u.x + yz * u.y + zz * u.z,
        )
    }

    /// `uᵀ M u`.
    pub(crate) fn square(&self, u: &Vector3<f64>) -> f64 {
        u.dot(&self.times(u))
    }
}

impl Add for Tensor3 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            diagonal: std::array::from_fn(|i| self.diagonal[i] + other.diagonal[i]),
            off: std::array::from_fn(|i| self.off[i] + other.off[i]),
        }
    }
}

impl Mul<f64> for Tensor3 {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            diagonal: self.diagonal.map(|x| x * factor),
            off: self.off.map(|x| x * factor),
        }
    }
}
