//! Quantities read off a layer for reports.

use nalgebra::{Matrix2, Vector2, Vector3};

/// Principal engineering strains of one face; compression is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalStrain {
    /// Larger principal compression, `1 - stretch`; negative for tension.
    pub first: f64,
    /// Smaller principal compression.
    pub second: f64,
    /// Direction of `first` in the face's local rest frame, unit.
    pub direction: Vector2<f64>,
}

impl PrincipalStrain {
    /// Principal values of a Green strain `(C - I)/2`; not numbers where it holds any that is not.
    pub fn from_green(strain: &Matrix2<f64>) -> Self {
        let mean = 0.5 * strain.trace();
        let (difference, shear) = (0.5 * (strain.m11 - strain.m22), strain.m12);
        let radius = difference.hypot(shear);
        // Not `max`, which would make full compression of a NaN.
        let compression = |green: f64| match 1.0 + 2.0 * green {
            squared if squared < 0.0 => 1.0,
            squared => 1.0 - squared.sqrt(),
        };
        // The axis of the lower eigenvalue lies at a right angle to that of the higher one.
        let angle = 0.5 * shear.atan2(difference) + std::f64::consts::FRAC_PI_2;
        Self {
            first: compression(mean - radius),
            second: compression(mean + radius),
            direction: Vector2::new(angle.cos(), angle.sin()),
        }
    }
}

/// Area-weighted unit normal of each vertex; +z where a vertex has none.
pub(crate) fn vertex_normals(positions: &[Vector3<f64>], faces: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let normal = (b - a).cross(&(c - a));
        for &vertex in face {
            normals[vertex as usize] += normal;
        }
    }
    normals
        .into_iter()
        .map(|n| n.try_normalize(0.0).unwrap_or_else(Vector3::z))
        .collect()
}
