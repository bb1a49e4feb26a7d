//! Mass of a lattice, and its weight.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::Id;

use crate::lattice_energy::lower_integrals;
use crate::quadrature::{Integrand, Quadrature};
use crate::{Lattice, LatticeEnergy, LatticeError};

impl Lattice {
    /// Lumped masses of the nodes (kg) at a density (kg/m³): row sums of the consistent matrix.
    ///
    /// They sum to the mass of the body with [`Filling::Piece`](crate::Filling::Piece), and have its
    /// centre; to that of all elements' cells with [`Filling::Whole`](crate::Filling::Whole).
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
        let quadrature = Quadrature::new(self, Integrand::Mass);
        let mut masses = vec![0.0; self.node_count()];
        for element in self.elements() {
            for point in quadrature.points(element) {
                let nodes = self.element_nodes(element).iter();
                for (node, value) in nodes.zip(&point.shape.values) {
                    // Shape functions sum to one: the integral of one of them is the sum of its
                    // row.
                    masses[node.index()] += density * point.volume * value;
                }
            }
        }
        Ok(masses)
    }

    /// Weight on the nodes (N) at a density (kg/m³) and an acceleration (m/s²).
    ///
    /// # Errors
    /// Those of [`Self::node_masses`]; [`LatticeError::NotFinite`] for the acceleration.
    pub fn gravity_load(
        &self,
        density: f64,
        gravity: &Vector3<f64>,
    ) -> Result<Vec<Vector3<f64>>, LatticeError> {
        if let Some(index) = gravity.iter().position(|g| !g.is_finite()) {
            let what = "component of gravity";
            return Err(LatticeError::NotFinite { what, index });
        }
        let masses = self.node_masses(density)?;
        Ok(masses.into_iter().map(|mass| gravity * mass).collect())
    }
}

impl LatticeEnergy {
    /// The consistent mass matrix of a lattice (kg) at a density (kg/m³), values in the order of
    /// [`Self::pattern`]. Its kinetic energy is exact for every rigid motion of the body.
    ///
    /// # Errors
    /// [`LatticeError::Setting`]; [`LatticeError::Length`] for another lattice than the energy's.
    pub fn mass(&self, lattice: &Lattice, density: f64) -> Result<Vec<f64>, LatticeError> {
        crate::error::check_length("nodes", self.blocks().point_count(), lattice.node_count())?;
        // Only for its check of the density.
        lattice.node_masses(density)?;
        let quadrature = Quadrature::new(lattice, Integrand::Mass);
        let mut values = vec![0.0; self.blocks().rows().len()];
        for element in lattice.elements() {
            let products = lower_integrals(quadrature.points(element), |point, i, j| {
                point.shape.values[i] * point.shape.values[j]
            });
            let nodes: Vec<u32> = lattice.element_nodes(element).iter().map(|n| n.0).collect();
            for (slot, product) in self.blocks().stencil_slots(&nodes).zip(products) {
                slot.add(
                    &mut values,
                    &Matrix3::from_diagonal_element(density * product),
                );
            }
        }
        Ok(values)
    }
}
