//! Normals and tangents as glTF wants them: of length 1, in the coordinates of the file.

use nalgebra::{Matrix3, Vector3, Vector4};

/// The vector in 32 bits.
pub(crate) fn single(vector: Vector3<f64>) -> [f32; 3] {
    [vector.x as f32, vector.y as f32, vector.z as f32]
}

/// The normal as it came, unless glTF would refuse its length.
pub(crate) fn unit(normal: &Vector3<f64>) -> Vector3<f64> {
    const ACCEPTED: f64 = 5e-4;
    if (normal.norm() - 1.0).abs() < ACCEPTED {
        return *normal;
    }
    normal.try_normalize(1e-30).unwrap_or_else(Vector3::z)
}

/// The tangent with the normal's part of it taken away.
///
/// Where the texture has no direction any tangent is as good, but glTF wants one of length 1.
pub(crate) fn unit_tangent(tangent: &Vector4<f64>, normal: &Vector3<f64>) -> Vector4<f64> {
    let across = tangent.xyz() - normal * normal.dot(&tangent.xyz());
    let any = || normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let finite = |v: &Vector3<f64>| v.iter().all(|c| c.is_finite());
    let along = across
        .try_normalize(1e-12)
        .filter(finite)
        .unwrap_or_else(any);
    along.push(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}

/// Turns directions on a mesh in metres into those of the file, whose coordinates were multiplied
/// by `stretch`.
pub(crate) struct FileSpace {
    stretch: Matrix3<f64>,
    unstretch: Matrix3<f64>,
    /// `None` where directions are the same.
    inverse: Option<Matrix3<f64>>,
}

impl FileSpace {
    pub(crate) fn of(stretch: &Matrix3<f64>) -> Self {
        let is_uniform = *stretch == Matrix3::from_diagonal_element(stretch[(0, 0)]);
        Self {
            stretch: *stretch,
            // A reader refuses what has none.
            unstretch: stretch.try_inverse().unwrap_or_else(Matrix3::identity),
            inverse: stretch.try_inverse().filter(|_| !is_uniform),
        }
    }

    /// A way between two points, m.
    pub(crate) fn way(&self, way: &Vector3<f64>) -> Vector3<f64> {
        self.unstretch * way
    }

    /// A normal: the inverse of how the reader turned it.
    pub(crate) fn normal(&self, normal: &Vector3<f64>) -> Vector3<f64> {
        match self.inverse {
            Some(_) => unit(&(self.stretch * normal)),
            None => *normal,
        }
    }

    /// A tangent, which lies in the surface and so follows its points.
    pub(crate) fn tangent(&self, tangent: Vector4<f64>) -> [f32; 4] {
        let along = match &self.inverse {
            Some(inverse) => unit(&(inverse * tangent.xyz())),
            None => tangent.xyz(),
        };
        let [x, y, z] = single(along);
        [x, y, z, tangent.w as f32]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_a_stretched_mesh_stay_orthogonal_in_the_file() {
        let stretch = Matrix3::new(2.0, 0.3, 0.0, 0.3, 1.0, 0.1, 0.0, 0.1, 0.5);
        let space = FileSpace::of(&stretch);
        let normal = Vector3::new(0.2, -0.5, 0.8).normalize();
        let tangent = unit_tangent(&Vector4::new(1.0, 0.4, -0.3, -2.0), &normal);
        let found = Vector4::from(space.tangent(tangent)).cast::<f64>();
        assert!((found.xyz().norm() - 1.0).abs() < 1e-6 && found.w == -1.0);
        assert!(found.xyz().dot(&space.normal(&normal)).abs() < 1e-6);
        let back = (stretch * found.xyz()).normalize();
        assert!((back - tangent.xyz()).norm() < 1e-6);
    }
}
