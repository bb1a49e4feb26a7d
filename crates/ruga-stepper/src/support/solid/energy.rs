//! The energy of a body without that of its layer: value, gradient and Hessian.

use nalgebra::Vector3;
use ruga_shell::LayerEnergy;

use super::Solid;
use crate::support::contact::Contact;
use crate::support::motion::Inertia;
use crate::support::springs::Springs;

/// Parts of a body that one solve holds fast.
#[derive(Clone, Debug)]
pub(crate) struct Frozen {
    /// Hessian entries that stay constant: springs, guide springs and inertia.
    constant: Vec<f64>,
    contact: Contact,
    /// The term of a step in time.
    inertia: Option<Inertia>,
}

impl Solid {
    /// The parts that the next solve holds fast, over a surface with these `normals` and the springs of
    /// `energy`.
    pub(crate) fn freeze(
        &self,
        energy: &LayerEnergy,
        normals: &[Vector3<f64>],
        inertia: Option<&Inertia>,
    ) -> Frozen {
        let factor = inertia.map_or(0.0, |inertia| inertia.weight(1.0));
        Frozen {
            constant: self.constant_hessian(energy, normals, factor),
            contact: self.contact(),
            inertia: inertia.cloned(),
        }
    }

    /// Entries of the Hessian that depend on neither layer nor nodes, without the foundation's between
    /// vertices; with `inertia` (1/s²) times the mass.
    fn constant_hessian(
        &self,
        energy: &LayerEnergy,
        normals: &[Vector3<f64>],
        inertia: f64,
    ) -> Vec<f64> {
        let mut values = vec![0.0; self.layout.pattern.entries()];
        if self.is_held {
            let springs = Springs(energy.foundation_stiffness());
            let blocks = &self.layout.blocks;
            let first_node = energy.vertex_count() as u32;
            for vertex in 0..normals.len() {
                for (node, block) in springs.times(&self.embedding, normals, vertex) {
                    let slot = blocks.slot(vertex as u32, first_node + node);
                    slot.add(&mut values, &-block);
                }
            }
            let own = springs.hessian(normals);
            let body = self.layout.body(&mut values);
            self.lattice.add_pulled_back(&self.embedding, &own, body);
        }
        if let Some(anchors) = &self.anchors {
            let first_node = energy.vertex_count() as u32;
            anchors.add_to_vertices(&self.layout.blocks, first_node, &mut values);
            anchors.add_to_nodes(&self.lattice, self.layout.body(&mut values));
        }
        let body = self.layout.body(&mut values);
        if let Some(follow) = &self.follow {
            add(body, &follow.hessian, 1.0);
        }
        if inertia > 0.0 {
            add(body, &self.mass.free, inertia);
        }
        values
    }

    /// Energy (J) without the layer's and its springs'.
    pub(crate) fn value(&self, frozen: &Frozen, x: &[Vector3<f64>], q: &[Vector3<f64>]) -> f64 {
        let mut energy = self.lattice.value(q) - dot(&self.weight, q);
        energy += frozen.contact.value(self.outer(x), &self.areas);
        if let Some(anchors) = &self.anchors {
            energy += anchors.value(x, q);
        }
        if let Some(follow) = &self.follow {
            let places = self.control.positions(q);
            let pairs = places
                .iter()
                .zip(&self.state.targets)
                .zip(&follow.stiffness);
            let springs = pairs.map(|((at, target), k)| 0.5 * k * (at - target).norm_squared());
            energy += springs.sum::<f64>();
        }
        if let Some(inertia) = &frozen.inertia {
            energy += self.mass.inertial_energy(inertia, q);
        }
        energy
    }

    /// Adds contact and line anchors to the gradient by the layer's unknowns, and writes that by the nodes, which
    /// the layer's `springs` pull at (N).
    pub(crate) fn gradient(
        &self,
        frozen: &Frozen,
        (x, q): (&[Vector3<f64>], &[Vector3<f64>]),
        springs: &[Vector3<f64>],
        (of_layer, of_nodes): (&mut [f64], &mut [f64]),
    ) {
        let inner = x.len() - self.areas.len();
        let outer = of_layer.chunks_exact_mut(3).zip(x).skip(inner);
        for ((entries, x), area) in outer.zip(&self.areas) {
            let push = frozen.contact.gradient(x, *area);
            for c in 0..3 {
                entries[c] += push[c];
            }
        }
        self.lattice.gradient(q, of_nodes);
        let mut forces = self.forces_on_nodes(frozen, q, springs);
        if let Some(anchors) = &self.anchors {
            let pulls = anchors.gradient(x, q);
            for (vertex, pull) in pulls.on_vertices {
                // On a body all vertices of a layer are free.
                for c in 0..3 {
                    of_layer[3 * vertex as usize + c] += pull[c];
                }
            }
            for (force, pull) in forces.iter_mut().zip(pulls.on_nodes) {
                *force += pull;
            }
        }
        for (&node, entries) in self
            .lattice
            .free_nodes()
            .iter()
            .zip(of_nodes.chunks_exact_mut(3))
        {
            for c in 0..3 {
                entries[c] += forces[node as usize][c];
            }
        }
    }

    /// The gradient by all nodes, without the lattice's own and the line anchors'.
    fn forces_on_nodes(
        &self,
        frozen: &Frozen,
        q: &[Vector3<f64>],
        springs: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        // A gradient is the negative of the force.
        let mut forces: Vec<_> = self.weight.iter().map(|weight| -weight).collect();
        let mut add = |more: Vec<Vector3<f64>>, sign: f64| {
            for (force, more) in forces.iter_mut().zip(more) {
                *force += more * sign;
            }
        };
        // Springs depend on `x - B q`, so that nodes feel the opposite of what vertices feel.
        add(self.embedding.pull_back(springs), -1.0);
        if let Some(follow) = &self.follow {
            let places = self.control.positions(q);
            let pairs = places
                .iter()
                .zip(&self.state.targets)
                .zip(&follow.stiffness);
            let pulls: Vec<_> = pairs.map(|((at, target), k)| (at - target) * *k).collect();
            add(self.control.pull_back(&pulls), 1.0);
        }
        if let Some(inertia) = &frozen.inertia {
            add(self.mass.inertial_forces(inertia, q), 1.0);
        }
        forces
    }

    /// Writes the Hessian of layer and body, from that of the layer in its own pattern; both exact and
    /// relaxed.
    pub(crate) fn hessian(
        &self,
        frozen: &Frozen,
        (x, q): (&[Vector3<f64>], &[Vector3<f64>]),
        layer: [&[f64]; 2],
        mut both: [&mut [f64]; 2],
    ) {
        let mut lattice = [0, 1].map(|_| vec![0.0; self.lattice.pattern().1.len()]);
        let [exact, relaxed] = &mut lattice;
        self.lattice.hessian(q, exact, Some(relaxed));
        for ((values, layer), lattice) in both.iter_mut().zip(layer).zip(&lattice) {
            values.copy_from_slice(&frozen.constant);
            self.layout.add_layer(layer, values);
            add(self.layout.body(values), lattice, 1.0);
        }
        let inner = x.len() - self.areas.len();
        for (vertex, (x, area)) in (inner as u32..).zip(x[inner..].iter().zip(&self.areas)) {
            // Contact only stiffens, and is the same in the relaxed matrix.
            if let Some(block) = frozen.contact.hessian(x, *area) {
                let slot = self.layout.blocks.slot(vertex, vertex);
                both.iter_mut().for_each(|values| slot.add(values, &block));
            }
        }
    }
}

fn add(target: &mut [f64], values: &[f64], factor: f64) {
    for (target, value) in target.iter_mut().zip(values) {
        *target += factor * value;
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
