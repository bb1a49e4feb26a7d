//! Springs that hold a face of an upper layer to the face of the layer below.

use nalgebra::{Matrix3, Vector3};

use crate::RestTriangle;
use crate::foundation::NormalFoundation;

/// Stiffnesses of the springs between two layers at one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerSpringParameters {
    /// `K0` of the upper layer on the lower one (N/m³), ≥ 0.
    pub normal_stiffness: f64,
    /// `K1` on the gradient of the deviation (N/m), any sign; as in a layer, a negative one is kept,
    /// and `K0` and bending have to outweigh it.
    pub gradient_stiffness: f64,
    /// `Kt` against sliding (N/m³), ≥ 0; the shear of the lower layer across its thickness,
    /// `mu_1/h_1`.
    pub tangential_stiffness: f64,
}

/// Springs that hold a face of an upper layer to the lower layer's face below it.
///
/// With `x` the corners of the lower face, `y` those of the upper one, `n` the unit normal of the
/// lower face where it is now, and per corner `r = y - x`:
///
/// ```text
/// w_i = n.r_i - t_i                    deviation from the mid-surface offset t_i
/// d_i = r_i - n (n.r_i)                drift
/// E   = NormalFoundation(w) + 1/2 Kt A/3 sum_i |d_i|^2
///
///    3-----4   (5 behind)       upper corner y_i is vertex 3 + i of the stencil,
///    |     |                    r_i stand upright between
///    0-----1   (2 behind)       lower corner x_i is vertex i; 0, 1, 2 counter-clockwise from above
/// ```
///
/// The normal part is that of a layer on a fixed base, so that an upper layer costs the same on a
/// lower one that does not move as on its own foundation; areas and gradients are those of the
/// lower face's rest metric. The drift feels the rotation of the lower face: this couples the
/// shells' shear, as in a sandwich.
///
/// # Shapes and units
/// Six points (m), lower corners first. Values J, gradient N, Hessian N/m as the 3×3 blocks of the
/// lower triangle, row by row: (0,0) (1,0) (1,1) (2,0) ... (5,5).
///
/// # Validity
/// A lower face that has collapsed to a line has no normal: the tangential springs then pull the
/// corners together, and nothing is NaN.
///
/// The normal is a facet's. Where the surface has a curvature `kappa` in one direction, the normals
/// of the equilateral faces around a vertex, edge `e`, scatter about their mean by
/// `3/16 (kappa e)^2` in the mean square. No arm is normal to all of them: the shells bend as if
/// there were a stiffness
///
/// ```text
/// D_facet = 3/16 Kt t^2 e^2
/// ```
///
/// more, whatever the direction of the curvature. Against the sandwich's own `Kq t^2/k^2`, with `Kq`
/// the tangential springs in series with the membranes, this is the share `3/16 (k e)^2 Kt/Kq`. At
/// 16 edges per common wave it raises the critical strain of Li 2014's skin by 1 %, that of a soft
/// thin film by 4 %, and falls with the square of the edge: where the mesh resolves the fine wave it
/// is nothing.
/// For the same reason a pair that is curved at rest, with arms along its vertex normals, feels a
/// moment `D_facet kappa` towards flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerSprings {
    normal: NormalFoundation,
    /// `Kt A/3` (N/m).
    tangential: f64,
    offsets: [f64; 3],
}

/// Geometry that value, gradient and Hessian at one face share.
#[derive(Clone, Copy, Debug)]
pub struct LayerSpringState {
    /// Unit normal of the lower face.
    normal: Vector3<f64>,
    /// Gradients of the lower face's linear shape functions, in space and as it lies now (1/m).
    gradients: [Vector3<f64>; 3],
    /// Heights `n.r` of the upper corners (m).
    heights: [f64; 3],
    drifts: [Vector3<f64>; 3],
}

impl LayerSpringState {
    /// Normal, heights and drifts at `x`.
    #[inline]
    pub fn new(x: &[Vector3<f64>; 6]) -> Self {
        let product = (x[1] - x[0]).cross(&(x[2] - x[0]));
        let length = product.norm();
        // A collapsed face has no direction; zero keeps every derivative finite.
        let inverse = if length > f64::MIN_POSITIVE.sqrt() {
            1.0 / length
        } else {
            0.0
        };
        let normal = product * inverse;
        // The normal turns with the face as it lies now. These are not the gradients at rest, which
        // weigh K1.
        let gradient = |i: usize| normal.cross(&(x[(i + 2) % 3] - x[(i + 1) % 3])) * inverse;
        let arms = [x[3] - x[0], x[4] - x[1], x[5] - x[2]];
        let heights = arms.map(|r| normal.dot(&r));
        Self {
            normal,
            gradients: std::array::from_fn(gradient),
            heights,
            drifts: std::array::from_fn(|i| arms[i] - normal * heights[i]),
        }
    }
}

impl LayerSprings {
    /// `rest` is the lower face's rest shape, `offsets` the distance of each upper corner from the
    /// lower one when unstrained (m), between the mid-surfaces.
    pub fn new(rest: &RestTriangle, parameters: &LayerSpringParameters, offsets: [f64; 3]) -> Self {
        let LayerSpringParameters {
            normal_stiffness,
            gradient_stiffness,
            tangential_stiffness,
        } = *parameters;
        Self {
            normal: NormalFoundation::new(rest, normal_stiffness, gradient_stiffness),
            tangential: tangential_stiffness * rest.area() / 3.0,
            offsets,
        }
    }

    /// Energies of the `K0`, `K1` and `Kt` terms (J).
    pub fn values(&self, x: &[Vector3<f64>; 6]) -> [f64; 3] {
        let state = LayerSpringState::new(x);
        let [normal, gradient] = self.normal.values(self.deviations(&state));
        let squares: f64 = state.drifts.iter().map(Vector3::norm_squared).sum();
        [normal, gradient, 0.5 * self.tangential * squares]
    }

    /// `w` of the three corners (m).
    pub fn deviations(&self, state: &LayerSpringState) -> [f64; 3] {
        std::array::from_fn(|i| state.heights[i] - self.offsets[i])
    }

    /// Derivative of the energy by the six points (N).
    ///
    /// The normal turns by `dn = -sum_i G_i (n.dx_i)`, with `G_i` the shape gradients.
    #[inline]
    pub fn gradient(&self, x: &[Vector3<f64>; 6]) -> [Vector3<f64>; 6] {
        let state = LayerSpringState::new(x);
        let pressures = self.normal.gradient(self.deviations(&state));
        let by_normal = self.by_normal(&state, &pressures);
        let n = state.normal;
        let forces: [_; 3] =
            std::array::from_fn(|i| state.drifts[i] * self.tangential + n * pressures[i]);
        // A lower corner takes the counterforce of the one above it, and turns the normal besides.
        let below = |i: usize| -forces[i] - n * state.gradients[i].dot(&by_normal);
        [
            below(0),
            below(1),
            below(2),
            forces[0],
            forces[1],
            forces[2],
        ]
    }

    /// Derivative of the energy by the normal, in the plane of the face (J).
    #[inline]
    fn by_normal(&self, state: &LayerSpringState, pressures: &[f64; 3]) -> Vector3<f64> {
        // A unit normal cannot change along itself, so that of each arm only the drift does work.
        (0..3)
            .map(|i| state.drifts[i] * (pressures[i] - self.tangential * state.heights[i]))
            .sum()
    }

    /// `J^T K J` with the first derivatives of the deviations and drifts: positive semidefinite up
    /// to a negative `K1`.
    ///
    /// With `D_ik = d_i.G_k` and the quadratic form's matrix `M`, the second derivative by the arms
    /// `r_i` and the rises `n.dx_k` of the lower corners has the parts
    ///
    /// ```text
    /// arm i, arm j    M_ij n n^T + s delta_ij (I - n n^T)             s = Kt A/3
    /// arm i, rise k   -n (M D)_ik + s p_i G_k                         p_i = n.r_i
    /// rise k, rise l  (D^T M D)_kl + s (D^T D)_kl + s |p|^2 G_k.G_l
    /// ```
    #[inline]
    pub fn gauss_newton(&self, state: &LayerSpringState) -> [Matrix3<f64>; 21] {
        let (n, s) = (state.normal, self.tangential);
        let matrix = self.normal.matrix();
        let slopes = slopes(state);
        let turned = matrix * slopes;
        let squares: f64 = state.heights.iter().map(|p| p * p).sum();
        let nodal = slopes.transpose() * (turned + slopes * s);
        let across = (Matrix3::identity() - n * n.transpose()) * s;
        // In arms and rises the matrix is short. The change to points is linear and stands once,
        // for this part and for the curvature.
        let parts = Parts {
            arms: |i, j| {
                let normal = n * (n * matrix[(i, j)]).transpose();
                if i == j { normal + across } else { normal }
            },
            arm_rise: |i, k| state.gradients[k] * (s * state.heights[i]) - n * turned[(i, k)],
            rises: |k: usize, l: usize| {
                nodal[(k, l)] + s * squares * state.gradients[k].dot(&state.gradients[l])
            },
        };
        parts.blocks(&n)
    }

    /// Adds what the second derivatives of deviations and drifts make of the forces.
    ///
    /// With pressures `m = M w` and `g` the derivative by the normal,
    ///
    /// ```text
    /// arm i, rise k   -m_i G_k + s D_ik n
    /// rise k, rise l  -(m.p) G_k.G_l - 2 s (D^T D)_kl
    /// x_i, x_k        (g.G_i) G_k n^T + (g.G_k) n G_i^T      from the normal's second derivative
    /// ```
    #[inline]
    pub fn add_curvature(&self, state: &LayerSpringState, blocks: &mut [Matrix3<f64>; 21]) {
        let (n, s) = (state.normal, self.tangential);
        let pressures = self.normal.gradient(self.deviations(state));
        let slopes = slopes(state);
        let nodal = slopes.transpose() * slopes * (2.0 * s);
        let work: f64 = (0..3).map(|i| pressures[i] * state.heights[i]).sum();
        let parts = Parts {
            // Deviations and drifts are linear in the arms while the normal stands still.
            arms: |_, _| Matrix3::zeros(),
            arm_rise: |i, k| n * (s * slopes[(i, k)]) - state.gradients[k] * pressures[i],
            rises: |k: usize, l: usize| {
                -work * state.gradients[k].dot(&state.gradients[l]) - nodal[(k, l)]
            },
        };
        for (block, part) in blocks.iter_mut().zip(parts.blocks(&n)) {
            *block += part;
        }
        let by_normal = self.by_normal(state, &pressures);
        let turns = state.gradients.map(|gradient| gradient.dot(&by_normal));
        // Upper corners do not turn the normal: its second derivative has the lower face's blocks
        // only.
        for (block, [i, k]) in LOWER_PAIRS.into_iter().enumerate() {
            blocks[block] += (state.gradients[k] * turns[i]) * n.transpose()
                + (n * turns[k]) * state.gradients[i].transpose();
        }
    }

    /// Second derivative of the energy (N/m).
    pub fn hessian(&self, x: &[Vector3<f64>; 6]) -> [Matrix3<f64>; 21] {
        let state = LayerSpringState::new(x);
        let mut blocks = self.gauss_newton(&state);
        self.add_curvature(&state, &mut blocks);
        blocks
    }
}

/// `D_ik = d_i.G_k`: the deviation of corner `i` falls by this when the lower corner `k` rises by 1.
#[inline]
fn slopes(state: &LayerSpringState) -> Matrix3<f64> {
    Matrix3::from_fn(|i, k| state.drifts[i].dot(&state.gradients[k]))
}

/// Rows and columns of the first six blocks, the lower face's own.
const LOWER_PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 0], [1, 1], [2, 0], [2, 1], [2, 2]];

/// A symmetric form in the arms `r_i` and the rises `n.x_k` of the lower corners.
struct Parts<A, C, S> {
    arms: A,
    arm_rise: C,
    rises: S,
}

impl<A, C, S> Parts<A, C, S>
where
    A: Fn(usize, usize) -> Matrix3<f64>,
    C: Fn(usize, usize) -> Vector3<f64>,
    S: Fn(usize, usize) -> f64,
{
    /// The same form in the six points: `r_i = y_i - x_i`.
    #[inline]
    fn blocks(&self, n: &Vector3<f64>) -> [Matrix3<f64>; 21] {
        let mut blocks = [Matrix3::zeros(); 21];
        let mut next = 0;
        for i in 0..6 {
            for k in 0..=i {
                blocks[next] = match (i < 3, k < 3) {
                    (true, _) => {
                        (self.arms)(i, k)
                            - (self.arm_rise)(i, k) * n.transpose()
                            - n * (self.arm_rise)(k, i).transpose()
                            + n * (n * (self.rises)(i, k)).transpose()
                    }
                    (false, true) => {
                        (self.arm_rise)(i - 3, k) * n.transpose() - (self.arms)(i - 3, k)
                    }
                    (false, false) => (self.arms)(i - 3, k - 3),
                };
                next += 1;
            }
        }
        blocks
    }
}
