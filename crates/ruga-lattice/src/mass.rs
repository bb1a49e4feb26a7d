//! Mass of a lattice, and its weight.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::Id;

use crate::{Lattice, LatticeEnergy, LatticeError};

impl Lattice {
    /// Lumped masses of the nodes (kg) at a density (kg/m³): row sums of the consistent matrix.
    ///
    /// They are positive, as the shape functions are, and sum to the mass of the body with
    /// [`Filling::Share`](crate::Filling::Share), of all elements' cells otherwise. Within an
    /// element mass is spread evenly.
    ///
    /// # Errors
    /// [`LatticeError::Setting`] unless the density is positive and finite.
    pub fn node_masses(&self, density: f64) -> Result<Vec<f64>, LatticeError> {
        if !(density > 0.0 && density.is_finite()) {
            return Err(LatticeError::Setting {
                name: "density",
                value: density,
                accepted: "a positive number",
            });
        }
        let shares = mean_values(self);
        let mut masses = vec![0.0; self.node_count()];
        for element in self.elements() {
            let mass = density * self.mass_volume(element);
            for (node, share) in self.element_nodes(element).iter().zip(&shares) {
                masses[node.index()] += mass * share;
            }
        }
        Ok(masses)
    }

    /// Weight on the nodes (N) at a density (kg/m³) and an acceleration (m/s²).
    ///
    /// # Errors
    /// Those of [`Self::node_masses`].
    pub fn weights(
        &self,
        density: f64,
        gravity: &Vector3<f64>,
    ) -> Result<Vec<Vector3<f64>>, LatticeError> {
        let masses = self.node_masses(density)?;
        Ok(masses.into_iter().map(|mass| gravity * mass).collect())
    }

    /// `int N_i N_j / V` over the lower blocks of an element.
    fn mean_products(&self) -> Vec<f64> {
        let quadrature = self.quadrature();
        let n = self.shape().nodes_per_element();
        let lower = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
        lower
            .map(|(i, j)| {
                let terms = quadrature.iter().map(|point| {
                    let values = &point.shape.values;
                    point.share * values[i] * values[j]
                });
                terms.sum()
            })
            .collect()
    }
}

/// `int N_i / V` of an element.
fn mean_values(lattice: &Lattice) -> Vec<f64> {
    let mut means = vec![0.0; lattice.shape().nodes_per_element()];
    for point in lattice.quadrature() {
        for (mean, value) in means.iter_mut().zip(&point.shape.values) {
            *mean += point.share * value;
        }
    }
    means
}

impl LatticeEnergy {
    /// The consistent mass matrix of a lattice (kg) at a density (kg/m³), values in the order of
    /// [`Self::pattern`]; quadrature is exact.
    ///
    /// # Errors
    /// [`LatticeError::Setting`]; [`LatticeError::Length`] for another lattice than the energy's.
    pub fn mass(&self, lattice: &Lattice, density: f64) -> Result<Vec<f64>, LatticeError> {
        crate::error::check_length("nodes", self.blocks().node_count(), lattice.node_count())?;
        lattice.node_masses(density)?;
        let products = lattice.mean_products();
        let mut values = vec![0.0; self.blocks().rows.len()];
        for element in lattice.elements() {
            let mass = density * lattice.mass_volume(element);
            let block = |&p: &f64| Matrix3::from_diagonal_element(mass * p);
            let blocks: Vec<Matrix3<f64>> = products.iter().map(block).collect();
            let nodes: Vec<u32> = lattice.element_nodes(element).iter().map(|n| n.0).collect();
            self.blocks().add_stencil(&mut values, &nodes, &blocks);
        }
        Ok(values)
    }
}
