//! A local polynomial through a vertex and its neighbours, and the normal it gives.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::tangent_frames::any_orthogonal;

/// Monomials without the constant: `a, b, a², ab, b², a³, a²b, ab², b³`.
const TERMS: usize = 9;

/// Columns of the right-hand side: layer (3), foot points (3), height (1).
const COLUMNS: usize = 7;

/// One neighbour of a vertex: everything relative to the vertex itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Driver position, m.
    pub driver: Vector3<f64>,
    /// Cosine between the two driver normals.
    pub facing: f64,
    /// Layer position, m.
    pub layer: Vector3<f64>,
    /// Foot point, m.
    pub foot: Vector3<f64>,
    /// Wrinkle height, m.
    pub height: f64,
}

/// A unit normal with its derivative along the two axes of the tangent plane (1/m).
#[derive(Debug, Clone, Copy)]
pub(crate) struct FittedNormal {
    pub normal: Vector3<f64>,
    pub derivative: [Vector3<f64>; 2],
    /// Area seen along the driver's normal over that of the driver, negative where the surface has turned over.
    pub upright_area: f64,
}

impl FittedNormal {
    /// How far the fit is to be trusted, 0 to 1: not at all where the surface is so steep that there is hardly an
    /// area to fit, or turned over.
    pub(crate) fn reliability(&self) -> f64 {
        // Between the two a blend, so that a steep wave has no step.
        const NONE: f64 = 0.1;
        const FULL: f64 = 0.3;
        ((self.upright_area - NONE) / (FULL - NONE)).clamp(0.0, 1.0)
    }

    /// This share of the fit, and the rest of `other`.
    pub(crate) fn blended(&self, share: f64, other: &Self) -> Self {
        let blend = |own: Vector3<f64>, other: Vector3<f64>| own * share + other * (1.0 - share);
        Self {
            // Half of each may be opposite.
            normal: blend(self.normal, other.normal)
                .try_normalize(1e-9)
                .unwrap_or(other.normal),
            derivative: [0, 1].map(|axis| blend(self.derivative[axis], other.derivative[axis])),
            ..*self
        }
    }
}

/// The fit at one vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceFit {
    /// Orthonormal axes of the driver's tangent plane.
    pub axes: [Vector3<f64>; 2],
    pub layer: FittedNormal,
    pub foot: FittedNormal,
    /// Derivative of the wrinkle height along the axes, dimensionless.
    pub height_slope: [f64; 2],
}

/// Fits layer, foot points and height as cubic functions of the driver's tangent plane.
///
/// `x(a, b) = x_0 + sum_k c_k m_k(a, b)` with `(a, b)` the driver position in the plane orthogonal
/// to `normal`, least squares over `samples`, exact at the vertex. The driver's plane is the
/// parameter, not the layer's own, because a buckled sheet is smooth in its material coordinates
/// even where it overhangs; and because layer and foot points then share matrix and weights, so
/// that equal data give equal normals. With fewer than 9 or 5 samples the degree falls to 2 or 1.
///
/// # Validity
/// Where the driver's neighbours are collinear or coincide the normal is `normal` itself.
pub(crate) fn fit_surface(normal: &Vector3<f64>, samples: &[Sample]) -> SurfaceFit {
    let u = any_orthogonal(normal);
    let axes = [u, normal.cross(&u)];
    // In units of this radius neither the condition nor the ridge depends on how fine the mesh is.
    let scale = plane_radius(&axes, samples);
    let c = solve(&axes, scale, samples);

    let first = |row: usize, column: usize| c.fixed_view::<1, 3>(row, column).transpose() / scale;
    let second = |row: usize, column: usize| first(row, column) / scale;
    let surface = |column: usize| {
        fitted_normal(
            normal,
            [first(0, column), first(1, column)],
            [
                2.0 * second(2, column),
                second(3, column),
                2.0 * second(4, column),
            ],
        )
    };
    SurfaceFit {
        axes,
        layer: surface(0),
        foot: surface(3),
        height_slope: [c[(0, 6)] / scale, c[(1, 6)] / scale],
    }
}

/// Root mean square distance of the samples in the plane, m; 1 when they all coincide.
fn plane_radius(axes: &[Vector3<f64>; 2], samples: &[Sample]) -> f64 {
    let sum: f64 = samples
        .iter()
        .map(|s| axes[0].dot(&s.driver).powi(2) + axes[1].dot(&s.driver).powi(2))
        .sum();
    let radius = (sum / samples.len().max(1) as f64).sqrt();
    if radius > 0.0 { radius } else { 1.0 }
}

/// Coefficients of the monomials, in units of the scaled plane.
fn solve(axes: &[Vector3<f64>; 2], scale: f64, samples: &[Sample]) -> SMatrix<f64, TERMS, COLUMNS> {
    let used = match samples.len() {
        0..5 => 2,
        5..9 => 5,
        _ => TERMS,
    };
    let mut matrix = SMatrix::<f64, TERMS, TERMS>::zeros();
    let mut right = SMatrix::<f64, TERMS, COLUMNS>::zeros();
    for sample in samples {
        let a = axes[0].dot(&sample.driver) / scale;
        let b = axes[1].dot(&sample.driver) / scale;
        // Terms that too few samples leave out are zero here and get a one on the diagonal below:
        // their coefficients are zero, and one factorisation serves all degrees.
        let mut row = monomials(a, b);
        row.rows_mut(used, TERMS - used).fill(0.0);
        let weighted = row * weight(a, b, sample.facing);
        let values = values(sample);
        matrix += weighted * row.transpose();
        right += weighted * values.transpose();
    }
    // Decides what the data leave open (collinear neighbours, the one-sided cubic of a border)
    // without being felt where they decide.
    const RIDGE: f64 = 1e-9;
    for term in 0..TERMS {
        matrix[(term, term)] += if term < used { RIDGE } else { 1.0 };
    }
    match matrix.cholesky() {
        Some(factor) => factor.solve(&right),
        // Without derivatives the normal falls back to the driver's.
        None => SMatrix::zeros(),
    }
}

fn monomials(a: f64, b: f64) -> SVector<f64, TERMS> {
    SVector::from([
        a,
        b,
        a * a,
        a * b,
        b * b,
        a * a * a,
        a * a * b,
        a * b * b,
        b * b * b,
    ])
}

/// Near samples count most: the polynomial must be right at the vertex, not on average. Samples
/// whose driver faces elsewhere (across a fold of the driver) count less, and nothing beyond 90
/// degrees.
fn weight(a: f64, b: f64, facing: f64) -> f64 {
    // The constant keeps a sample close by from deciding alone.
    let near = 1.0 / (0.1 + a * a + b * b);
    near * near * facing.max(0.0)
}

fn values(sample: &Sample) -> SVector<f64, COLUMNS> {
    let Sample {
        layer,
        foot,
        height,
        ..
    } = sample;
    SVector::from([layer.x, layer.y, layer.z, foot.x, foot.y, foot.z, *height])
}

/// The normal `x_a × x_b` and its derivative from first and second derivatives of the surface.
fn fitted_normal(
    driver_normal: &Vector3<f64>,
    [xa, xb]: [Vector3<f64>; 2],
    [xaa, xab, xbb]: [Vector3<f64>; 3],
) -> FittedNormal {
    // Below this the sheet is crushed to a line and its normal is noise.
    const MIN_AREA_RATIO: f64 = 1e-6;
    // Metres per metre: the length is the ratio of the layer's area to the driver's.
    let m = xa.cross(&xb);
    let length = m.norm();
    if length <= MIN_AREA_RATIO {
        return FittedNormal {
            normal: *driver_normal,
            derivative: [Vector3::zeros(); 2],
            upright_area: 0.0,
        };
    }
    let normal = m / length;
    let derivative = [
        xaa.cross(&xb) + xa.cross(&xab),
        xab.cross(&xb) + xa.cross(&xbb),
    ]
    .map(|dm| (dm - normal * normal.dot(&dm)) / length);
    FittedNormal {
        normal,
        derivative,
        upright_area: m.dot(driver_normal),
    }
}
