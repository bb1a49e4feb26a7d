//! Position and derivatives of a surface at one point, with the normal and curvature in them.

use nalgebra::{Matrix2, Matrix3, Vector3};

/// Position and first derivatives of a surface at one point, by two parameters `u, v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentPlane {
    /// Position (m).
    pub position: Vector3<f64>,
    /// Derivatives by `u` and `v`; their cross product points outwards.
    pub first: [Vector3<f64>; 2],
}

/// Position, first and second derivatives of a surface at one point, by two parameters `u, v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceJet {
    /// Position (m).
    pub position: Vector3<f64>,
    /// Derivatives by `u` and `v`; their cross product points outwards.
    pub first: [Vector3<f64>; 2],
    /// Derivatives by `uu`, `uv` and `vv`.
    pub second: [Vector3<f64>; 3],
}

/// Sine of the angle between the first derivatives under which they span no plane.
const LEAST_SINE: f64 = 1e-12;

impl TangentPlane {
    /// The outward unit normal; `None` where the first derivatives span no plane.
    pub fn normal(&self) -> Option<Vector3<f64>> {
        let [u, v] = self.first;
        let size = u.norm() * v.norm();
        let normal = u.cross(&v);
        // A sine, not a length: next to irregular vertices the derivatives tend to zero or infinity
        // and still span the tangent plane.
        (size > 0.0 && normal.norm() > LEAST_SINE * size).then(|| normal.normalize())
    }
}

impl SurfaceJet {
    /// The outward unit normal; `None` where the first derivatives span no plane.
    pub fn normal(&self) -> Option<Vector3<f64>> {
        let (position, first) = (self.position, self.first);
        TangentPlane { position, first }.normal()
    }

    /// The shape operator `S` as a symmetric tensor, 1/m: `dn = S dx` for a step `dx` on the surface.
    ///
    /// Its eigenvalues are the principal curvatures and zero along the normal. They are positive
    /// where the surface is convex seen from outside: a sphere of radius R with outward normals has
    /// `1/R` twice. In the parameters, `S = - sum x^i (n . x_ij) x^j` with `x^i` the dual basis of
    /// the first derivatives. `None` where there is no normal.
    pub fn shape_operator(&self) -> Option<Matrix3<f64>> {
        let normal = self.normal()?;
        let [u, v] = self.first;
        let area = u.cross(&v).norm();
        // The dual basis, since the parameters need not be orthogonal or of unit speed.
        let duals = [v.cross(&normal) / area, normal.cross(&u) / area];
        let [uu, uv, vv] = self.second.map(|s| -normal.dot(&s));
        let product = |i: usize, j: usize| duals[i] * duals[j].transpose();
        let mixed = product(0, 1);
        Some(product(0, 0) * uu + (mixed + mixed.transpose()) * uv + product(1, 1) * vv)
    }

    /// The shape operator's components in two orthonormal tangents, 1/m.
    ///
    /// The sign is that of [`SurfaceJet::shape_operator`]; [`crate::tangent_frame`] makes a frame.
    pub fn shape_operator_in(&self, frame: &[Vector3<f64>; 2]) -> Option<Matrix2<f64>> {
        let tensor = self.shape_operator()?;
        Some(Matrix2::from_fn(|i, j| frame[i].dot(&(tensor * frame[j]))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cylinder_seen_in_slanted_parameters_has_its_curvature() {
        // x = (R cos t, R sin t, z) with t = u + 0.3 v, z = 0.2 u + 0.7 v, at t = 0.
        let radius = 0.25;
        let curve = |a: f64, b: f64| Vector3::new(-radius * a * b, 0.0, 0.0);
        let jet = SurfaceJet {
            position: Vector3::new(radius, 0.0, 0.0),
            first: [
                Vector3::new(0.0, radius, 0.2),
                Vector3::new(0.0, 0.3 * radius, 0.7),
            ],
            second: [curve(1.0, 1.0), curve(1.0, 0.3), curve(0.3, 0.3)],
        };
        let tensor = jet.shape_operator().expect("a normal");
        let wanted = Matrix3::from_diagonal(&Vector3::new(0.0, 1.0 / radius, 0.0));
        assert!((tensor - wanted).amax() < 1e-14, "{tensor}");
        let frame = [Vector3::z(), -Vector3::y()];
        let plane = jet.shape_operator_in(&frame).expect("a normal");
        assert!((plane - Matrix2::new(0.0, 0.0, 0.0, 4.0)).amax() < 1e-14);
    }

    #[test]
    fn parallel_or_zero_derivatives_have_no_normal() {
        let mut jet = SurfaceJet {
            position: Vector3::zeros(),
            first: [Vector3::x(), Vector3::x() * 3.0],
            second: [Vector3::z(); 3],
        };
        assert_eq!(jet.normal(), None);
        jet.first[1] = Vector3::zeros();
        assert_eq!(jet.shape_operator(), None);
    }
}
