//! The energy of a layer, and of a body that moves with it, as the solver sees it.

use nalgebra::Vector3;
use ruga_material::Wrinkling;
use ruga_mesh::{Id, VertexId};
use ruga_solver::{LowerPattern, Objective};

use crate::support::motion::Inertia;
use crate::support::{Frozen, Solid};
use ruga_shell::LayerEnergy;

/// The energy as a function of the coordinates that move: those of the layer's free vertices, then those
/// of the free nodes of the body below, where there is one.
pub(crate) struct LayerObjective<'a> {
    pub(crate) energy: &'a LayerEnergy,
    pub(crate) free: &'a [VertexId],
    /// Positions of all vertices, of which only the pinned ones are read, m.
    pub(crate) positions: &'a [Vector3<f64>],
    pub(crate) pattern: LowerPattern,
    /// Levenberg damping, N/m.
    pub(crate) damping: &'a [f64],
    /// Dead load, N.
    pub(crate) reaction: &'a [f64],
    /// Positions at which the dead load does no work, m.
    pub(crate) base: &'a [f64],
    /// The term of a step in time, with the mass of every vertex, kg; a body has the mass of its layer.
    pub(crate) inertia: Option<(&'a Inertia, &'a [f64])>,
    /// The body that moves with the layer.
    pub(crate) solid: Option<(&'a Solid, Frozen)>,
    /// Mean area of a vertex, m².
    pub(crate) vertex_area: f64,
    /// Energy that wrinkling is about, J.
    pub(crate) energy_scale: f64,
    pub(crate) wrinkling: &'a Wrinkling,
    pub(crate) thickness: f64,
}

impl LayerObjective<'_> {
    /// Unknowns of the layer itself.
    fn own(&self) -> usize {
        3 * self.free.len()
    }

    fn all_positions(&self, own: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.to_vec();
        scatter(self.free, own, &mut positions);
        positions
    }

    /// Dead load and inertia of the layer's free vertices, J.
    fn loads(&self, own: &[f64]) -> f64 {
        let work = work([self.reaction, self.base], own);
        let terms = self.inertia().zip(own);
        let kinetic: f64 = terms.map(|((w, c), x)| 0.5 * w * (x - c) * (x - c)).sum();
        // A dead load lowers the energy by its work.
        kinetic - work
    }

    /// `w` and `c` of every coordinate of the layer that moves.
    fn inertia(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let of_vertex = |(inertia, masses): (&Inertia, &[f64]), v: &VertexId| {
            let weight = inertia.weight(masses[v.index()]);
            let centre = inertia.centres[v.index()];
            [centre.x, centre.y, centre.z].map(|c| (weight, c))
        };
        let free = self.inertia.into_iter();
        free.flat_map(move |inertia| self.free.iter().flat_map(move |v| of_vertex(inertia, v)))
    }
}

impl Objective for LayerObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, unknowns: &[f64]) -> f64 {
        let (own, nodes) = unknowns.split_at(self.own());
        let x = self.all_positions(own);
        let energy = match &self.solid {
            None => self.energy.value(&x),
            Some((solid, frozen)) => {
                let (q, below) = solid.at(nodes);
                self.energy.value_over(&x, &below) + solid.value(frozen, &x, &q)
            }
        };
        energy + self.loads(own)
    }

    fn gradient(&self, unknowns: &[f64], gradient: &mut [f64]) -> f64 {
        let (own, nodes) = unknowns.split_at(self.own());
        let (of_layer, of_nodes) = gradient.split_at_mut(self.own());
        let x = self.all_positions(own);
        let energy = match &self.solid {
            None => {
                self.energy.gradient(&x, of_layer);
                self.energy.value(&x)
            }
            Some((solid, frozen)) => {
                let (q, below) = solid.at(nodes);
                let springs = self.energy.gradient_over(&x, &below, of_layer);
                solid.gradient(frozen, (&x, &q), &springs, (&mut *of_layer, of_nodes));
                self.energy.value_over(&x, &below) + solid.value(frozen, &x, &q)
            }
        };
        for (gradient, reaction) in of_layer.iter_mut().zip(self.reaction) {
            *gradient -= reaction;
        }
        for (gradient, ((w, c), x)) in of_layer.iter_mut().zip(self.inertia().zip(own)) {
            *gradient += w * (x - c);
        }
        energy + self.loads(own)
    }

    fn hessian(&self, unknowns: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let (own, nodes) = unknowns.split_at(self.own());
        let x = self.all_positions(own);
        match &self.solid {
            None => self.energy.hessian(&x, exact, Some(&mut *relaxed)),
            Some((solid, frozen)) => {
                // The layer's own pattern has no room for nodes.
                let [mut first, mut second] =
                    [0, 1].map(|_| vec![0.0; self.energy.pattern().1.len()]);
                self.energy.hessian(&x, &mut first, Some(&mut second));
                let (q, _) = solid.at(nodes);
                solid.hessian(frozen, (&x, &q), [&first, &second], [exact, relaxed]);
            }
        }
        for (column, (w, _)) in self.inertia().enumerate() {
            // A column of the lower triangle begins with its diagonal.
            let diagonal = self.pattern.column_starts()[column];
            exact[diagonal] += w;
            relaxed[diagonal] += w;
        }
    }

    fn damping(&self) -> &[f64] {
        self.damping
    }

    fn energy_scale(&self) -> f64 {
        self.energy_scale
    }

    fn force_scale(&self) -> f64 {
        // What the foundation exerts on a vertex that is a thickness away.
        self.wrinkling.normal_stiffness * self.thickness * self.vertex_area
    }

    fn length_scale(&self) -> f64 {
        self.thickness
    }
}

/// Work of a dead load at the coordinates `x` (m), from where it does none, J: the load of each, N, and that place, m.
pub(crate) fn work([force, base]: [&[f64]; 2], x: &[f64]) -> f64 {
    let terms = force.iter().zip(x).zip(base);
    terms.map(|((force, x), base)| force * (x - base)).sum()
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
