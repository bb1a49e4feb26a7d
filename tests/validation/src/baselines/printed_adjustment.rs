//! The adjustment of averaging constraints as it stands in print.

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_constraint::{ConstraintError, ConstraintSet, Kernel, Sampling, constraint_rows};
use ruga_mesh::{Id, MaterialPoint, TriMesh};

/// Li 2014, eqs. 4.4-4.8, to the letter, on a flat mesh: to every weight of the support
/// `alpha . u` is added, `u` the vertex seen from the centre, so that `sum w* u = 0`.
///
/// The target is the centre, also where a border cuts the kernel off, and the unit sum is lost
/// (.3 to .8 at borders). The product rescales weights instead, with the cut kernel's own centroid
/// as target: [`Sampling::Adjusted`]. Takes the place of [`ruga_constraint::constraint_rows`] in
/// [`Modelling::sample`](ruga_stepper::Modelling::sample).
///
/// # Errors
/// Those of [`ruga_constraint::constraint_rows`].
pub fn adjusted_as_printed(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    normals: &[Vector3<f64>],
    centres: &[MaterialPoint],
    kernels: &[Kernel],
    _sampling: Sampling,
) -> Result<ConstraintSet, ConstraintError> {
    let area = Sampling::Area;
    let mut set = constraint_rows(mesh, positions, normals, centres, kernels, area)?;
    for row in &mut set.rows {
        let place = centres[row.centre];
        let corners = mesh.faces()[place.face].map(|v| positions[v.index()]);
        let terms = corners.iter().zip(place.barycentric);
        let centre: Vector3<f64> = terms.map(|(corner, weight)| corner * weight).sum();
        let from_centre = |v: ruga_mesh::VertexId| (positions[v.index()] - centre).xy();
        let (mut squares, mut centroid) = (Matrix2::zeros(), Vector2::zeros());
        for &(v, weight) in &row.weights {
            let u = from_centre(v);
            squares += u * u.transpose();
            centroid += u * weight;
        }
        // Vertices on a line leave the weights as they are.
        let inverse = squares.try_inverse().unwrap_or_else(Matrix2::zeros);
        let alpha = -inverse * centroid;
        for (v, weight) in &mut row.weights {
            *weight += alpha.dot(&from_centre(*v));
        }
    }
    Ok(set)
}
