//! A loaded lattice as an objective of the solver.

use nalgebra::Vector3;
use ruga_solver::{LowerPattern, Objective};

use crate::error::check_length;
use crate::{LatticeEnergy, LatticeError};

/// Elastic energy of a lattice less the work of dead loads on its nodes, which
/// [`ruga_solver::minimise`] takes: its unknowns are the coordinates of the free nodes.
///
/// ```text
/// E(q) = E_q(q) - sum_i f_i . q_i
/// ```
pub struct LatticeObjective<'a> {
    energy: &'a LatticeEnergy,
    pattern: LowerPattern,
    /// Node positions, of which those of pinned nodes are read, m.
    nodes: Vec<Vector3<f64>>,
    /// Load on every unknown, N.
    load: Vec<f64>,
    /// Scales of force (N) and length (m).
    force: f64,
    length: f64,
}

impl<'a> LatticeObjective<'a> {
    /// Loads the nodes by `load` (N); pinned nodes stay at their places in `nodes` (m).
    ///
    /// Residuals are compared with the mean force on a loaded node, lengths with `length` (m),
    /// the smallest that matters.
    ///
    /// # Errors
    /// [`LatticeError::Length`] when there is not one load and one position per node.
    ///
    /// # Panics
    /// When all nodes are pinned.
    pub fn new(
        energy: &'a LatticeEnergy,
        nodes: &[Vector3<f64>],
        load: &[Vector3<f64>],
        length: f64,
    ) -> Result<Self, LatticeError> {
        let count = energy.blocks().point_count();
        check_length("nodes", count, nodes.len())?;
        check_length("load", count, load.len())?;
        let (starts, rows) = energy.blocks().shared();
        let pattern = LowerPattern::new(starts, rows);
        let forces = load.iter().map(Vector3::norm).filter(|force| *force > 0.0);
        let mean = forces.clone().sum::<f64>() / forces.count() as f64;
        Ok(Self {
            energy,
            pattern: pattern.expect("a lattice with free nodes"),
            nodes: nodes.to_vec(),
            load: energy.unknowns(load),
            // Without a load there is no force to compare with, and a scale must not be zero.
            force: if mean > 0.0 { mean } else { 1.0 },
            length,
        })
    }

    /// Positions of all nodes with the free ones at `x`, m.
    pub fn nodes(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let mut nodes = self.nodes.clone();
        self.energy.set_unknowns(x, &mut nodes);
        nodes
    }
}

impl Objective for LatticeObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        let work: f64 = self.load.iter().zip(x).map(|(f, x)| f * x).sum();
        self.energy.value(&self.nodes(x)) - work
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.energy.gradient(&self.nodes(x), gradient);
        for (gradient, load) in gradient.iter_mut().zip(&self.load) {
            *gradient -= load;
        }
        self.value(x)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.energy.hessian(&self.nodes(x), exact, Some(relaxed));
    }

    fn energy_scale(&self) -> f64 {
        self.force * self.length
    }

    fn force_scale(&self) -> f64 {
        self.force
    }

    fn length_scale(&self) -> f64 {
        self.length
    }
}
