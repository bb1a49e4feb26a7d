//! The energy of a sheet as the solver sees it.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh, VertexId};
use ruga_shell::LayerEnergy;
use ruga_solver::{LowerPattern, Objective, StressPrediction};

use crate::run::layer_objective::scatter;
use crate::support::contact::Contact;
use crate::support::motion::Inertia;

/// Elastic energy, weight, contact and inertia as a function of the coordinates of the free vertices.
///
/// ```text
/// E(x) = shell(x) - m g . x + contact(x) + w/2 m (x - c)^2
/// ```
pub(super) struct SheetObjective<'a> {
    pub(super) energy: &'a LayerEnergy,
    pub(super) free: &'a [VertexId],
    /// Positions of all vertices, of which only the held ones are read, m.
    pub(super) positions: &'a [Vector3<f64>],
    pub(super) pattern: &'a LowerPattern,
    /// Levenberg damping, N/m.
    pub(super) damping: &'a [f64],
    /// Mass (kg), and rest area (m²), of every vertex.
    pub(super) masses: &'a [f64],
    pub(super) areas: &'a [f64],
    pub(super) gravity: Vector3<f64>,
    pub(super) contact: Contact,
    pub(super) inertia: Option<&'a Inertia>,
    pub(super) scales: Scales,
    pub(super) mesh: &'a TriMesh,
}

/// Angle (rad) by which a step may turn an edge, and share by which it may stretch one. Twice as much took a third more
/// factorisations on `assets/paper/corner.toml`.
const TURN: f64 = 0.2;

/// Least scale of energies and forces, in those of bending by one radian.
const LEAST: f64 = 1e-5;

/// Sizes that tolerances are relative to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    /// Energy, J.
    pub(super) energy: f64,
    /// Force on a vertex, N.
    pub(super) force: f64,
    /// Length, m.
    pub(super) length: f64,
}

impl Scales {
    /// Those of a sheet of a bending modulus `D` (J), mesh edges and a longest side (m) under a weight `F` (N):
    /// `D` and `D/edge`, or what the weight does, the energy `(F L)²/D` of a beam that it bends, where that is less.
    pub(super) fn new(
        bending: f64,
        [edge, side]: [f64; 2],
        (weight, vertices): (f64, f64),
    ) -> Self {
        let (mut energy, mut force) = (bending, bending / edge);
        if weight > 0.0 {
            // A floor, or what curls a sheet that weighs next to nothing would have to be exact beyond rounding.
            let of_weight = (weight * side).powi(2) / bending;
            energy = energy.min(of_weight.max(LEAST * bending));
            force = force.min((weight / vertices).max(LEAST * bending / edge));
        }
        Self {
            energy,
            force,
            length: edge,
        }
    }
}

impl SheetObjective<'_> {
    fn all_positions(&self, unknowns: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.to_vec();
        scatter(self.free, unknowns, &mut positions);
        positions
    }

    /// Energy of weight, contact and inertia, J.
    fn loads(&self, x: &[Vector3<f64>]) -> f64 {
        let pairs = || x.iter().zip(self.masses);
        // Against where it began, the work of the weight keeps its digits.
        let work: f64 = pairs().map(|(x, m)| m * self.gravity.dot(x)).sum();
        let kinetic = self.inertia.map_or(0.0, |inertia| {
            let centres = pairs().zip(&inertia.centres);
            let terms =
                centres.map(|((x, m), c)| 0.5 * inertia.weight(*m) * (x - c).norm_squared());
            terms.sum()
        });
        kinetic - work + self.contact.value(x, self.areas)
    }

    /// Adds the second derivatives of inertia and contact.
    fn add_loads(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        for (number, v) in self.free.iter().enumerate() {
            let i = v.0 as usize;
            let weight = self.inertia.map(|inertia| inertia.weight(self.masses[i]));
            for axis in 0..3 {
                // A column of the lower triangle begins with its diagonal.
                let diagonal = self.pattern.column_starts()[3 * number + axis];
                exact[diagonal] += weight.unwrap_or(0.0);
                relaxed[diagonal] += weight.unwrap_or(0.0);
            }
            // Contact only stiffens, and is the same in the relaxed matrix.
            if let Some(block) = self.contact.hessian(&x[i], self.areas[i]) {
                let slot = self.energy.blocks().slot(v.0, v.0);
                slot.add(exact, &block);
                slot.add(relaxed, &block);
            }
        }
    }
}

impl Objective for SheetObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        self.pattern
    }

    fn value(&self, unknowns: &[f64]) -> f64 {
        let x = self.all_positions(unknowns);
        self.energy.value(&x) + self.loads(&x)
    }

    fn gradient(&self, unknowns: &[f64], gradient: &mut [f64]) -> f64 {
        let x = self.all_positions(unknowns);
        self.energy.gradient(&x, gradient);
        for (v, entries) in self.free.iter().zip(gradient.chunks_exact_mut(3)) {
            let i = v.0 as usize;
            let mut force = self.contact.gradient(&x[i], self.areas[i]);
            force -= self.gravity * self.masses[i];
            if let Some(inertia) = self.inertia {
                force += (x[i] - inertia.centres[i]) * inertia.weight(self.masses[i]);
            }
            for c in 0..3 {
                entries[c] += force[c];
            }
        }
        self.energy.value(&x) + self.loads(&x)
    }

    fn hessian(&self, unknowns: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let x = self.all_positions(unknowns);
        self.energy.hessian(&x, exact, Some(&mut *relaxed));
        self.add_loads(&x, exact, relaxed);
    }

    fn prediction(&self) -> Option<&dyn StressPrediction> {
        Some(self)
    }

    fn damping(&self) -> &[f64] {
        self.damping
    }

    fn energy_scale(&self) -> f64 {
        self.scales.energy
    }

    fn force_scale(&self) -> f64 {
        self.scales.force
    }

    fn length_scale(&self) -> f64 {
        self.scales.length
    }
}

impl StressPrediction for SheetObjective<'_> {
    fn reach(&self, unknowns: &[f64], step: &[f64]) -> f64 {
        let x = self.all_positions(unknowns);
        let mut change = vec![Vector3::zeros(); x.len()];
        scatter(self.free, step, &mut change);
        let edges = self.mesh.edges().as_slice().iter();
        let edges = edges.map(|edge| edge.vertices.map(|v| v.index()));
        let turns = edges.map(|[a, b]| (change[b] - change[a]).norm() / (x[b] - x[a]).norm());
        (TURN / turns.fold(TURN, f64::max)).min(1.0)
    }

    fn hessian(&self, unknowns: &[f64], from: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let [x, from] = [unknowns, from].map(|unknowns| self.all_positions(unknowns));
        self.energy.predicted_hessian(&x, &from, exact, relaxed);
        self.add_loads(&x, exact, relaxed);
    }
}
