//! In-plane energy of one face.

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector2, Vector3};

use crate::RestTriangle;
use crate::collapse::Collapse;

/// St. Venant-Kirchhoff plane stress on a linear triangle.
///
/// `W = A C/2 ((1 - nu) E:E + nu tr(E)^2)`, `E = (F^T F - I)/2 - E_0`, `C = E_young h/(1 - nu^2)`.
/// Linear triangles do not lock here: the strain `u' + w'^2/2` is constant per triangle.
///
/// # Shapes and units
/// `x`: the face's three corners (m). Value J, gradient N, Hessian N/m as the 3×3 blocks of the
/// lower triangle in the order (0,0) (1,0) (1,1) (2,0) (2,1) (2,2).
///
/// # Validity
/// Softens under compression (`N = C (e - e^2/2)`), and gives way altogether beyond 42 %. Where a face has
/// area `J`, over its rest area, below 0.4 times the stress-free one, `J_0`, `A C (J_0 - J)^3 / J_0^2` is added,
/// which keeps it from vanishing.
#[derive(Clone, Copy, Debug)]
pub struct Membrane {
    gradients: [Vector2<f64>; 2],
    /// `A C`.
    stiffness: f64,
    poisson: f64,
    /// `E_0`: Green strain at which there is no stress, zero when built.
    natural: Matrix2<f64>,
    /// Area at that strain over rest area.
    natural_area: f64,
}

/// Which stress enters the geometric part of a Hessian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stress {
    /// The stress itself: the exact Hessian.
    Full,
    /// Its positive part: the Hessian without compressive stress stiffness, positive semidefinite.
    Tensile,
}

/// Deformation and stress that value, gradient and Hessian of one face share.
#[derive(Clone, Copy, Debug)]
pub struct MembraneState {
    deformation: Matrix3x2<f64>,
    strain: Matrix2<f64>,
    /// Second Piola-Kirchhoff stress times rest area (J).
    stress: Matrix2<f64>,
    collapse: Option<Collapse>,
}

impl Membrane {
    /// `tension` is `C = E h/(1 - nu^2)` (N/m), `poisson` is `nu`.
    pub fn new(rest: &RestTriangle, tension: f64, poisson: f64) -> Self {
        let [_, g1, g2] = rest.shape_gradients();
        Self {
            gradients: [g1, g2],
            stiffness: rest.area() * tension,
            poisson,
            natural: Matrix2::zeros(),
            natural_area: 1.0,
        }
    }

    /// This membrane with the stress-free Green strain `natural`, in the rest frame.
    ///
    /// Unlike another rest metric it leaves lengths, areas and what bends per area as they are.
    pub fn with_natural_strain(self, natural: Matrix2<f64>) -> Self {
        let metric = Matrix2::identity() + 2.0 * natural;
        Self {
            natural,
            natural_area: metric.determinant().max(0.0).sqrt(),
            ..self
        }
    }

    /// The stress-free Green strain, in the rest frame.
    pub fn natural_strain(&self) -> Matrix2<f64> {
        self.natural
    }

    /// Deformation gradient, strain and stress at `x`.
    #[inline]
    pub fn state(&self, x: &[Vector3<f64>; 3]) -> MembraneState {
        let deformation = self.deformation(x);
        let strain = self.strain(&deformation);
        MembraneState {
            deformation,
            strain,
            stress: self.stress(&strain),
            collapse: Collapse::new(&deformation, self.stiffness, self.natural_area),
        }
    }

    /// The state at `x`, with the stress that follows from the strain linearised at `from`:
    /// `E(from) + sym(F(from)^T (F(x) - F(from)))`. That leaves out the square of the displacement, by which a face
    /// stretches that turns on straight lines. Strain and deformation are those at `x`.
    #[inline]
    pub fn predicted_state(
        &self,
        from: &[Vector3<f64>; 3],
        x: &[Vector3<f64>; 3],
    ) -> MembraneState {
        let (before, after) = (self.deformation(from), self.state(x));
        let change = before.transpose() * (after.deformation - before);
        let strain = self.strain(&before) + 0.5 * (change + change.transpose());
        MembraneState {
            stress: self.stress(&strain),
            ..after
        }
    }

    fn deformation(&self, x: &[Vector3<f64>; 3]) -> Matrix3x2<f64> {
        let [g1, g2] = self.gradients;
        (x[1] - x[0]) * g1.transpose() + (x[2] - x[0]) * g2.transpose()
    }

    fn strain(&self, deformation: &Matrix3x2<f64>) -> Matrix2<f64> {
        0.5 * (deformation.transpose() * deformation - Matrix2::identity()) - self.natural
    }

    fn stress(&self, strain: &Matrix2<f64>) -> Matrix2<f64> {
        let pressure = self.poisson * strain.trace();
        self.stiffness * ((1.0 - self.poisson) * strain + Matrix2::from_diagonal_element(pressure))
    }

    /// Energy (J).
    pub fn value(&self, x: &[Vector3<f64>; 3]) -> f64 {
        let state = self.state(x);
        let collapse = state.collapse.map_or(0.0, |collapse| collapse.value());
        0.5 * state.stress.dot(&state.strain) + collapse
    }

    /// Derivative of the energy by the three corners (N).
    #[inline]
    pub fn gradient(&self, x: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
        let state = self.state(x);
        let mut forces = state.deformation * state.stress;
        if let Some(collapse) = &state.collapse {
            forces += collapse.stress();
        }
        // A translation does no work, which gives corner 0 its force.
        let at_1 = forces * self.gradients[0];
        let at_2 = forces * self.gradients[1];
        [-(at_1 + at_2), at_1, at_2]
    }

    /// Second derivative of the energy (N/m), with the stress stiffness that `stress` names.
    pub fn hessian(&self, x: &[Vector3<f64>; 3], stress: Stress) -> [Matrix3<f64>; 6] {
        let state = self.state(x);
        self.with_stress(&self.material_blocks(&state), &state, stress)
    }

    /// The part of the Hessian that the elasticity tensor makes: blocks (1,1) (2,1) (2,2).
    ///
    /// Corner 0 follows because the rows of a Hessian sum to zero under translation.
    #[inline]
    pub fn material_blocks(&self, state: &MembraneState) -> [Matrix3<f64>; 3] {
        let [g1, g2] = self.gradients;
        let pushed = |a: &Vector2<f64>, b: &Vector2<f64>| {
            // u_a^T F T F^T u_b with T = C A ((1-nu)/2 (a.b I + b a^T) + nu a b^T).
            let shear = 0.5 * (1.0 - self.poisson);
            let tangent = Matrix2::from_diagonal_element(shear * a.dot(b))
                + shear * b * a.transpose()
                + self.poisson * a * b.transpose();
            state.deformation * (self.stiffness * tangent) * state.deformation.transpose()
        };
        [pushed(&g1, &g1), pushed(&g2, &g1), pushed(&g2, &g2)]
    }

    /// Adds the geometric part to the material one and completes corner 0.
    #[inline]
    pub fn with_stress(
        &self,
        material: &[Matrix3<f64>; 3],
        state: &MembraneState,
        stress: Stress,
    ) -> [Matrix3<f64>; 6] {
        let [g1, g2] = self.gradients;
        // Of the two parts the material one is semidefinite at any state. Dropping compression here
        // is enough, and needs a 2x2 eigenproblem instead of a 9x9 one.
        let (is_full, stress) = match stress {
            Stress::Full => (true, state.stress),
            Stress::Tensile => (false, positive_part(&state.stress)),
        };
        let geometric = |a: &Vector2<f64>, b: &Vector2<f64>| {
            // By two points the strain's second derivative is a multiple of the identity in space.
            let block = Matrix3::from_diagonal_element(a.dot(&(stress * b)));
            match &state.collapse {
                None => block,
                // It always presses, so that only its square counts as tensile.
                Some(collapse) => block + collapse.block(a, b, is_full),
            }
        };
        let h11 = material[0] + geometric(&g1, &g1);
        let h21 = material[1] + geometric(&g2, &g1);
        let h22 = material[2] + geometric(&g2, &g2);
        let h10 = -(h11 + h21.transpose());
        let h20 = -(h21 + h22);
        [-(h10 + h20), h10, h11, h20, h21, h22]
    }
}

/// Positive part of a symmetric 2×2 matrix.
fn positive_part(m: &Matrix2<f64>) -> Matrix2<f64> {
    let mean = 0.5 * m.trace();
    let radius = (0.5 * (m.m11 - m.m22)).hypot(m.m12);
    if mean >= radius {
        *m
    } else if mean <= -radius {
        Matrix2::zeros()
    } else {
        // One eigenvalue of each sign: mean + radius times the projector on its direction.
        (m - Matrix2::from_diagonal_element(mean - radius)) * ((mean + radius) / (2.0 * radius))
    }
}
