//! A sheet's energy as the solver sees it.

use nalgebra::Vector3;
use ruga_material::Wrinkling;
use ruga_shell::LayerEnergy;
use ruga_solver::{LowerPattern, Objective};

use super::links::Links;

/// Energy of the coordinates that move, less the work of a dead load.
pub(super) struct SheetObjective<'a> {
    pub(super) energy: &'a LayerEnergy,
    pub(super) links: &'a Links,
    pub(super) free: &'a [u32],
    /// Where pinned vertices are.
    pub(super) positions: &'a [Vector3<f64>],
    pub(super) pattern: LowerPattern,
    pub(super) damping: &'a [f64],
    /// Dead load, N, and where it does no work, m.
    pub(super) reaction: &'a [f64],
    pub(super) base: &'a [f64],
    pub(super) theory: &'a Wrinkling,
    pub(super) thickness: f64,
    pub(super) area: f64,
}

impl SheetObjective<'_> {
    fn all(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.to_vec();
        scatter(self.free, x, &mut positions);
        positions
    }

    fn work(&self, x: &[f64]) -> f64 {
        let displaced = x.iter().zip(self.base).map(|(x, base)| x - base);
        self.reaction
            .iter()
            .zip(displaced)
            .map(|(f, u)| f * u)
            .sum()
    }
}

impl Objective for SheetObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        let positions = self.all(x);
        self.energy.value(&positions) + self.links.value(&positions) - self.work(x)
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.all(x);
        self.energy.gradient(&positions, gradient);
        for (gradient, force) in gradient.iter_mut().zip(self.reaction) {
            *gradient -= force;
        }
        self.links.add_gradient(x, gradient);
        self.energy.value(&positions) + self.links.value(&positions) - self.work(x)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let layer = |exact: &mut [f64], relaxed: &mut [f64]| {
            self.energy.hessian(&self.all(x), exact, Some(relaxed));
        };
        self.links.hessian(layer, exact, relaxed);
    }

    fn damping(&self) -> &[f64] {
        self.damping
    }

    fn energy_scale(&self) -> f64 {
        0.5 * self.theory.membrane_stiffness * self.theory.critical_strain.powi(2) * self.area
    }

    fn force_scale(&self) -> f64 {
        self.theory.normal_stiffness * self.thickness * self.area / self.positions.len() as f64
    }

    fn length_scale(&self) -> f64 {
        self.thickness
    }
}

/// Coordinates of the free vertices.
pub(crate) fn gather(free: &[u32], positions: &[Vector3<f64>]) -> Vec<f64> {
    free.iter()
        .flat_map(|&v| {
            let p = positions[v as usize];
            [p.x, p.y, p.z]
        })
        .collect()
}

/// The reverse of [`gather`].
pub(crate) fn scatter(free: &[u32], x: &[f64], positions: &mut [Vector3<f64>]) {
    for (&v, x) in free.iter().zip(x.chunks_exact(3)) {
        positions[v as usize] = Vector3::new(x[0], x[1], x[2]);
    }
}
