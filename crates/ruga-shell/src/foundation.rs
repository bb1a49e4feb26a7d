//! Springs that hold a layer to the surface below.

use nalgebra::{Matrix3, Vector3};

use crate::RestTriangle;

/// Pasternak energy of one face on the normal deviations `w` of its corners.
///
/// ```text
/// E = 1/2 K0 A [ 1/2 sum_a w_a^2/3 + 1/2 ((w1+w2+w3)^2 + w1^2+w2^2+w3^2)/12 ]
///   + 1/2 K1 A |sum_a w_a grad phi_a|^2
/// ```
///
/// The mass is half lumped, half consistent: the leading errors of the two cancel, and wavelength
/// and onset are right from 6 points per wavelength. The gradient is the membrane's own, in the
/// rest metric: its discretisation error then cancels against that of the compressive force.
///
/// # Shapes and units
/// `w`: deviations of the three corners (m). Value J, gradient N, matrix N/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalFoundation {
    /// `K0 A` (N/m).
    mass: f64,
    /// `K1 A grad phi_a . grad phi_b` of the corner pairs 1-2, 2-0, 0-1 (N/m).
    couplings: [f64; 3],
}

impl NormalFoundation {
    /// `normal` is `K0` (N/m³), `gradient` is `K1` (N/m).
    pub fn new(rest: &RestTriangle, normal: f64, gradient: f64) -> Self {
        let [g0, g1, g2] = rest.shape_gradients();
        let scale = gradient * rest.area();
        Self {
            mass: normal * rest.area(),
            couplings: [g1.dot(&g2), g2.dot(&g0), g0.dot(&g1)].map(|c| scale * c),
        }
    }

    /// Energies of the `K0` and of the `K1` term (J).
    pub fn values(&self, w: [f64; 3]) -> [f64; 2] {
        let squares = w.iter().map(|w| w * w).sum::<f64>();
        let sum = w.iter().sum::<f64>();
        let normal = 0.5 * self.mass * (0.5 * squares / 3.0 + 0.5 * (sum * sum + squares) / 12.0);
        // Rows of the gradient matrix sum to zero, so that only differences count. Off the diagonal
        // its entries are negative on acute triangles, hence the sign below.
        let differences = [w[1] - w[2], w[2] - w[0], w[0] - w[1]];
        let gradient = -0.5
            * (0..3)
                .map(|a| self.couplings[a] * differences[a] * differences[a])
                .sum::<f64>();
        [normal, gradient]
    }

    /// Derivative of the energy by the deviations (N).
    #[inline]
    pub fn gradient(&self, w: [f64; 3]) -> [f64; 3] {
        let sum = w[0] + w[1] + w[2];
        let [c0, c1, c2] = self.couplings;
        let (d0, d1, d2) = (w[1] - w[2], w[2] - w[0], w[0] - w[1]);
        // Half of w/3 from the lumped mass, half of (sum + w)/12 from the consistent one.
        let mass = |a: usize| self.mass * (5.0 * w[a] + sum) / 24.0;
        [
            mass(0) + c1 * d1 - c2 * d2,
            mass(1) + c2 * d2 - c0 * d0,
            mass(2) + c0 * d0 - c1 * d1,
        ]
    }

    /// The constant second derivative (N/m).
    pub fn matrix(&self) -> Matrix3<f64> {
        let [c0, c1, c2] = self.couplings;
        // Twenty-fourths of both halves: 4 + 2 on the diagonal, 0 + 1 beside it.
        let off = self.mass / 24.0;
        let diagonal = self.mass / 4.0;
        Matrix3::new(
            diagonal - c1 - c2,
            off + c2,
            off + c1,
            off + c2,
            diagonal - c2 - c0,
            off + c0,
            off + c1,
            off + c0,
            diagonal - c0 - c1,
        )
    }
}

/// The surface below as one vertex sees it: the anchor `p + offset n` and the unit normal `n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Base point plus offset along the normal (m).
    pub point: Vector3<f64>,
    /// Unit normal of the base.
    pub normal: Vector3<f64>,
}

impl Anchor {
    /// Normal deviation `w = n.(x - p - offset n)` (m).
    #[inline]
    pub fn deviation(&self, x: &Vector3<f64>) -> f64 {
        // Measured from the vertex's own material point. From the closest point of the base the
        // stiffness would depend on the slope, and couple to sliding.
        self.normal.dot(&(x - self.point))
    }

    /// Tangential drift `(I - n n^T)(x - p)` (m).
    #[inline]
    pub fn drift(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.across(&(x - self.point))
    }

    /// Tangential part `(I - n n^T) v` of a vector.
    #[inline]
    pub(crate) fn across(&self, v: &Vector3<f64>) -> Vector3<f64> {
        v - self.normal * self.normal.dot(v)
    }

    /// `I - n n^T`.
    pub(crate) fn across_matrix(&self) -> Matrix3<f64> {
        Matrix3::identity() - self.normal * self.normal.transpose()
    }
}

/// Spring that keeps a vertex from sliding off its material point, lumped.
///
/// `E = 1/2 k |(I - n n^T)(x - p)|^2` with `k = Kt V`, `V` the vertex's rest area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentialSpring {
    /// `Kt` times rest vertex area (N/m).
    pub stiffness: f64,
}

impl TangentialSpring {
    /// Energy (J).
    pub fn value(&self, anchor: &Anchor, x: &Vector3<f64>) -> f64 {
        0.5 * self.stiffness * anchor.drift(x).norm_squared()
    }

    /// Derivative by `x` (N).
    #[inline]
    pub fn gradient(&self, anchor: &Anchor, x: &Vector3<f64>) -> Vector3<f64> {
        anchor.drift(x) * self.stiffness
    }

    /// Second derivative (N/m).
    pub fn hessian(&self, anchor: &Anchor) -> Matrix3<f64> {
        anchor.across_matrix() * self.stiffness
    }
}
