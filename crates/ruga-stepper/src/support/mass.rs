//! Mass of a body with its layer.

use nalgebra::{Matrix3, Vector3};
use ruga_lattice::{Embedding, Lattice, LatticeEnergy, LatticeError};

use crate::support::motion::Inertia;

/// Consistent mass over all nodes, held ones too: that of the inside, and the layer's, `B' m B`.
///
/// The layer has no inertia of its own: it is in equilibrium at every moment, and where it goes its
/// mass goes with the body below (RK 6.2).
#[derive(Clone, Debug)]
pub(crate) struct BodyMass {
    column_starts: Vec<usize>,
    rows: Vec<u32>,
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
        let of_layer = diagonal(of_layer);
        let with_layer = |energy: &LatticeEnergy| -> Result<Vec<f64>, LatticeError> {
            let mut values = energy.mass(lattice, density)?;
            energy.add_pulled_back(embedding, &of_layer, &mut values);
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

    /// Energy that a step in time to `q` (m) adds, J.
    pub(crate) fn inertial_energy(&self, inertia: &Inertia, q: &[Vector3<f64>]) -> f64 {
        let displacements = inertia.displacements(q);
        let pairs = displacements.iter().zip(self.times(&displacements));
        0.5 * inertia.weight(1.0) * pairs.map(|(u, mu)| u.dot(&mu)).sum::<f64>()
    }

    /// Inertial forces against the motion to `q` (m): the gradient of that energy, N.
    pub(crate) fn inertial_forces(
        &self,
        inertia: &Inertia,
        q: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let mut forces = self.times(&inertia.displacements(q));
        let weight = inertia.weight(1.0);
        forces.iter_mut().for_each(|force| *force *= weight);
        forces
    }

    /// `M v` over all nodes.
    pub(crate) fn times(&self, v: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut product = vec![Vector3::zeros(); v.len()];
        // Blocks are multiples of the identity: the x column of a node says all.
        for j in 0..v.len() {
            for k in self.column_starts[3 * j]..self.column_starts[3 * j + 1] {
                let row = self.rows[k] as usize;
                let (i, axis) = (row / 3, row % 3);
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

/// A stiffness or mass of the points of a surface with one value per point, the same for x, y and z.
pub(crate) fn diagonal(of_points: &[f64]) -> Vec<Vec<(u32, Matrix3<f64>)>> {
    let block = |(point, value): (u32, &f64)| vec![(point, Matrix3::from_diagonal_element(*value))];
    (0..).zip(of_points).map(block).collect()
}
