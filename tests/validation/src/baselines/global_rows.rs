//! Constraint rows of the whole surface: its lowest eigenfunctions.

use std::f64::consts::PI;

use faer::{Mat, Side};
use nalgebra::Vector3;
use ruga_constraint::{ConstraintError, ConstraintRow, ConstraintSet, Kernel, Order, Sampling};
use ruga_mesh::{Id, MaterialPoint, TriMesh, VertexId, face_normals, vertex_areas};

/// Wavelength, in wavelengths of the layer, from which on global rows hold everything.
const CUT: f64 = 1.25;

/// The lowest eigenfunctions of the surface's Laplacian as rows, in place of averages around
/// centres: Rémillard and Kry 2013, section 3.2.
///
/// The functions are global and the rows dense, so that a wrinkle anywhere is answered by ripples
/// everywhere (their figure 3). There are as many as there are waves longer than five quarters of
/// the layer's wavelength, `A k^2 / (4 pi)` by Weyl's law; the wavelength is that of the first of
/// the `kernels`, which are [`Kernel::alone`].
///
/// Takes the place of [`ruga_constraint::constraint_rows`] in
/// [`Modelling::sample`](ruga_stepper::Modelling::sample) beside `Coupling::Constraint`.
///
/// For layers on bodies: one on a driver, whose border is pinned, drops all rows but the first.
///
/// # Errors
/// [`ConstraintError::EmptyRegion`] without kernels.
///
/// # Panics
/// When a face has no area or a vertex no face.
pub fn global_rows(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    _normals: &[Vector3<f64>],
    _centres: &[MaterialPoint],
    kernels: &[Kernel],
    _sampling: Sampling,
) -> Result<ConstraintSet, ConstraintError> {
    let kernel = kernels.first().ok_or(ConstraintError::EmptyRegion)?;
    let area: f64 = vertex_areas(mesh, positions).iter().sum();
    let cut = CUT * PI * kernel.sigma;
    let count = (PI * area / (cut * cut)).ceil().max(1.0) as usize;
    let functions = lowest_eigenfunctions(mesh, positions, count.min(mesh.vertex_count()));
    let row = |(centre, (_, weights)): (usize, (f64, Vec<f64>))| ConstraintRow {
        centre,
        weights: (0..mesh.vertex_count())
            .map(VertexId::from_index)
            .zip(weights)
            .collect(),
        order: Order::Constant,
    };
    Ok(ConstraintSet {
        rows: functions.into_iter().enumerate().map(row).collect(),
        ..ConstraintSet::default()
    })
}

/// Eigenvalues (1/m2), ascending, and functions of `L f = eigenvalue M f`, as weights
/// `m_v f_v / A` that sum to one for the first, constant function and to zero for others.
///
/// `L` is the stiffness of linear elements (cotangents), `M` holds a third of the area of the faces
/// around each vertex; functions are orthonormal in the mean over the surface. All eigenfunctions
/// of the dense `M^-1/2 L M^-1/2` are computed, which takes seconds for two thousand vertices.
///
/// # Panics
/// As [`global_rows`].
pub fn lowest_eigenfunctions(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    count: usize,
) -> Vec<(f64, Vec<f64>)> {
    let masses = vertex_areas(mesh, positions);
    let area: f64 = masses.iter().sum();
    let normals = face_normals(mesh, positions);
    let mut symmetric = Mat::<f64>::zeros(masses.len(), masses.len());
    for (face, vertices) in mesh.faces().iter() {
        let corners = vertices.map(|v| positions[v.index()]);
        for k in 0..3 {
            let [i, j] = [1, 2].map(|next| (k + next) % 3);
            let sides = [i, j].map(|other| corners[other] - corners[k]);
            let half = 0.5 * sides[0].dot(&sides[1]) / normals[face].norm();
            let [i, j] = [i, j].map(|corner| vertices[corner].index());
            let off = half / (masses[i] * masses[j]).sqrt();
            symmetric[(i, i)] += half / masses[i];
            symmetric[(j, j)] += half / masses[j];
            symmetric[(i, j)] -= off;
            symmetric[(j, i)] -= off;
        }
    }
    let found = symmetric.self_adjoint_eigen(Side::Lower);
    let found = found.expect("a mesh whose faces have areas");
    let weights = |function: usize| {
        let column = found.U().col(function);
        let sum: f64 = (0..masses.len())
            .map(|v| masses[v].sqrt() * column[v])
            .sum();
        let sign = if function == 0 { sum.signum() } else { 1.0 };
        let weight = |v: usize| sign * masses[v].sqrt() * column[v] / area.sqrt();
        (0..masses.len()).map(weight).collect()
    };
    (0..count)
        .map(|function| (found.S()[function], weights(function)))
        .collect()
}
