//! A layer's energy as the solver sees it.

use nalgebra::Vector3;
use ruga_material::Wrinkling;
use ruga_mesh::{Id, VertexId};
use ruga_solver::{LowerPattern, Objective};

use crate::motion::Inertia;
use crate::skin_energy::SkinEnergy;

/// A layer's energy as a function of the coordinates that move.
pub(crate) struct LayerObjective<'a> {
    pub(crate) energy: &'a SkinEnergy,
    pub(crate) free: &'a [VertexId],
    /// Where pinned vertices are.
    pub(crate) positions: &'a [Vector3<f64>],
    pub(crate) pattern: LowerPattern,
    pub(crate) floor: &'a [f64],
    /// Dead load, N.
    pub(crate) reaction: &'a [f64],
    /// Where the dead load does no work, m.
    pub(crate) base: &'a [f64],
    /// What a step in time adds, with the mass of every vertex, kg.
    pub(crate) inertia: Option<(&'a Inertia, &'a [f64])>,
    /// Mean area of a vertex, m².
    pub(crate) vertex_area: f64,
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

/// `w` and `c` of every coordinate that moves.
impl LayerObjective<'_> {
    fn inertia(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let of_vertex = |(inertia, masses): (&Inertia, &[f64]), v: &VertexId| {
            let weight = inertia.weight(masses[v.index()]);
            let centre = inertia.centres[v.index()];
            [centre.x, centre.y, centre.z].map(|c| (weight, c))
        };
        let free = self.inertia.into_iter();
        free.flat_map(move |inertia| self.free.iter().flat_map(move |v| of_vertex(inertia, v)))
    }

    fn inertia_energy(&self, x: &[f64]) -> f64 {
        let terms = self.inertia().zip(x);
        terms.map(|((w, c), x)| 0.5 * w * (x - c) * (x - c)).sum()
    }
}

impl Objective for LayerObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.energy.value(&self.all_positions(x)) - self.work_of_reaction(x)
            + self.inertia_energy(x)
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.all_positions(x);
        self.energy.gradient(&positions, gradient);
        for (gradient, reaction) in gradient.iter_mut().zip(self.reaction) {
            *gradient -= reaction;
        }
        for (gradient, ((w, c), x)) in gradient.iter_mut().zip(self.inertia().zip(x)) {
            *gradient += w * (x - c);
        }
        self.energy.value(&positions) - self.work_of_reaction(x) + self.inertia_energy(x)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.energy.hessian(&self.all_positions(x), exact, relaxed);
        for (column, (w, _)) in self.inertia().enumerate() {
            // A column of the lower triangle begins with its diagonal.
            let diagonal = self.pattern.column_starts()[column];
            exact[diagonal] += w;
            relaxed[diagonal] += w;
        }
    }

    fn floor(&self) -> &[f64] {
        self.floor
    }

    fn energy_scale(&self) -> f64 {
        self.energy_scale
    }

    fn force_scale(&self) -> f64 {
        self.wrinkling.normal_stiffness * self.thickness * self.vertex_area
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
