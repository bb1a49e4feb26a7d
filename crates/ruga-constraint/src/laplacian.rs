//! The cotangent Laplacian with lumped mass, made symmetric.

use faer::Side;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, MatMut};
use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, TriMesh, VertexId, face_normals, vertex_areas};

use crate::ConstraintError;
use crate::rows::check_mesh;

/// Twice the area of a face over the square of its longest edge below which it has none: gradients
/// lose eight digits there.
const FLAT: f64 = 1e-8;

/// `S = M^-1/2 L M^-1/2` of a surface: `L` is the stiffness of linear elements, `M` holds a third
/// of the area of the faces around each vertex.
///
/// Symmetric, so its eigenvectors `y` are orthonormal by themselves; `M^-1/2 y` are the
/// eigenfunctions of `L f = eigenvalue M f`.
pub(crate) struct Laplacian {
    stiffness: SparseColMat<usize, f64>,
    /// Of `stiffness + shift M`.
    factor: Llt<usize, f64>,
    /// Square roots of the masses, m.
    pub(crate) root_mass: Vec<f64>,
    /// Area of the surface, m2.
    pub(crate) area: f64,
    /// Added to every eigenvalue, 1/m2: half the first one of a sphere of this area.
    pub(crate) shift: f64,
}

impl Laplacian {
    pub(crate) fn new(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Result<Self, ConstraintError> {
        check_mesh(mesh, positions)?;
        if let Some(i) = (0..mesh.vertex_count())
            .find(|&i| mesh.vertex_faces(VertexId::from_index(i)).is_empty())
        {
            let vertex = VertexId::from_index(i);
            return Err(ConstraintError::LooseVertex { vertex });
        }
        let mut entries = stiffness_entries(mesh, positions)?;
        let size = mesh.vertex_count();
        let assemble = |entries: &[Triplet<usize, usize, f64>]| {
            SparseColMat::try_new_from_triplets(size, size, entries)
                .map_err(|_| ConstraintError::NoSpectrum)
        };
        let stiffness = assemble(&entries)?;
        let masses = vertex_areas(mesh, positions);
        let area: f64 = masses.iter().sum();
        let shift = 4.0 * std::f64::consts::PI / area;
        let shifted = masses.iter().enumerate();
        entries.extend(shifted.map(|(i, mass)| Triplet::new(i, i, shift * mass)));
        let factor = assemble(&entries)?
            .sp_cholesky(Side::Lower)
            .map_err(|_| ConstraintError::NoSpectrum)?;
        Ok(Self {
            stiffness,
            factor,
            root_mass: masses.into_iter().map(f64::sqrt).collect(),
            area,
            shift,
        })
    }

    pub(crate) fn size(&self) -> usize {
        self.root_mass.len()
    }

    /// `(S + shift)^-1 vectors`: the smallest eigenvalues become the largest.
    pub(crate) fn apply_inverse(&self, mut vectors: MatMut<'_, f64>) {
        self.scale(vectors.as_mut());
        self.factor.solve_in_place(vectors.as_mut());
        self.scale(vectors);
    }

    fn scale(&self, mut vectors: MatMut<'_, f64>) {
        for column in 0..vectors.ncols() {
            for (row, scale) in self.root_mass.iter().enumerate() {
                vectors[(row, column)] *= scale;
            }
        }
    }

    /// `|S y - eigenvalue y| / (eigenvalue + shift)` for a unit vector `y`.
    pub(crate) fn residual(&self, vectors: &Mat<f64>, column: usize, eigenvalue: f64) -> f64 {
        let function = |i: usize| vectors[(i, column)] / self.root_mass[i];
        let mut image = vec![0.0; self.size()];
        for j in 0..self.size() {
            let rows = self.stiffness.row_idx_of_col(j);
            for (i, &entry) in rows.zip(self.stiffness.val_of_col(j)) {
                image[i] += entry * function(j);
            }
        }
        let error = |(i, force): (usize, &f64)| {
            force / self.root_mass[i] - eigenvalue * vectors[(i, column)]
        };
        let squared: f64 = image.iter().enumerate().map(error).map(|e| e * e).sum();
        squared.sqrt() / (eigenvalue + self.shift)
    }
}

/// `L_ij = -(cot a + cot b) / 2` over the two angles that face the edge, rows summing to zero.
fn stiffness_entries(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
) -> Result<Vec<Triplet<usize, usize, f64>>, ConstraintError> {
    let normals = face_normals(mesh, positions);
    let mut entries = Vec::with_capacity(12 * mesh.face_count());
    for (face, vertices) in mesh.faces().iter() {
        let corners = vertices.map(|v| positions[v.index()]);
        let twice_area = checked_area(face, &corners, &normals[face])?;
        for (k, corner) in corners.iter().enumerate() {
            let [i, j] = [vertices[(k + 1) % 3].index(), vertices[(k + 2) % 3].index()];
            let sides = [corners[(k + 1) % 3] - corner, corners[(k + 2) % 3] - corner];
            let half = 0.5 * sides[0].dot(&sides[1]) / twice_area;
            entries.extend([
                Triplet::new(i, i, half),
                Triplet::new(j, j, half),
                Triplet::new(i, j, -half),
                Triplet::new(j, i, -half),
            ]);
        }
    }
    Ok(entries)
}

fn checked_area(
    face: FaceId,
    [a, b, c]: &[Vector3<f64>; 3],
    normal: &Vector3<f64>,
) -> Result<f64, ConstraintError> {
    let twice_area = normal.norm();
    let longest = (b - a).norm_squared().max((c - b).norm_squared());
    if twice_area > FLAT * longest.max((a - c).norm_squared()) {
        return Ok(twice_area);
    }
    Err(ConstraintError::DegenerateFace { face })
}
