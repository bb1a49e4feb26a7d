//! Strains that a pose asks of the skin: principal values per face.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use ruga_mesh::{PerFace, TriMesh, triangle_frame};

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
        let eigen = SymmetricEigen::new(cauchy_green);
        // Eigenvalues of nalgebra come in no order. The smaller stretch is the larger compression.
        let (low, high) = if eigen.eigenvalues[0] <= eigen.eigenvalues[1] {
            (0, 1)
        } else {
            (1, 0)
        };
        // Rounding may leave less than 0. Not `max`, which would make full compression of a NaN.
        let stretch = |i: usize| match eigen.eigenvalues[i] {
            squared if squared < 0.0 => 0.0,
            squared => squared.sqrt(),
        };
        Self {
            cauchy_green,
            first: 1.0 - stretch(low),
            second: 1.0 - stretch(high),
            direction: eigen.eigenvectors.column(low).into_owned(),
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
    mesh.faces()
        .as_slice()
        .iter()
        .map(|face| {
            let rest = face.map(|v| rest[v.0 as usize]);
            let posed = face.map(|v| posed[v.0 as usize]);
            FaceStrain::from_cauchy_green(cauchy_green(rest, posed))
        })
        .collect()
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
