//! A layer's energy as the solver sees it.

use nalgebra::Vector3;
use ruga_material::Wrinkling;
use ruga_mesh::{Id, VertexId};
use ruga_shell::LayerEnergy;
use ruga_solver::{LowerPattern, Objective};

/// A layer's energy as a function of the coordinates that move.
pub(crate) struct LayerObjective<'a> {
    pub(crate) energy: &'a LayerEnergy,
    pub(crate) free: &'a [VertexId],
    /// Where pinned vertices are.
    pub(crate) positions: &'a [Vector3<f64>],
    pub(crate) pattern: LowerPattern,
    pub(crate) floor: &'a [f64],
    /// Dead load, N.
    pub(crate) reaction: &'a [f64],
    /// Where the dead load does no work, m.
    pub(crate) base: &'a [f64],
    pub(crate) area: f64,
    /// Energy that wrinkling is about, J.
    pub(crate) energy_scale: f64,
    pub(crate) wrinkling: &'a Wrinkling,
    pub(crate) thickness: f64,
}

impl LayerObjective<'_> {
    fn all_positions(&self, unknowns: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.to_vec();
        scatter(self.free, unknowns, &mut positions);
        positions
    }

    /// Work of the dead load since the layer lay on the surface below, J.
    fn work_of_reaction(&self, x: &[f64]) -> f64 {
        self.reaction
            .iter()
            .zip(x)
            .zip(self.base)
            .map(|((force, x), base)| force * (x - base))
            .sum()
    }
}

impl Objective for LayerObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.energy.value(&self.all_positions(x)) - self.work_of_reaction(x)
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.all_positions(x);
        self.energy.gradient(&positions, gradient);
        for (gradient, reaction) in gradient.iter_mut().zip(self.reaction) {
            *gradient -= reaction;
        }
        self.energy.value(&positions) - self.work_of_reaction(x)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.energy
            .hessian(&self.all_positions(x), exact, Some(relaxed));
    }

    fn floor(&self) -> &[f64] {
        self.floor
    }

    fn energy_scale(&self) -> f64 {
        self.energy_scale
    }

    fn force_scale(&self) -> f64 {
        let per_vertex = self.area / self.positions.len().max(1) as f64;
        self.wrinkling.normal_stiffness * self.thickness * per_vertex
    }

    fn length_scale(&self) -> f64 {
        self.thickness
    }
}

/// Coordinates of the vertices that move, one after the other.
pub(crate) fn gather(free: &[VertexId], positions: &[Vector3<f64>]) -> Vec<f64> {
    free.iter()
        .flat_map(|v| {
            let p = positions[v.index()];
            [p.x, p.y, p.z]
        })
        .collect()
}

/// Puts the coordinates that move back among all positions.
pub(crate) fn scatter(free: &[VertexId], unknowns: &[f64], positions: &mut [Vector3<f64>]) {
    for (v, x) in free.iter().zip(unknowns.chunks_exact(3)) {
        positions[v.index()] = Vector3::new(x[0], x[1], x[2]);
    }
}
