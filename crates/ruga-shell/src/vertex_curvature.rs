//! Curvature of the faces around one vertex, and what it costs.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::RestTriangle;
use crate::natural_curvature::side_fold;

/// Smallest singular value of the mean map, see [`StarShape`], that is inverted as it is.
///
/// Blue noise stretched 4:1 reaches 0.08 in one star of thousands, stretched 2:1 it stays above
/// 0.25.
const MIN_SINGULAR_VALUE: f64 = 0.1;

/// An outer triangle whose unfolded height is below this share of the spoke has no curvature to
/// compare with.
const MIN_HEIGHT_RATIO: f64 = 1e-3;

/// The faces around a vertex, unfolded into a plane: all around it, or from one border edge to the
/// other. Lengths from the vertex are kept; the angles of a closed star are scaled to make a full
/// turn.
///
/// Tensors are written in the components
///
/// ```text
/// ((k_xx + k_yy)/sqrt(2), (k_xx - k_yy)/sqrt(2), sqrt(2) k_xy)        norm and product kept
/// ```
///
/// The curvature of a star folded by `theta_e` at its inner edges is the second derivative of a
/// piecewise linear surface, tested with the hat function of the vertex:
///
/// ```text
/// kappa = 1/A sum_e (l_e/2) theta_e n_e n_e^T         n_e unit, across the edge; A a third of the faces
/// ```
///
/// positive along crests. Its trace is the cotangent Laplacian. Source: Miyoshi 1973 (moments that
/// are linear on each triangle), with the mass lumped.
///
/// # Energy
/// ```text
///       2---1           W = A D/2 ((tr kappa)^2 - 2 (1 - nu) det kappa), for the angles less their
///      / \ / \          rest values and the traceless part corrected: with t and d for the
///     3---0---6         components of kappa and of C kappa
///      \ / \ /
///       4---5           W = A D/2 ((1 + nu) t_0^2 + (1 - nu) (d_1^2 + d_2^2))
/// ```
///
/// At a border `W = A D/2 ((1 - nu^2) k_tt^2 + 2 (1 - nu) k_nt^2)` with t along it. Under a
/// compression `e` across the wave angles grow, and on equilateral triangles the energy of a given
/// height by `1.75 e` (hinges `1.33 e`).
///
/// # Traceless part
/// On a piecewise linear interpolant of curvature `c`, `kappa` is `P c`; `P` is the identity in
/// lattices of any triangle, and elsewhere only on average. With `kappa` an irregular mesh is too
/// stiff, 8 % along the long side of 2:1 triangles; with `P^-1 kappa`, which is exact on quadratic
/// surfaces, too soft. The traceless part is that of `C kappa` with `C^-1 = (P + 1)/2`, half way;
/// the trace stays that of `kappa`, which is conforming.
///
/// # Validity
/// As [`crate::response_modulus`] measures it at twelve edges per wavelength: within 3 % on blue noise
/// and on triangles stretched 2:1 in any direction, and 4:1 with the short side across the wrinkles.
/// Stretched 4:1 in other directions, 5 to 23 % too stiff. The cotangent Laplacian by itself is, on
/// obtuse triangles, by 4 to 25 %; that falls with the square of the edge, to .5 to 3 % at 36 edges. With
/// the traceless part 3 to 11 % are left there.
///
/// # Borders
/// What happens at the border edges themselves is unknown, and adds to `kappa` across them alone. A
/// free or hinged border has no moment across it, so that the curvature there costs nothing: of
/// `kappa` only the parts along the border and of torsion count, and the first with the stiffness
/// of a beam. A border that is to be clamped needs a row of faces beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct StarShape {
    area: f64,
    /// `(l_e/2A) n_e n_e^T` of each inner edge, in components.
    weights: Vec<Vector3<f64>>,
    kind: StarKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum StarKind {
    /// Closed star, with its correction `C`.
    Closed(Matrix3<f64>),
    /// Closed star of which half of the faces are mirror images, with its correction `C`.
    Mirrored(Matrix3<f64>),
    /// Open star, with the unit direction of the border.
    Open(Vector2<f64>),
}

impl StarShape {
    /// `fan` lists the faces all around the vertex, counter-clockwise, and which corner of each the
    /// vertex is. Inner edge `k` is the one at which face `k` begins.
    pub fn closed(fan: &[(RestTriangle, usize)]) -> Self {
        let area = third(fan);
        let (weights, correction) = all_around(&sides(fan), area);
        Self {
            area,
            weights,
            kind: StarKind::Closed(correction),
        }
    }

    /// `fan` lists the faces of a vertex on a plane of symmetry, counter-clockwise from one edge on the plane to the
    /// other, and which corner of each the vertex is: half of a closed star. Inner edge `k` is the one at which face
    /// `k` begins, one more the last one on the plane.
    ///
    /// Curvature is that of the closed star, of which [`Self::area`] is the whole; [`Self::rows`] give half of its
    /// energy.
    pub fn mirrored(fan: &[(RestTriangle, usize)]) -> Self {
        let area = 2.0 * third(fan);
        let own = sides(fan);
        let images = own
            .iter()
            .rev()
            .map(|&(length, aside, angle)| (aside, length, angle));
        let both: Vec<_> = own.iter().copied().chain(images).collect();
        let (mut weights, correction) = all_around(&both, area);
        // Mirror images are bent by the same angles as their originals; edges on the plane have none.
        let images = weights.split_off(fan.len() + 1);
        for (weight, image) in weights[1..fan.len()].iter_mut().zip(images.iter().rev()) {
            *weight += image;
        }
        Self {
            area,
            weights,
            kind: StarKind::Mirrored(correction),
        }
    }

    /// `fan` lists the faces of a border vertex, counter-clockwise from one border edge to the
    /// other, and which corner of each the vertex is. Inner edge `k` lies between faces `k` and
    /// `k + 1`.
    ///
    /// # Panics
    /// When `fan` is empty.
    pub fn open(fan: &[(RestTriangle, usize)]) -> Self {
        let area = third(fan);
        let points = unfolded(&sides(fan), 1.0);
        let (first, last) = (points[0], points[points.len() - 1]);
        // At its vertex the border may turn a corner. The chord between the neighbours is its mean
        // direction there.
        let along = (first - last).try_normalize(0.0).unwrap_or_else(Vector2::x);
        Self {
            area,
            // The two border edges have no angle.
            weights: weights(&points[1..points.len() - 1], area),
            kind: StarKind::Open(along),
        }
    }

    /// A third of the faces' area (m²), mirror images included.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// `C`, for components; the identity at borders.
    pub fn correction(&self) -> Matrix3<f64> {
        match self.kind {
            StarKind::Closed(correction) | StarKind::Mirrored(correction) => correction,
            StarKind::Open(_) => Matrix3::identity(),
        }
    }

    /// `kappa` in components (1/m) for the angles (rad) of the inner edges, before any correction.
    pub fn curvature(&self, angles: &[f64]) -> Vector3<f64> {
        weighted(&self.weights, angles.iter().copied())
    }

    /// A row per inner edge: the energy is half the square of the sum of bend (rad) times row, for a
    /// `stiffness` `A D` (N m³) and a Poisson ratio in (-1, 1].
    pub fn rows(&self, stiffness: f64, poisson: f64) -> Vec<Vector3<f64>> {
        let map = match self.kind {
            StarKind::Closed(correction) => plate_root(stiffness, poisson, correction),
            StarKind::Mirrored(correction) => plate_root(0.5 * stiffness, poisson, correction),
            StarKind::Open(along) => border_root(stiffness, poisson, along),
        };
        self.weights.iter().map(|weight| map * weight).collect()
    }
}

/// `A D/2 ((1 + nu) t_0^2 + (1 - nu) (d_1^2 + d_2^2))`, `t` of `kappa` and `d` of `C kappa`.
fn plate_root(stiffness: f64, poisson: f64, correction: Matrix3<f64>) -> Matrix3<f64> {
    // A root of the form, not the form itself: with the energy a sum of squares, its Gauss-Newton
    // matrix is semidefinite by construction. The trace is left as it is, because the cotangent
    // Laplacian is conforming.
    let mut map = correction;
    map.set_row(0, &Vector3::x().transpose());
    let traceless = (stiffness * (1.0 - poisson)).sqrt();
    let factors = Vector3::new((stiffness * (1.0 + poisson)).sqrt(), traceless, traceless);
    Matrix3::from_diagonal(&factors) * map
}

/// `A D/2 ((1 - nu^2) k_tt^2 + 2 (1 - nu) k_nt^2)`, t along the border: the least over `k_nn`.
fn border_root(stiffness: f64, poisson: f64, along: Vector2<f64>) -> Matrix3<f64> {
    // Components turn by twice the border's angle. Their sqrt(1/2) makes the one half in the
    // bending, and cancels the 2 of the torsion.
    let cosine = along.x * along.x - along.y * along.y;
    let sine = 2.0 * along.x * along.y;
    let bending = (0.5 * stiffness * (1.0 - poisson * poisson)).sqrt();
    let torsion = (stiffness * (1.0 - poisson)).sqrt();
    Matrix3::from_rows(&[
        Vector3::new(1.0, cosine, sine).transpose() * bending,
        Vector3::new(0.0, -sine, cosine).transpose() * torsion,
        Vector3::zeros().transpose(),
    ])
}

fn third(fan: &[(RestTriangle, usize)]) -> f64 {
    fan.iter().map(|(face, _)| face.area()).sum::<f64>() / 3.0
}

/// Weights of the inner edges between faces all around a vertex, given by their [`sides`] there, and the correction.
fn all_around(sides: &[(f64, f64, f64)], area: f64) -> (Vec<Vector3<f64>>, Matrix3<f64>) {
    let turn: f64 = sides.iter().map(|(_, _, angle)| angle).sum();
    let mut points = unfolded(sides, TAU / turn);
    // After a full turn the first comes again; the two differ in length under a rest stretch.
    if let (Some(again), Some(first)) = (points.pop(), points.first_mut()) {
        *first *= 0.5 * (1.0 + again.norm() / first.norm());
    }
    let weights = weights(&points, area);
    // A star with a flat or overturned triangle keeps its curvature as it is: the correction
    // would divide by a height that is next to nothing.
    let correction = quadratic_response(&points, &weights)
        .map_or_else(Matrix3::identity, |response| {
            inverse(0.5 * (response + Matrix3::identity()))
        });
    (weights, correction)
}

/// Lengths (m) of the two edges of every face at the vertex, counter-clockwise, and the angle between them (rad).
fn sides(fan: &[(RestTriangle, usize)]) -> Vec<(f64, f64, f64)> {
    let of_face = |(face, corner): &(RestTriangle, usize)| {
        let (length, foot, height) = face.seen_from_edge(*corner);
        let aside = Vector2::new(foot * length, height);
        (length, aside.norm(), aside.y.atan2(aside.x))
    };
    fan.iter().map(of_face).collect()
}

/// The neighbours in the plane, the first on the x axis, and one more than faces; angles are scaled.
fn unfolded(sides: &[(f64, f64, f64)], scale: f64) -> Vec<Vector2<f64>> {
    let mut points = Vec::with_capacity(sides.len() + 1);
    let mut direction = 0.0_f64;
    for (k, (length, _, angle)) in sides.iter().enumerate() {
        // Two faces differ in the length of their edge only under a rest stretch.
        let length = if k > 0 {
            0.5 * (length + sides[k - 1].1)
        } else {
            *length
        };
        let (sin, cos) = direction.sin_cos();
        points.push(Vector2::new(cos, sin) * length);
        direction += scale * angle;
    }
    let (sin, cos) = direction.sin_cos();
    points.extend(sides.last().map(|side| Vector2::new(cos, sin) * side.1));
    points
}

/// `(l/2A) n n^T` of edges from the origin, `n = (-y, x)/l`.
fn weights(points: &[Vector2<f64>], area: f64) -> Vec<Vector3<f64>> {
    points
        .iter()
        .map(|p| {
            // Components of n n^T have the length's square below; one length of the edge weight
            // cancels.
            let scale = std::f64::consts::FRAC_1_SQRT_2 / (2.0 * area * p.norm());
            Vector3::new(p.norm_squared(), p.y * p.y - p.x * p.x, -2.0 * p.x * p.y) * scale
        })
        .collect()
}

/// `P` of a closed star: columns are the curvatures of the interpolated quadratics of unit
/// curvature. None if a triangle is flat or turned over in the plane.
fn quadratic_response(points: &[Vector2<f64>], weights: &[Vector3<f64>]) -> Option<Matrix3<f64>> {
    let count = points.len();
    let mut response = Matrix3::zeros();
    for (k, (spoke, weight)) in points.iter().zip(weights).enumerate() {
        let length = spoke.norm();
        let [next, last] = [1, count - 1].map(|step| &points[(k + step) % count]);
        let mut angles = Vector3::zeros();
        for (apex, side) in [(next, 1.0), (last, -1.0)] {
            let height = side * spoke.perp(apex) / length;
            if height.is_nan() || height < MIN_HEIGHT_RATIO * length {
                return None;
            }
            angles += side_fold(spoke, apex, height);
        }
        response += weight * angles.transpose();
    }
    Some(response)
}

/// Inverse with the singular values bounded below, so that no star becomes rigid.
fn inverse(matrix: Matrix3<f64>) -> Matrix3<f64> {
    // A mean map that is nearly singular would make a mode of its star many times too stiff.
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

/// Sum of value times row.
#[inline]
pub(crate) fn weighted(rows: &[Vector3<f64>], values: impl Iterator<Item = f64>) -> Vector3<f64> {
    rows.iter()
        .zip(values)
        .map(|(row, value)| row * value)
        .sum()
}
