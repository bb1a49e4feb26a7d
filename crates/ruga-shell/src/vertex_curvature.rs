//! Bending energy of the faces around one vertex.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::RestTriangle;
use crate::hinge::{HingeCurvature, HingeState};

/// How the bending energy of a layer is made up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BendingModel {
    /// A [`Hinge`](crate::Hinge) per inner edge: the cheaper one, and right on meshes that are
    /// nearly equilateral. On triangles stretched 2:1 it is some 20 % too soft or 150 % too stiff,
    /// by direction, and its Poisson ratio is -1/3 whatever the material's.
    #[default]
    Hinge,
    /// A [`VertexCurvature`] per inner vertex: the modulus is that of the plate on stretched and on
    /// irregular triangles, the Poisson ratio that of the material. The Hessian couples all
    /// vertices around a vertex, half as many again as with hinges.
    VertexCurvature,
}

/// Smallest singular value of the mean map, see [`StarShape`], that is inverted as it is.
///
/// Blue noise stretched 4:1 reaches 0.08 in one star of thousands, stretched 2:1 it stays above 0.2.
const MIN_SINGULAR_VALUE: f64 = 0.1;

/// An outer triangle whose unfolded height is below this share of the spoke has no curvature to
/// compare with.
const MIN_HEIGHT_RATIO: f64 = 1e-3;

/// The faces around a vertex, unfolded into a plane: angles at the vertex are scaled to make a full
/// turn, lengths from it are kept.
///
/// Tensors are written in the components
///
/// ```text
/// ((k_xx + k_yy)/sqrt(2), (k_xx - k_yy)/sqrt(2), sqrt(2) k_xy)        norm and product kept
/// ```
///
/// The curvature of a star folded by `theta_e` about its spokes is the second derivative of a
/// piecewise linear surface, tested with the hat function of the vertex:
///
/// ```text
/// kappa = 1/A sum_e (l_e/2) theta_e n_e n_e^T         n_e unit, across the spoke; A a third of the faces
/// ```
///
/// positive along crests. Its trace is the cotangent Laplacian. Source: Miyoshi 1973 (moments that
/// are linear on each triangle), with the mass lumped.
///
/// # Traceless part
/// On a piecewise linear interpolant of curvature `c`, `kappa` is `P c`; `P` is the identity in
/// lattices of any triangle, and elsewhere only on average. With `kappa` an irregular mesh is
/// too stiff, 8 % in the direction along the short sides of 2:1 triangles; with `P^-1 kappa`, which
/// is exact on quadratic surfaces, too soft. The traceless part is that of `C kappa` with
/// `C^-1 = (P + 1)/2`, half way; the trace stays that of `kappa`, which is conforming.
#[derive(Clone, Debug, PartialEq)]
pub struct StarShape {
    area: f64,
    /// `(l_e/2A) n_e n_e^T`, in components.
    weights: Vec<Vector3<f64>>,
    /// `C`.
    correction: Matrix3<f64>,
}

impl StarShape {
    /// `fan` lists the faces around the vertex, counter-clockwise, and which corner of each the
    /// vertex is. Spoke `k` is the edge at which face `k` begins.
    pub fn new(fan: &[(RestTriangle, usize)]) -> Self {
        let area = fan.iter().map(|(face, _)| face.area()).sum::<f64>() / 3.0;
        let points = unfolded(fan);
        let weights: Vec<_> = points
            .iter()
            .map(|p| {
                // n n^T of the normal (-y, x)/l, times l/2A.
                let scale = 1.0 / (2.0 * area * p.norm());
                Vector3::new(p.norm_squared(), p.y * p.y - p.x * p.x, -2.0 * p.x * p.y)
                    * (scale * std::f64::consts::FRAC_1_SQRT_2)
            })
            .collect();
        let correction = quadratic_response(&points, &weights)
            .map_or_else(Matrix3::identity, |response| {
                inverse(0.5 * (response + Matrix3::identity()))
            });
        Self {
            area,
            weights,
            correction,
        }
    }

    /// A third of the faces' area (m²).
    pub fn area(&self) -> f64 {
        self.area
    }

    /// `C`, for components.
    pub fn correction(&self) -> &Matrix3<f64> {
        &self.correction
    }

    /// `kappa` in components (1/m) for the angles (rad) at the spokes, before any correction.
    pub fn curvature(&self, angles: &[f64]) -> Vector3<f64> {
        let folds = self.weights.iter().zip(angles);
        folds.map(|(weight, &angle)| weight * angle).sum()
    }
}

/// The outer vertices in the plane; the first on the x axis.
fn unfolded(fan: &[(RestTriangle, usize)]) -> Vec<Vector2<f64>> {
    let count = fan.len();
    // Length of the first and of the last side at the vertex, and the angle between them.
    let corners: Vec<_> = fan
        .iter()
        .map(|(face, corner)| {
            let (length, foot, height) = face.seen_from_edge(*corner);
            let aside = Vector2::new(foot * length, height);
            (length, aside.norm(), aside.y.atan2(aside.x))
        })
        .collect();
    let turn: f64 = corners.iter().map(|(_, _, angle)| angle).sum();
    let scale = 2.0 * std::f64::consts::PI / turn;
    let mut direction = 0.0;
    (0..count)
        .map(|k| {
            // The two faces at a spoke differ in its length only under a rest stretch.
            let length = 0.5 * (corners[k].0 + corners[(k + count - 1) % count].1);
            let (sin, cos) = f64::sin_cos(direction);
            direction += scale * corners[k].2;
            Vector2::new(cos, sin) * length
        })
        .collect()
}

/// `P`: columns are the curvatures of the interpolated quadratics of unit curvature. None if a
/// triangle is flat or turned over in the plane.
fn quadratic_response(points: &[Vector2<f64>], weights: &[Vector3<f64>]) -> Option<Matrix3<f64>> {
    let count = points.len();
    // Heights of the three unit curvatures, crests positive, up to the common sign.
    let depths = |p: &Vector2<f64>| {
        Vector3::new(p.norm_squared(), p.x * p.x - p.y * p.y, 2.0 * p.x * p.y)
            * (0.5 * std::f64::consts::FRAC_1_SQRT_2)
    };
    let mut response = Matrix3::zeros();
    for (k, spoke) in points.iter().enumerate() {
        let length = spoke.norm();
        let mut angles = Vector3::zeros();
        for (apex, side) in [
            (&points[(k + 1) % count], 1.0),
            (&points[(k + count - 1) % count], -1.0),
        ] {
            let height = side * spoke.perp(apex) / length;
            if height.is_nan() || height < MIN_HEIGHT_RATIO * length {
                return None;
            }
            let foot = spoke.dot(apex) / (length * length);
            angles += (depths(apex) - depths(spoke) * foot) / height;
        }
        response += weights[k] * angles.transpose();
    }
    Some(response)
}

/// Inverse with the singular values bounded below, so that no star becomes rigid.
fn inverse(matrix: Matrix3<f64>) -> Matrix3<f64> {
    let mut parts = matrix.svd(true, true);
    for value in &mut parts.singular_values {
        *value = 1.0 / value.max(MIN_SINGULAR_VALUE);
    }
    match (parts.u, parts.v_t) {
        (Some(u), Some(v_t)) => {
            v_t.transpose() * Matrix3::from_diagonal(&parts.singular_values) * u.transpose()
        }
        _ => Matrix3::identity(),
    }
}

/// `W = A D/2 ((tr kappa)^2 - 2 (1 - nu) det kappa)` of the faces around one vertex.
///
/// ```text
///       2---1           x: the vertex 0, then its neighbours counter-clockwise, as many as there are;
///      / \ / \          kappa: that of StarShape for the angles less their rest values, the
///     3---0---6         traceless part corrected. With t and d for the components of kappa and
///      \ / \ /          of C kappa:  W = A D/2 ((1 + nu) t_0^2 + (1 - nu) (d_1^2 + d_2^2)).
///       4---5
/// ```
///
/// # Shapes and units
/// Value J, gradient N, Hessian N/m as the 3×3 blocks of the lower triangle, row by row:
/// (0,0) (1,0) (1,1) (2,0) ...
///
/// # Validity
/// As [`Hinge`](crate::Hinge): angles jump where two faces are folded shut; a collapsed triangle
/// gives a value but no derivative, and never a NaN.
///
/// # Panics
/// Methods panic when the number of points is not one more than that of the angles.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexCurvature {
    /// `sqrt(A D)` times the components with their factors: `W` is half the square of the sum of
    /// angle times row.
    rows: Vec<Vector3<f64>>,
    /// Angles of the spokes at rest (rad).
    pub rest_angles: Vec<f64>,
}

impl VertexCurvature {
    /// `stiffness` is `D` (N m) times the area (m²) that the vertex stands for, `poisson` in
    /// (-1, 1].
    pub fn new(shape: &StarShape, stiffness: f64, poisson: f64, rest_angles: Vec<f64>) -> Self {
        Self {
            rows: rows(shape, stiffness, poisson),
            rest_angles,
        }
    }

    /// Energy (J).
    pub fn value(&self, x: &[Vector3<f64>]) -> f64 {
        0.5 * self.bend(&self.states(x)).norm_squared()
    }

    /// Derivative of the energy by the points (N).
    pub fn gradient(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let states = self.states(x);
        let bend = self.bend(&states);
        let mut gradient = vec![Vector3::zeros(); x.len()];
        for (k, (state, row)) in states.iter().zip(&self.rows).enumerate() {
            let moment = row.dot(&bend);
            for (i, g) in self.corners(k).into_iter().zip(state.angle_gradient()) {
                gradient[i] += g * moment;
            }
        }
        gradient
    }

    /// Second derivative of the energy (N/m).
    pub fn hessian(&self, x: &[Vector3<f64>], curvature: HingeCurvature) -> Vec<Matrix3<f64>> {
        let states = self.states(x);
        let mut slopes = vec![Matrix3::zeros(); x.len()];
        for (k, (state, row)) in states.iter().zip(&self.rows).enumerate() {
            for (i, g) in self.corners(k).into_iter().zip(state.angle_gradient()) {
                slopes[i] += row * g.transpose();
            }
        }
        let mut blocks = Vec::with_capacity(x.len() * (x.len() + 1) / 2);
        for (i, slope) in slopes.iter().enumerate() {
            blocks.extend(slopes[..=i].iter().map(|other| slope.tr_mul(other)));
        }
        if curvature == HingeCurvature::Full {
            self.add_curvature(&states, &mut blocks);
        }
        blocks
    }

    fn add_curvature(&self, states: &[HingeState], blocks: &mut [Matrix3<f64>]) {
        let bend = self.bend(states);
        for (k, (state, row)) in states.iter().zip(&self.rows).enumerate() {
            let mut hinge = [Matrix3::zeros(); 10];
            state.add_curvature(row.dot(&bend), &mut hinge);
            let corners = self.corners(k);
            let mut next = hinge.into_iter();
            for (a, &i) in corners.iter().enumerate() {
                for (&j, block) in corners[..=a].iter().zip(next.by_ref()) {
                    let (row, column) = (i.max(j), i.min(j));
                    let block = if i < j { block.transpose() } else { block };
                    blocks[row * (row + 1) / 2 + column] += block;
                }
            }
        }
    }

    /// Tail, head, left and right apex of the hinge at a spoke.
    fn corners(&self, spoke: usize) -> [usize; 4] {
        let count = self.rows.len();
        let [next, last] = [(spoke + 1) % count, (spoke + count - 1) % count];
        [0, spoke + 1, next + 1, last + 1]
    }

    fn states(&self, x: &[Vector3<f64>]) -> Vec<HingeState> {
        assert_eq!(x.len(), self.rows.len() + 1, "one point per spoke and one");
        (0..self.rows.len())
            .map(|spoke| HingeState::new(&self.corners(spoke).map(|i| x[i])))
            .collect()
    }

    fn bend(&self, states: &[HingeState]) -> Vector3<f64> {
        let bends = states.iter().zip(&self.rest_angles);
        weighted(&self.rows, bends.map(|(state, rest)| state.angle() - rest))
    }
}

/// `A D` and the components' factors taken into the weights: half the square of the sum of angle
/// times row is the energy.
pub(crate) fn rows(shape: &StarShape, stiffness: f64, poisson: f64) -> Vec<Vector3<f64>> {
    let mut map = shape.correction;
    map.set_row(0, &Vector3::x().transpose());
    let traceless = (stiffness * (1.0 - poisson)).sqrt();
    let factors = Vector3::new((stiffness * (1.0 + poisson)).sqrt(), traceless, traceless);
    let map = Matrix3::from_diagonal(&factors) * map;
    shape.weights.iter().map(|weight| map * weight).collect()
}

/// Sum of value times row.
#[inline]
pub(crate) fn weighted(rows: &[Vector3<f64>], values: impl Iterator<Item = f64>) -> Vector3<f64> {
    rows.iter()
        .zip(values)
        .map(|(row, value)| row * value)
        .sum()
}
