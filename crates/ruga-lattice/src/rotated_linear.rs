//! Linear elasticity in a rotated frame, at one point.

use nalgebra::{Matrix3, Vector3};

use crate::LatticeError;
use crate::signed_svd::SignedSvd;

/// The material inside the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidMaterial {
    /// Young's modulus, Pa; positive.
    pub young: f64,
    /// Poisson's ratio, over -1, at most 0.4999.
    ///
    /// Near one half elements lock: at 0.48 a bar of one quadratic element across bends a tenth too
    /// little, one of trilinear elements less than half as much as it should.
    pub poisson: f64,
}

impl SolidMaterial {
    pub(crate) fn check(&self) -> Result<(), LatticeError> {
        if !(self.young > 0.0 && self.young.is_finite()) {
            return Err(LatticeError::Setting {
                name: "young",
                value: self.young,
                accepted: "a positive number",
            });
        }
        if self.poisson > -1.0 && self.poisson <= 0.4999 {
            return Ok(());
        }
        Err(LatticeError::Setting {
            name: "poisson",
            value: self.poisson,
            accepted: "over -1, at most 0.4999",
        })
    }
}

/// Non-inverting rotated linear elasticity: energy density, stress and their derivative.
///
/// ```text
/// W = mu |S - I|^2 + lambda/2 tr(S - I)^2      F = R S
///   = mu sum (s_k - 1)^2 + lambda/2 (sum s_k - 3)^2
/// P = 2 mu (F - R) + lambda tr(S - I) R
/// ```
/// `R = U V^T` from the singular values with a sign ([Irving, Teran and Fedkiw 2004], the
/// reference of RK 5): where space is inside out the smallest stretch counts as negative, and
/// there is a force that turns it back, as there is none with the usual polar decomposition.
///
/// # Validity
/// Gradient and Hessian are exact wherever the sum of the two smaller stretches is not zero. There
/// `W` is continuous and has a ridge, never a valley, so a minimiser leaves it.
///
/// [Irving, Teran and Fedkiw 2004]: https://doi.org/10.1145/1028523.1028541
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotatedLinear {
    /// `mu`, Pa.
    shear: f64,
    /// `lambda`, Pa.
    lame: f64,
}

/// The derivative of the stress by the deformation gradient, in factors.
///
/// `dP/dF = 2 mu I + lambda R R^T + sum_k c_k T_k T_k^T`, with matrices as vectors of nine. The
/// twists `T_k` are of unit length and orthogonal to each other and to `R`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) twists: [Matrix3<f64>; 3],
    /// `c_k`, Pa.
    pub(crate) exact: [f64; 3],
    /// Factors `c_k` raised until `2 mu + c_k` is not negative: the projection of `dP/dF` on
    /// positive semidefinite matrices, as all its eigenvalues but these are positive (Pa).
    pub(crate) relaxed: [f64; 3],
}

/// Sum of two stretches below which it is replaced, so that the exact tangent stays finite.
const LEAST_SUM: f64 = 1e-8;

impl RotatedLinear {
    /// From Young's modulus (Pa) and Poisson's ratio, both in the ranges of [`SolidMaterial`], which are
    /// not checked here.
    pub fn new(young: f64, poisson: f64) -> Self {
        Self {
            shear: young / (2.0 * (1.0 + poisson)),
            lame: young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        }
    }

    /// First Lamé parameter `lambda` (Pa).
    pub fn lame(&self) -> f64 {
        self.lame
    }

    /// Shear modulus `mu` (Pa).
    pub fn shear(&self) -> f64 {
        self.shear
    }

    /// Energy density (J/m³) at the deformation gradient `f`.
    pub fn energy(&self, f: &Matrix3<f64>) -> f64 {
        let strain = SignedSvd::new(f).stretches.add_scalar(-1.0);
        self.shear * strain.norm_squared() + 0.5 * self.lame * strain.sum().powi(2)
    }

    /// First Piola-Kirchhoff stress (Pa) at the deformation gradient `f`.
    pub fn stress(&self, f: &Matrix3<f64>) -> Matrix3<f64> {
        let svd = SignedSvd::new(f);
        let rotation = svd.left * svd.right.transpose();
        let dilation = svd.stretches.sum() - 3.0;
        (f - rotation) * (2.0 * self.shear) + rotation * (self.lame * dilation)
    }

    /// The derivative of [`Self::stress`].
    pub(crate) fn tangent(&self, f: &Matrix3<f64>) -> Tangent {
        let svd = SignedSvd::new(f);
        let dilation = svd.stretches.sum() - 3.0;
        // The rotation is in the stress twice, with -2 mu and with lambda times the dilation, and
        // its derivative has the sum of both.
        let excess = self.lame * dilation - 2.0 * self.shear;
        let mut exact = [0.0; 3];
        let mut twists = [Matrix3::zeros(); 3];
        for (k, [i, j]) in [[0, 1], [0, 2], [1, 2]].into_iter().enumerate() {
            // dR/dF turns about the axis across i and j by a share of 2 / (s_i + s_j).
            let sum = svd.stretches[i] + svd.stretches[j];
            // No sum is negative: only the smallest stretch can be, and it is the smallest in size.
            exact[k] = 2.0 * excess / sum.max(LEAST_SUM);
            let column = |m: &Matrix3<f64>, c: usize| -> Vector3<f64> { m.column(c).into_owned() };
            let [ui, uj] = [i, j].map(|c| column(&svd.left, c));
            let [vi, vj] = [i, j].map(|c| column(&svd.right, c));
            twists[k] =
                (ui * vj.transpose() - uj * vi.transpose()) * std::f64::consts::FRAC_1_SQRT_2;
        }
        Tangent {
            rotation: svd.left * svd.right.transpose(),
            twists,
            exact,
            relaxed: exact.map(|c| c.max(-2.0 * self.shear)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, SMatrix, SVector};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    type Matrix9 = SMatrix<f64, 9, 9>;
    type Vector9 = SVector<f64, 9>;

    fn flat(m: &Matrix3<f64>) -> Vector9 {
        Vector9::from_column_slice(m.as_slice())
    }

    fn matrix(material: &RotatedLinear, tangent: &Tangent, twists: [f64; 3]) -> Matrix9 {
        let outer = |m: &Matrix3<f64>| flat(m) * flat(m).transpose();
        let mut sum = Matrix9::from_diagonal_element(2.0 * material.shear);
        sum += outer(&tangent.rotation) * material.lame;
        for (twist, factor) in tangent.twists.iter().zip(twists) {
            sum += outer(twist) * factor;
        }
        sum
    }

    /// Deformations with given stretches in random directions.
    fn deformations(count: u64) -> impl Iterator<Item = Matrix3<f64>> {
        let stretches = [
            [1.0, 1.0, 1.0],
            [1.3, 0.9, 0.7],
            [0.8, 0.6, 0.5],
            [1.2, 0.9, 1e-3],
            [1.2, 0.9, 0.0],
            [1.2, 0.9, -1e-3],
            [1.1, 0.8, -0.5],
            [1.5, 1.4, -1.2],
            [0.3, 0.2, -0.1],
            [5.0, 0.4, 0.1],
        ];
        (0..count).map(move |seed| {
            let mut rng = Pcg64::seed_from_u64(seed);
            let mut turn = || {
                let axis = Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0));
                Rotation3::new(axis).into_inner()
            };
            let s = Vector3::from(stretches[seed as usize % stretches.len()]);
            turn() * Matrix3::from_diagonal(&s) * turn()
        })
    }

    #[test]
    fn stress_and_tangent_are_derivatives_also_when_inverted() {
        let material = RotatedLinear::new(2.5, 0.3);
        let step = 1e-4;
        for f in deformations(60) {
            let (mut by_energy, mut by_stress) = (Vector9::zeros(), Matrix9::zeros());
            for k in 0..9 {
                let at = |steps: f64| {
                    let mut g = f;
                    g[k] += steps * step;
                    g
                };
                // Fourth order, so that the step need not be tiny.
                let weights = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
                for (steps, weight) in weights {
                    let weight = weight / (12.0 * step);
                    by_energy[k] += material.energy(&at(steps)) * weight;
                    let column = by_stress.column(k) + flat(&material.stress(&at(steps))) * weight;
                    by_stress.set_column(k, &column);
                }
            }
            let stress = flat(&material.stress(&f));
            assert!((stress - by_energy).amax() < 1e-9, "{f}");
            let tangent = material.tangent(&f);
            let exact = matrix(&material, &tangent, tangent.exact);
            assert!((exact - by_stress).amax() < 1e-8 * exact.amax(), "{f}");
        }
    }

    #[test]
    fn relaxed_tangent_is_the_projection_of_the_exact_one() {
        let material = RotatedLinear::new(1.0, 0.45);
        for f in deformations(40) {
            let tangent = material.tangent(&f);
            let exact = matrix(&material, &tangent, tangent.exact).symmetric_eigen();
            let positive = exact.eigenvalues.map(|v| v.max(0.0));
            let q = exact.eigenvectors;
            let projected = q * Matrix9::from_diagonal(&positive) * q.transpose();
            let relaxed = matrix(&material, &tangent, tangent.relaxed);
            assert!((relaxed - projected).amax() < 1e-12 * exact.eigenvalues.amax());
        }
    }

    #[test]
    fn energy_is_that_of_linear_elasticity_for_small_strain_and_blind_to_rotation() {
        let material = RotatedLinear::new(3.0, 0.4);
        let strain: Matrix3<f64> =
            Matrix3::new(2.0, 0.5, -0.3, 0.5, -1.0, 0.7, -0.3, 0.7, 0.4) * 1e-6;
        let turn = Rotation3::new(Vector3::new(0.3, -2.0, 0.8)).into_inner();
        let expected = material.shear() * strain.norm_squared()
            + 0.5 * material.lame() * strain.trace().powi(2);
        let found = material.energy(&(turn * (Matrix3::identity() + strain)));
        assert!((found / expected - 1.0).abs() < 1e-8);
        assert!(material.energy(&turn) < 1e-29);
    }
}
