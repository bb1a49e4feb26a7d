//! Where the inside of a body goes when its handles move, before anything is solved.

use nalgebra::Vector3;
use ruga_lattice::LatticeEnergy;
use ruga_solver::{ConstraintRows, Kkt, LowerPattern, SolverError};

/// Levenberg damping in units of the lattice's mean stiffness.
const DAMPING: f64 = 1e-9;

/// Moves free nodes with the held ones so that the lattice, as stiff as it is now, is strained least.
///
/// Without it the elements around a handle would take up all of a step's motion, and Newton's method
/// would begin far from where it ends.
#[derive(Debug)]
pub(crate) struct Prediction {
    kkt: Kkt,
}

impl Prediction {
    pub(crate) fn new(free: &LatticeEnergy) -> Result<Self, SolverError> {
        let (starts, rows) = free.blocks().shared();
        let pattern = LowerPattern::new(starts, rows)?;
        let rows = ConstraintRows::none(pattern.size());
        Ok(Self {
            kkt: Kkt::new(&pattern, &rows, 3)?,
        })
    }

    /// Displacements of the free nodes, all others having `displacements`; `q` are all nodes (m).
    pub(crate) fn fill_in(
        &mut self,
        [all, free]: [&LatticeEnergy; 2],
        q: &[Vector3<f64>],
        displacements: &mut [Vector3<f64>],
    ) -> Result<(), SolverError> {
        // This one is positive semidefinite. The exact Hessian of compressed material may have no
        // minimum, and no state to predict.
        let relaxed_hessian = |energy: &LatticeEnergy| {
            let mut exact = vec![0.0; energy.pattern().1.len()];
            let mut relaxed = exact.clone();
            energy.hessian(q, &mut exact, Some(&mut relaxed));
            relaxed
        };
        // The held nodes' displacements are known. What they pull at the free ones goes to the
        // right side.
        let pull = all.blocks().product(&relaxed_hessian(all), displacements);
        let force: Vec<f64> = free.unknowns(&pull).iter().map(|f| -f).collect();
        let hessian = relaxed_hessian(free);
        let diagonal = free.pattern().0.iter().take(free.dof_count());
        let mean = diagonal.map(|&k| hessian[k]).sum::<f64>() / free.dof_count().max(1) as f64;
        let damping = vec![DAMPING * mean; free.dof_count()];
        self.kkt.factorize(&hessian, &damping)?;
        let mut step = vec![0.0; force.len()];
        self.kkt.solve(&force, &[], &mut step, &mut [])?;
        free.set_unknowns(&step, displacements);
        Ok(())
    }
}
