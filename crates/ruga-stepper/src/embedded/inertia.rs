//! Mass of a body with its layer, and one step of implicit Euler as an energy.

use nalgebra::Vector3;
use ruga_lattice::{Embedding, Lattice, LatticeEnergy, LatticeError, SurfacePattern};

use crate::Dynamics;

/// Consistent mass over all nodes, held ones too: that of the inside, and the layer's, `B' m B`.
///
/// The layer has no inertia of its own: it is in equilibrium at every moment, and where it goes its
/// mass goes with the body below (RK 6.2).
#[derive(Clone, Debug)]
pub(crate) struct BodyMass {
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    /// The part of the free nodes, in the order of their own pattern.
    pub(crate) free: Vec<f64>,
}

impl BodyMass {
    /// `all` is the energy of all nodes, `free` that of the free ones, both coupled by the surface.
    pub(crate) fn new(
        lattice: &Lattice,
        [all, free]: [&LatticeEnergy; 2],
        density: f64,
        (embedding, of_layer): (&Embedding, &[f64]),
    ) -> Result<Self, LatticeError> {
        let diagonal = Diagonal::new(of_layer);
        let with_layer = |energy: &LatticeEnergy| -> Result<Vec<f64>, LatticeError> {
            let mut values = energy.mass(lattice, density)?;
            diagonal.pull_back(energy, embedding, &mut values);
            Ok(values)
        };
        let (starts, rows) = all.pattern();
        Ok(Self {
            column_starts: starts.to_vec(),
            rows: rows.to_vec(),
            values: with_layer(all)?,
            free: with_layer(free)?,
        })
    }

    /// `M v` over all nodes.
    pub(crate) fn times(&self, v: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut product = vec![Vector3::zeros(); v.len()];
        // Blocks are multiples of the identity: the x column of a node says all.
        for j in 0..v.len() {
            for k in self.column_starts[3 * j]..self.column_starts[3 * j + 1] {
                let (i, axis) = (self.rows[k] / 3, self.rows[k] % 3);
                if axis != 0 {
                    continue;
                }
                product[i] += v[j] * self.values[k];
                if i != j {
                    product[j] += v[i] * self.values[k];
                }
            }
        }
        product
    }
}

/// A diagonal stiffness or mass of the points of a surface.
pub(crate) struct Diagonal {
    points: Vec<u32>,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Diagonal {
    /// One value per point, the same for x, y and z.
    pub(crate) fn new(of_points: &[f64]) -> Self {
        let unknowns = 3 * of_points.len();
        Self {
            points: (0..of_points.len() as u32).collect(),
            column_starts: (0..=unknowns).collect(),
            rows: (0..unknowns).collect(),
            values: of_points.iter().flat_map(|value| [*value; 3]).collect(),
        }
    }

    /// Adds `B' d B` to a Hessian of the lattice.
    pub(crate) fn pull_back(
        &self,
        lattice: &LatticeEnergy,
        embedding: &Embedding,
        hessian: &mut [f64],
    ) {
        let pattern = SurfacePattern {
            points: &self.points,
            column_starts: &self.column_starts,
            rows: &self.rows,
        };
        lattice.add_pulled_back(embedding, &pattern, &self.values, hessian);
    }
}

/// `f/2 (q - c)' M (q - c)`, which a step of implicit Euler adds to the energy.
///
/// With step `h` and damping `d`, from `q0` with velocity `v0`: `f = (1 + d h) / h^2` and
/// `c = q0 + h v0 / (1 + d h)`; see [`crate::motion`]. It is the whole of RK eq. 15, whose right side
/// leaves out what the mass does after the first iteration.
#[derive(Clone, Debug)]
pub(crate) struct BodyInertia {
    /// 1/s².
    pub(crate) factor: f64,
    /// Where every node would go without forces, m.
    pub(crate) centres: Vec<Vector3<f64>>,
}

impl BodyInertia {
    pub(crate) fn new(dynamics: Dynamics, q: &[Vector3<f64>], velocities: &[Vector3<f64>]) -> Self {
        let Dynamics { time_step, damping } = dynamics;
        let slowed = 1.0 + damping * time_step;
        let way = |(q, v): (&Vector3<f64>, &Vector3<f64>)| q + v * (time_step / slowed);
        Self {
            factor: slowed / (time_step * time_step),
            centres: q.iter().zip(velocities).map(way).collect(),
        }
    }

    /// Inertial forces against the motion (N): the gradient of the energy.
    pub(crate) fn forces(&self, mass: &BodyMass, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut forces = mass.times(&self.ways(q));
        forces.iter_mut().for_each(|force| *force *= self.factor);
        forces
    }

    pub(crate) fn value(&self, mass: &BodyMass, q: &[Vector3<f64>]) -> f64 {
        let ways = self.ways(q);
        let pairs = ways.iter().zip(mass.times(&ways));
        0.5 * self.factor * pairs.map(|(u, mu)| u.dot(&mu)).sum::<f64>()
    }

    fn ways(&self, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        q.iter().zip(&self.centres).map(|(q, c)| q - c).collect()
    }
}
