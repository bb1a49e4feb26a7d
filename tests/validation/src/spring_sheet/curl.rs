//! Curl of a strip whose corner layer is to be shorter than the layer of its centres.

use nalgebra::Vector3;

use super::conjugate_gradient::Solver;
use super::lattice::SpringLattice;
use super::projection::{Mobility, Projection, ProjectionReport, fast_projection};
use super::spring_set::SpringError;

/// A free strip along x that projection alone is to bend, without inertia.
#[derive(Clone, Debug)]
pub struct CurlStrip {
    /// Its springs, with their target lengths.
    pub lattice: SpringLattice,
    /// Where its particles are (m).
    pub positions: Vec<Vector3<f64>>,
    /// Curvature (1/m) of the corner layer with which all springs along the strip are as long as they ought to be:
    /// corners on a radius `R`, centres on `R + t'`, and `R/(R + t') = 1 - s`. Red springs ask for `t' = (1 - s/2) t`.
    ///
    /// The same curvature is wanted across the strip, where a developable sheet cannot have it.
    pub wanted: f64,
    columns: usize,
    rows: usize,
    mobility: Mobility,
    solver: Solver,
}

impl CurlStrip {
    /// A flat strip of `[along, across]` cells of side `cell` (m), whose centres lie `thickness` (m) above its corners;
    /// the share of volume of the corners is one less `shrinkage`, so that red springs shrink by half of it.
    ///
    /// # Errors
    /// [`SpringError::Length`] when `cell` is not a length.
    pub fn new(
        [columns, rows]: [usize; 2],
        cell: f64,
        thickness: f64,
        shrinkage: f64,
    ) -> Result<Self, SpringError> {
        let (mut lattice, positions) = SpringLattice::rectangle([columns, rows], cell, thickness)?;
        let mut shares = vec![1.0; lattice.particle_count()];
        shares[..lattice.corner_count()].fill(1.0 - shrinkage);
        lattice.set_volume_shares(&shares)?;
        let shrunk = (1.0 - shrinkage) * (1.0 - 0.5 * shrinkage) * thickness;
        Ok(Self {
            lattice,
            mobility: Mobility::printed(&vec![false; positions.len()]),
            positions,
            wanted: shrinkage / shrunk,
            columns,
            rows,
            solver: Solver::default(),
        })
    }

    /// Projects from where the particles are, in the printed way.
    pub fn project(&mut self, settings: &Projection) -> ProjectionReport {
        fast_projection(
            &self.lattice,
            &self.mobility,
            settings,
            &mut self.positions,
            &mut self.solver,
        )
    }

    /// Mean curvature over that wanted: the angle through which the middle line of the corners turns, over its length.
    ///
    /// This is kind to the springs. They bend at the two ends, and a parabola through the whole strip finds a
    /// third of it or less.
    pub fn curl(&self) -> f64 {
        let edges = self.middle_edges();
        let turns = edges.windows(2).map(|pair| {
            let sine = pair[0].cross(&pair[1]).y;
            sine.atan2(pair[0].dot(&pair[1]))
        });
        // From the middle of the first edge to that of the last.
        let inner = edges.windows(2);
        let length: f64 = inner
            .map(|pair| 0.5 * (pair[0].norm() + pair[1].norm()))
            .sum();
        turns.sum::<f64>() / (length * self.wanted)
    }

    /// Steps along the strip between the means of its columns of corners.
    fn middle_edges(&self) -> Vec<Vector3<f64>> {
        let corners = self.rows + 1;
        let columns = self.positions.chunks_exact(corners).take(self.columns + 1);
        let means: Vec<Vector3<f64>> = columns
            .map(|column| column.iter().sum::<Vector3<f64>>() / corners as f64)
            .collect();
        means.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }
}
