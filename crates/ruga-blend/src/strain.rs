//! Strains that a pose asks of the skin: principal values per face.

use nalgebra::{Matrix2, Vector2, Vector3};
use rayon::prelude::*;
use ruga_mesh::{PerFace, TriMesh, triangle_frame};

/// Faces that a thread takes at least.
const AT_ONCE: usize = 1 << 10;

/// Principal strains of one face, posed against rest, in the rest surface's metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceStrain {
    /// Right Cauchy-Green tensor in the frame of [`triangle_frame`].
    pub cauchy_green: Matrix2<f64>,
    /// Larger principal compression, `1 - stretch`; negative for tension.
    pub first: f64,
    /// Smaller principal compression.
    pub second: f64,
    /// Direction of `first` in the rest frame, unit.
    pub direction: Vector2<f64>,
}

impl FaceStrain {
    /// Principal values of a right Cauchy-Green tensor; not numbers where it holds any that is not.
    pub fn from_cauchy_green(cauchy_green: Matrix2<f64>) -> Self {
        // In closed form: to find them by iterations was a sixth of planning the poses of a head.
        let c = &cauchy_green;
        let (mean, half) = (0.5 * (c.m11 + c.m22), 0.5 * (c.m11 - c.m22));
        let shear = 0.5 * (c.m12 + c.m21);
        let radius = half.hypot(shear);
        // The smaller stretch is the larger compression. Its direction is at right angles to both rows of
        // `C - low I`; of these the longer is taken, since the other may be rounding alone.
        let direction = match half >= 0.0 {
            true => Vector2::new(-shear, half + radius),
            false => Vector2::new(radius - half, -shear),
        };
        // Rounding may leave less than 0. Not `max`, which would make full compression of a NaN.
        let stretch = |squared: f64| match squared {
            squared if squared < 0.0 => 0.0,
            squared => squared.sqrt(),
        };
        Self {
            cauchy_green,
            first: 1.0 - stretch(mean - radius),
            second: 1.0 - stretch(mean + radius),
            // Equal ones have any direction.
            direction: direction.try_normalize(0.0).unwrap_or_else(Vector2::x),
        }
    }

    /// `e1 + nu e2`: what a layer of this Poisson ratio compares with its critical strain.
    pub fn effective(&self, poisson: f64) -> f64 {
        self.first + poisson * self.second
    }
}

/// Strain of every face of `mesh`.
///
/// Faces must have an area at rest, which a [`crate::Driver`] and its base surface ensure; the strain
/// of one that has none is not a number.
///
/// # Panics
/// When there is not one rest and one posed position (m) per vertex.
pub fn face_strains(
    mesh: &TriMesh,
    rest: &[Vector3<f64>],
    posed: &[Vector3<f64>],
) -> PerFace<FaceStrain> {
    let count = mesh.vertex_count();
    assert_eq!(
        [rest.len(), posed.len()],
        [count; 2],
        "one position per vertex"
    );
    let faces = mesh.faces().as_slice().par_iter().with_min_len(AT_ONCE);
    let strains = faces.map(|face| {
        let rest = face.map(|v| rest[v.0 as usize]);
        let posed = face.map(|v| posed[v.0 as usize]);
        FaceStrain::from_cauchy_green(cauchy_green(rest, posed))
    });
    strains.collect::<Vec<_>>().into()
}

fn cauchy_green(rest: [Vector3<f64>; 3], posed: [Vector3<f64>; 3]) -> Matrix2<f64> {
    let frame = triangle_frame(&rest);
    let local = |edge: Vector3<f64>| Vector2::new(edge.dot(&frame[0]), edge.dot(&frame[1]));
    // Columns are the rest edges in the rest frame; C = shape⁻ᵀ (posed edge products) shape⁻¹.
    let shape = Matrix2::from_columns(&[local(rest[1] - rest[0]), local(rest[2] - rest[0])]);
    let inverse = shape.try_inverse().unwrap_or_else(Matrix2::zeros);
    let (u, v) = (posed[1] - posed[0], posed[2] - posed[0]);
    // Edge products of the posed triangle need no frame of it, which a triangle crushed to a line
    // would not have.
    let metric = Matrix2::new(u.dot(&u), u.dot(&v), u.dot(&v), v.dot(&v));
    inverse.transpose() * metric * inverse
}

#[cfg(test)]
mod tests {
    use nalgebra::SymmetricEigen;

    use super::*;

    /// Diagonal and full tensors, equal and very different stretches.
    #[test]
    fn principal_strains_are_those_of_the_eigenvalues() {
        let angles = (0..24).map(|i| f64::from(i) * std::f64::consts::PI / 12.0);
        // Beside the axes one of the rows that a direction is found from is rounding alone.
        let angles = angles.flat_map(|angle| [angle, angle + 1e-9, angle - 1e-9]);
        let stretches = [
            [1.0, 1.0],
            [0.8, 1.1],
            [1e-3, 2.0],
            [0.0, 1.0],
            [0.5, 0.5 + 1e-9],
        ];
        for (angle, [low, high]) in angles.flat_map(|angle| stretches.map(|pair| (angle, pair))) {
            let along = Vector2::new(angle.cos(), angle.sin());
            let across = Vector2::new(-along.y, along.x);
            let tensor = along * along.transpose() * (low * low)
                + across * across.transpose() * (high * high);
            let found = FaceStrain::from_cauchy_green(tensor);
            let values = SymmetricEigen::new(tensor).eigenvalues;
            let squares = [found.first, found.second].map(|strain| (1.0 - strain).powi(2));
            for (square, value) in squares.into_iter().zip([values.min(), values.max()]) {
                assert!((square - value).abs() < 1e-14, "{square} {value}");
            }
            assert!((found.direction.norm() - 1.0).abs() < 1e-15);
            let stretched = tensor * found.direction;
            let left = stretched - found.direction * squares[0];
            assert!(left.norm() < 1e-14, "{left}");
        }
    }
}
