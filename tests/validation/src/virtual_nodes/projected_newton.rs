//! The paper's quasistatic way: Newton steps of the cut mesh, after each of which the cut is pushed shut.

use nalgebra::{DMatrix, DVector, MatrixXx3, RowVector3, Vector3};
use ruga_shell::LayerEnergy;

use super::VirtualNodes;
use super::cut_cloth::effective_mass;

/// One step of [`projected_newton`].
#[derive(Clone, Copy, Debug)]
pub struct Projected {
    /// Energy after it (J).
    pub energy: f64,
    /// Length of the Newton step before the push, its largest coordinate (m).
    pub step: f64,
    /// Largest distance between the sides of the cut (m).
    pub gap: f64,
}

/// Takes Newton steps without rows and then moves the nodes by pushes `P`, `dX = M^-1 H^T P`, that close the cut (the
/// paper's equations 8 and 10).
///
/// Where this rests, Newton's step `K^-1 f` is in the range of `M^-1 H^T`. In an equilibrium the force `f` is in
/// that of `H^T`: another place. As a filter inside conjugate gradients the same projection would be right; the
/// paper does not say which it is.
///
/// # Panics
/// When a node is held, or the energy's Hessian is singular without rows.
pub fn projected_newton(
    (energy, cut): (&LayerEnergy, &VirtualNodes),
    masses: &[f64],
    positions: &mut [Vector3<f64>],
    steps: usize,
) -> Vec<Projected> {
    assert_eq!(energy.free_vertices().len(), positions.len(), "none held");
    let factor = effective_mass(&cut.rows, masses)
        .cholesky()
        .expect("independent rows");
    let mut done = Vec::with_capacity(steps);
    for _ in 0..steps {
        let step = newton_step(energy, positions);
        for (x, step) in positions.iter_mut().zip(step.as_slice().chunks_exact(3)) {
            *x += Vector3::from_column_slice(step);
        }
        let gaps = cut.rows.iter().map(|terms| {
            let terms = terms.iter();
            let gap = terms.map(|&(node, w)| positions[node as usize].transpose() * w);
            gap.sum::<RowVector3<f64>>()
        });
        let pushes = factor.solve(&MatrixXx3::from_rows(&gaps.collect::<Vec<_>>()));
        for (terms, push) in cut.rows.iter().zip(pushes.row_iter()) {
            for &(node, weight) in terms {
                let share = weight / masses[node as usize];
                positions[node as usize] -= push.transpose() * share;
            }
        }
        done.push(Projected {
            energy: energy.value(positions),
            step: step.amax(),
            gap: cut.gap(positions),
        });
    }
    done
}

/// `-K^-1 g`, by a dense factorisation: this is for small meshes.
fn newton_step(energy: &LayerEnergy, positions: &[Vector3<f64>]) -> DVector<f64> {
    let size = energy.dof_count();
    let (starts, rows) = energy.pattern();
    let mut values = vec![0.0; rows.len()];
    energy.hessian(positions, &mut values, None);
    let mut matrix = DMatrix::zeros(size, size);
    for column in 0..size {
        for entry in starts[column]..starts[column + 1] {
            let row = rows[entry] as usize;
            matrix[(row, column)] = values[entry];
            matrix[(column, row)] = values[entry];
        }
    }
    let mut slope = vec![0.0; size];
    energy.gradient(positions, &mut slope);
    let factor = matrix.lu();
    let step = factor.solve(&DVector::from_vec(slope));
    -step.expect("a Hessian that can be factorised")
}
