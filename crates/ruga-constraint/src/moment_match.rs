//! Rescales weights so that they reproduce affine functions.

use nalgebra::{Matrix3, SymmetricEigen, Vector2, Vector3};

/// Why a row reproduces constants only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degradation {
    /// Fewer than six vertices carry weight.
    FewVertices,
    /// The vertices lie nearly on a line.
    Collinear,
    /// Matching the moments would turn a weight negative.
    NegativeWeight,
}

/// Below this many vertices a match follows single vertices more than the kernel.
const LEAST_VERTICES: usize = 6;
/// A full support has a condition of about 6 with lengths scaled by its radius, a border 20 to 30.
const LARGEST_CONDITION: f64 = 1e3;

/// Makes `weights` sum to one and their centroid the `target`.
///
/// The multiplicative correction of a reproducing-kernel method: with `P = (1, u/R)`,
/// `w* = w P·β`, `(Σ w P Pᵀ) β = (1, target/R)`. Support and, where the target is the centroid of
/// the kernel clipped to the domain, sign are kept. On failure the weights are only normalised.
///
/// `weights` are not negative and not all zero; `points` and `target` in m, relative to the centre.
pub(crate) fn match_moments(
    points: &[Vector2<f64>],
    weights: &mut [f64],
    target: Vector2<f64>,
    radius: f64,
) -> Result<(), Degradation> {
    normalise(weights);
    if weights.iter().filter(|&&w| w > 0.0).count() < LEAST_VERTICES {
        return Err(Degradation::FewVertices);
    }
    let basis = |u: &Vector2<f64>| Vector3::new(1.0, u.x / radius, u.y / radius);
    let moments = points
        .iter()
        .zip(&*weights)
        .fold(Matrix3::zeros(), |sum, (u, &w)| {
            let p = basis(u);
            sum + p * p.transpose() * w
        });
    let eigenvalues = SymmetricEigen::new(moments).eigenvalues;
    if eigenvalues.min() * LARGEST_CONDITION < eigenvalues.max() {
        return Err(Degradation::Collinear);
    }
    let beta = moments
        .cholesky()
        .ok_or(Degradation::Collinear)?
        .solve(&basis(&target));
    let factors: Vec<f64> = points.iter().map(|u| basis(u).dot(&beta)).collect();
    if factors.iter().zip(&*weights).any(|(f, &w)| f * w < 0.0) {
        return Err(Degradation::NegativeWeight);
    }
    for (weight, factor) in weights.iter_mut().zip(factors) {
        *weight *= factor;
    }
    Ok(())
}

/// Scales weights to a unit sum.
pub(crate) fn normalise(weights: &mut [f64]) {
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
}
