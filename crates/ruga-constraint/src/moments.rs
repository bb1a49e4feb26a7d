//! Moments of weights, and weights rescaled to given ones.

use nalgebra::{SMatrix, SVector, Vector2};

/// Reason why a row reproduces constants only.
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
const LEAST_FOR_AFFINE: usize = 6;
/// Below this many vertices a match of all six moments up to the second follows single vertices more
/// than the kernel.
const LEAST_FOR_QUADRATIC: usize = 12;
/// Condition of the moment matrix above which the vertices lie nearly on a line. A full support has
/// about 6 with lengths over its radius, a border 20 to 30.
const LARGEST_CONDITION: f64 = 1e3;
/// Condition of the matrix of moments up to the second above which a match is given up. A full support
/// has 500, a border five times that.
const LARGEST_QUADRATIC_CONDITION: f64 = 1e5;

/// Centroid and second moments of weights of unit sum, m and m2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    first: Vector2<f64>,
    /// Means of `x²`, `x y` and `y²`.
    second: [f64; 3],
}

impl Moments {
    /// Moments of weighted points; `None` without weight.
    pub(crate) fn of(points: impl Iterator<Item = (Vector2<f64>, f64)>) -> Option<Self> {
        let (mut mass, mut first, mut second) = (0.0, Vector2::zeros(), [0.0; 3]);
        for (u, weight) in points {
            mass += weight;
            first += u * weight;
            for (sum, product) in second.iter_mut().zip([u.x * u.x, u.x * u.y, u.y * u.y]) {
                *sum += product * weight;
            }
        }
        (mass > 0.0).then(|| Self {
            first: first / mass,
            second: second.map(|sum| sum / mass),
        })
    }

    /// Moments of a round kernel with the given mean of `x²`.
    pub(crate) fn round(second: f64) -> Self {
        Self {
            first: Vector2::zeros(),
            second: [second, 0.0, second],
        }
    }
}

/// Makes `weights` sum to one and their centroid that of `target`.
///
/// The multiplicative correction of a reproducing-kernel method: with `P = (1, u/R)`,
/// `w* = w P·β`, `(Σ w P Pᵀ) β = (1, target/R)`. Support and, where the target is the centroid of
/// the kernel clipped to the domain, sign are kept. On failure the weights are only normalised.
///
/// `weights` are not negative and not all zero; `points` in m, relative to the centre, at most `R` away.
pub(crate) fn match_centroid(
    points: &[Vector2<f64>],
    weights: &mut [f64],
    target: &Moments,
) -> Result<(), Degradation> {
    let radius = extent(points, weights);
    // Lengths over the extent: the condition is then that of the arrangement, in any unit.
    let basis = |u: &Vector2<f64>| SVector::<f64, 3>::new(1.0, u.x / radius, u.y / radius);
    let goal = basis(&target.first);
    let limits = (LEAST_FOR_AFFINE, LARGEST_CONDITION);
    match_basis(points, weights, basis, &goal, limits)
}

/// Rescales weights so that centroid and second moments are right: `P = (1, u/R, u uᵀ/R²)`.
///
/// What is linear on each triangle misses a curved field by its curvature times the square of the
/// edges, everywhere with the same sign. Weights with the right second moments do not.
pub(crate) fn match_second_moments(
    points: &[Vector2<f64>],
    weights: &mut [f64],
    target: &Moments,
) -> Result<(), Degradation> {
    let radius = extent(points, weights);
    let basis = |u: &Vector2<f64>| {
        let [x, y] = [u.x / radius, u.y / radius];
        SVector::<f64, 6>::from([1.0, x, y, x * x, x * y, y * y])
    };
    let [x, y] = [target.first.x, target.first.y].map(|mean| mean / radius);
    let [xx, xy, yy] = target.second.map(|mean| mean / (radius * radius));
    let goal = SVector::<f64, 6>::from([1.0, x, y, xx, xy, yy]);
    let limits = (LEAST_FOR_QUADRATIC, LARGEST_QUADRATIC_CONDITION);
    match_basis(points, weights, basis, &goal, limits)
}

/// Distance of the farthest point that has weight, m: about the radius of the support, or of the mesh
/// where that ends long before.
fn extent(points: &[Vector2<f64>], weights: &[f64]) -> f64 {
    let weighted = points.iter().zip(weights).filter(|pair| *pair.1 > 0.0);
    weighted.fold(f64::MIN_POSITIVE, |farthest, (u, _)| farthest.max(u.norm()))
}

fn match_basis<const N: usize>(
    points: &[Vector2<f64>],
    weights: &mut [f64],
    basis: impl Fn(&Vector2<f64>) -> SVector<f64, N>,
    goal: &SVector<f64, N>,
    (least, largest_condition): (usize, f64),
) -> Result<(), Degradation> {
    // On any failure below the row is left with a unit sum, which is the one thing all rows need.
    normalise(weights);
    if weights.iter().filter(|&&w| w > 0.0).count() < least {
        return Err(Degradation::FewVertices);
    }
    let mut matrix = SMatrix::<f64, N, N>::zeros();
    for (u, &w) in points.iter().zip(&*weights).filter(|pair| *pair.1 > 0.0) {
        let p = basis(u);
        matrix += p * p.transpose() * w;
    }
    // Only an upper bound of the condition, by the inverse's norm; spares the eigenvalues.
    let factor = matrix.cholesky().ok_or(Degradation::Collinear)?;
    let inverse = factor.inverse();
    if matrix.norm() * inverse.norm() > largest_condition {
        return Err(Degradation::Collinear);
    }
    let beta = factor.solve(goal);
    let factors: Vec<f64> = points.iter().map(|u| basis(u).dot(&beta)).collect();
    if factors.iter().zip(&*weights).any(|(f, &w)| f * w < 0.0) {
        return Err(Degradation::NegativeWeight);
    }
    for (weight, factor) in weights.iter_mut().zip(factors) {
        *weight *= factor;
    }
    // The solution has lost as many digits as the condition has; the unit sum shall have all.
    normalise(weights);
    Ok(())
}

/// Scales weights to a unit sum.
pub(crate) fn normalise(weights: &mut [f64]) {
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
}
