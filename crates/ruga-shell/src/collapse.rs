//! The resistance of a face to losing its area.

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector2, Vector3};

/// Share of a face's stress-free area below which it resists.
const LEAST_AREA: f64 = 0.4;

/// Stress at which a face would have no area, over `E h/(1 - nu^2)`: fifteen times what a St.
/// Venant-Kirchhoff membrane resists at most. Finite, because a driver may fold faces to nothing whose
/// vertices a layer cannot move.
const STRENGTH: f64 = 3.0;

/// State of a face whose area `J`, over its rest area, is below `J_0`: `W = s A C (J_0 - J)^3 / (3 J_0^2)`, with
/// `s` = [`STRENGTH`] and `J_0` = [`LEAST_AREA`] times the area ratio where it is free of stress.
///
/// Green's strain gives way beyond 42 % of compression. Without this a triangle at the root of a fold
/// collapses, its edges then bend to any angle at no cost, and no equilibrium is found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collapse {
    /// `W` (J).
    value: f64,
    /// First derivative of `W` by `J` (J).
    slope: f64,
    /// Second derivative of `W` by `J` (J).
    curvature: f64,
    /// Derivative of `J` by the deformation gradient.
    cofactor: Matrix3x2<f64>,
    /// Derivative of `J^2 / 2` by Green's strain, `adj(F^T F)`.
    adjugate: Matrix2<f64>,
    normal: Vector3<f64>,
    area_ratio: f64,
}

impl Collapse {
    /// The state of a face with the deformation gradient `deformation`, `stiffness` `A C` (J), and
    /// `natural` times its rest area where it is free of stress; `None` for one that is large enough.
    #[inline]
    pub(crate) fn new(deformation: &Matrix3x2<f64>, stiffness: f64, natural: f64) -> Option<Self> {
        let (along, aside) = (deformation.column(0), deformation.column(1));
        let least = LEAST_AREA * natural;
        let cross = along.cross(&aside);
        let area_ratio = cross.norm();
        // Also where a natural strain leaves no area at all.
        if area_ratio >= least || least == 0.0 {
            return None;
        }
        let metric = deformation.tr_mul(deformation);
        // A face on a line has no normal, and nothing says to which side it should open.
        let normal = cross / area_ratio.max(f64::MIN_POSITIVE);
        let missing = least - area_ratio;
        let unit = STRENGTH * stiffness / (least * least);
        Some(Self {
            slope: -unit * missing * missing,
            curvature: 2.0 * unit * missing,
            value: unit * missing.powi(3) / 3.0,
            cofactor: Matrix3x2::from_columns(&[aside.cross(&normal), normal.cross(&along)]),
            adjugate: Matrix2::new(metric.m22, -metric.m12, -metric.m21, metric.m11),
            normal,
            area_ratio,
        })
    }

    /// Energy (J).
    pub(crate) fn value(&self) -> f64 {
        self.value
    }

    /// Derivative of the energy by the deformation gradient (J).
    pub(crate) fn stress(&self) -> Matrix3x2<f64> {
        self.slope * self.cofactor
    }

    /// Second derivative of the energy (N/m) by the corners with shape gradients `a` and `b` (1/m);
    /// without the part that goes with the pressure unless `with_pressure`.
    pub(crate) fn block(
        &self,
        a: &Vector2<f64>,
        b: &Vector2<f64>,
        with_pressure: bool,
    ) -> Matrix3<f64> {
        let square = self.curvature * (self.cofactor * a) * (self.cofactor * b).transpose();
        if !with_pressure || self.area_ratio == 0.0 {
            return square;
        }
        // How the area grows when the face tilts, and how its normal does when it stretches.
        let tilt = a.dot(&(self.adjugate * b)) / self.area_ratio;
        let turn = a.perp(b) * self.normal.cross_matrix();
        square + self.slope * (tilt * self.normal * self.normal.transpose() - turn)
    }
}
