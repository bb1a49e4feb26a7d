//! The energy of a body and its layer as the solver sees it.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_solver::{LowerPattern, Objective};

use super::contact::Contact;
use super::system::BodySystem;
use crate::motion::Inertia;

/// What one solve holds fast.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    /// All nodes; held ones are where they are to be.
    pub(crate) q: Vec<Vector3<f64>>,
    /// Unit normals of the surface below the layer's vertices.
    pub(crate) normals: Vec<Vector3<f64>>,
    /// [`BodySystem::constant_hessian`] for these normals and this inertia.
    pub(crate) constant: Arc<Vec<f64>>,
    pub(crate) contact: Contact,
    /// Where the artist's vertices are drawn to, m; empty where nothing draws them.
    pub(crate) targets: Vec<Vector3<f64>>,
    /// What a step in time adds.
    pub(crate) inertia: Option<Inertia>,
}

/// Scales of a solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scales {
    /// Energy that wrinkling is about, J.
    pub(crate) energy: f64,
    /// N.
    pub(crate) force: f64,
    /// m.
    pub(crate) length: f64,
}

/// ```text
/// E(x, q) = shell(x) + 1/2 e' F e + lattice(q) + contact(x) - weight . q
///           + 1/2 sum k |B q - target|^2 + f/2 (q - c)' M (q - c),      e = x - B q
/// ```
pub(crate) struct BodyObjective<'a> {
    pub(crate) system: &'a BodySystem,
    pub(crate) moment: &'a Moment,
    pub(crate) scales: Scales,
}

/// A state of body and layer.
struct State {
    x: Vec<Vector3<f64>>,
    q: Vec<Vector3<f64>>,
    /// From the surface below to the layer.
    e: Vec<Vector3<f64>>,
}

impl BodyObjective<'_> {
    fn state(&self, unknowns: &[f64]) -> State {
        let (layer, body) = unknowns.split_at(self.system.layout.shell_unknowns());
        let x: Vec<_> = layer
            .chunks_exact(3)
            .map(Vector3::from_column_slice)
            .collect();
        let mut q = self.moment.q.clone();
        self.system.lattice.set_unknowns(body, &mut q);
        let below = self.system.embedding.positions(&q);
        let e = x.iter().zip(&below).map(|(x, b)| x - b).collect();
        State { x, q, e }
    }

    fn energy(&self, State { x, q, e }: &State) -> f64 {
        let Self { system, moment, .. } = self;
        let mut energy = system.shell.value(x) + system.lattice.value(q);
        energy += moment.contact.value(x, &system.areas);
        energy -= dot(&system.weight, q);
        if let Some(foundation) = &system.foundation {
            energy += 0.5 * dot(&foundation.forces(&moment.normals, e), e);
        }
        if let Some(follow) = &system.follow {
            let pairs = follow
                .embedding
                .positions(q)
                .into_iter()
                .zip(&moment.targets);
            let springs = pairs.zip(&follow.stiffness);
            energy += springs
                .map(|((at, target), k)| 0.5 * k * (at - target).norm_squared())
                .sum::<f64>();
        }
        if let Some(inertia) = &moment.inertia {
            energy += system.mass.inertial_energy(inertia, q);
        }
        energy
    }

    /// The gradient by all nodes, without the lattice's own.
    fn forces_on_nodes(&self, state: &State, springs: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let Self { system, moment, .. } = self;
        let mut forces: Vec<_> = system.weight.iter().map(|weight| -weight).collect();
        let mut add = |more: Vec<Vector3<f64>>, sign: f64| {
            for (force, more) in forces.iter_mut().zip(more) {
                *force += more * sign;
            }
        };
        add(system.embedding.pull_back(springs), -1.0);
        if let Some(follow) = &system.follow {
            let at = follow.embedding.positions(&state.q);
            let pairs = at.iter().zip(&moment.targets).zip(&follow.stiffness);
            let pulls: Vec<_> = pairs.map(|((at, target), k)| (at - target) * *k).collect();
            add(follow.embedding.pull_back(&pulls), 1.0);
        }
        if let Some(inertia) = &moment.inertia {
            add(system.mass.inertial_forces(inertia, &state.q), 1.0);
        }
        forces
    }
}

impl Objective for BodyObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.system.layout.pattern
    }

    fn value(&self, unknowns: &[f64]) -> f64 {
        self.energy(&self.state(unknowns))
    }

    fn gradient(&self, unknowns: &[f64], gradient: &mut [f64]) -> f64 {
        let Self { system, moment, .. } = self;
        let state = self.state(unknowns);
        let (layer, body) = gradient.split_at_mut(system.layout.shell_unknowns());
        system.shell.gradient(&state.x, layer);
        let springs = match &system.foundation {
            Some(foundation) => foundation.forces(&moment.normals, &state.e),
            None => vec![Vector3::zeros(); state.x.len()],
        };
        for (i, entries) in layer.chunks_exact_mut(3).enumerate() {
            let push = moment.contact.gradient(&state.x[i], system.areas[i]);
            for c in 0..3 {
                entries[c] += springs[i][c] + push[c];
            }
        }
        system.lattice.gradient(&state.q, body);
        let forces = self.forces_on_nodes(&state, &springs);
        for (&node, entries) in system
            .lattice
            .free_nodes()
            .iter()
            .zip(body.chunks_exact_mut(3))
        {
            for c in 0..3 {
                entries[c] += forces[node as usize][c];
            }
        }
        self.energy(&state)
    }

    fn hessian(&self, unknowns: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let Self { system, moment, .. } = self;
        let layout = &system.layout;
        let state = self.state(unknowns);
        let mut both = [exact, relaxed];
        let mut shell = [0, 1].map(|_| vec![0.0; system.shell.pattern().1.len()]);
        let mut lattice = [0, 1].map(|_| vec![0.0; system.lattice.pattern().1.len()]);
        let [of_exact, of_relaxed] = &mut shell;
        system.shell.hessian(&state.x, of_exact, Some(of_relaxed));
        let [of_exact, of_relaxed] = &mut lattice;
        system.lattice.hessian(&state.q, of_exact, Some(of_relaxed));
        for ((values, shell), lattice) in both.iter_mut().zip(&shell).zip(&lattice) {
            values.copy_from_slice(&moment.constant);
            layout.add_shell(shell, values);
            for (value, lattice) in layout.body(values).iter_mut().zip(lattice) {
                *value += lattice;
            }
        }
        for (vertex, (x, area)) in state.x.iter().zip(&system.areas).enumerate() {
            if let Some(block) = moment.contact.hessian(x, *area) {
                for values in &mut both {
                    layout.add_vertex(vertex, &block, values);
                }
            }
        }
    }

    fn floor(&self) -> &[f64] {
        &self.system.floor
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

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
