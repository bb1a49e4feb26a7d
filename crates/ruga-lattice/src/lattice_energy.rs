//! The elastic energy of a lattice, assembled over its free nodes.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use ruga_mesh::BlockPattern;

use crate::error::check_length;
use crate::quadrature::{Integrand, Quadrature, QuadraturePoint};
use crate::rotated_linear::Tangent;

use crate::{Lattice, LatticeError, RotatedLinear, SolidMaterial};

/// Rotated linear elasticity of all elements (RK 5), each at 27 or 8 quadrature
/// points, and as many again where it is not full.
///
/// Every node has a vector; only those that are not pinned have degrees of freedom, three each
/// (x, y, z) in the order of the nodes. Elements are evaluated in parallel on the caller's thread
/// pool and added up in order: the same bytes on any number of threads.
///
/// # Panics
/// Methods that take node vectors or a target slice panic when its length is not the lattice's.
#[derive(Clone, Debug)]
pub struct LatticeEnergy {
    law: RotatedLinear,
    quadrature: Quadrature,
    /// Integrals for each of its tables, `sum_p V_p grad N_i . grad N_j` over the lower blocks of
    /// an element (m): what `|F|^2 / 2` contributes to the Hessian, the same at every state.
    laplacians: Vec<Vec<f64>>,
    nodes_per_element: usize,
    /// Nodes of all elements, one after the other.
    nodes: Vec<u32>,
    pattern: BlockPattern,
}

/// Elements whose Hessians are held at once: enough for all threads, little memory.
const BATCH: usize = 64;

/// Lower blocks of an element's Hessian; the second list is empty when it is not asked for.
type ElementHessian = (Vec<Matrix3<f64>>, Vec<Matrix3<f64>>);

impl LatticeEnergy {
    /// The energy of a lattice filled with one material, at rest at
    /// [`Lattice::rest_positions`]. `pinned` has one entry per node.
    ///
    /// # Errors
    /// [`LatticeError::Length`], [`LatticeError::Setting`].
    pub fn new(
        lattice: &Lattice,
        material: &SolidMaterial,
        pinned: &[bool],
    ) -> Result<Self, LatticeError> {
        material.check()?;
        check_length("pinned", lattice.node_count(), pinned.len())?;
        let nodes_per_element = lattice.shape().nodes_per_element();
        let element_nodes = lattice.elements().flat_map(|e| lattice.element_nodes(e));
        let nodes: Vec<u32> = element_nodes.map(|node| node.0).collect();
        let quadrature = Quadrature::new(lattice, Integrand::Stiffness);
        let tables = quadrature.tables().iter();
        Ok(Self {
            law: RotatedLinear::new(material.young, material.poisson),
            laplacians: tables.map(|points| laplacian(points)).collect(),
            quadrature,
            nodes_per_element,
            pattern: BlockPattern::new(pinned, nodes.chunks(nodes_per_element)),
            nodes,
        })
    }

    /// The free nodes; the `k`-th has degrees of freedom `3k`, `3k + 1`, `3k + 2`.
    pub fn free_nodes(&self) -> &[u32] {
        self.pattern.free_points()
    }

    /// Number of degrees of freedom.
    pub fn dof_count(&self) -> usize {
        self.pattern.size()
    }

    /// Column starts and row indices of the Hessian's lower triangle, diagonal included, rows
    /// sorted within each column.
    pub fn pattern(&self) -> (&[usize], &[u32]) {
        (self.pattern.column_starts(), self.pattern.rows())
    }

    /// The pattern by blocks of nodes.
    pub fn blocks(&self) -> &BlockPattern {
        &self.pattern
    }

    pub(crate) fn blocks_mut(&mut self) -> &mut BlockPattern {
        &mut self.pattern
    }

    /// Energy (J) with the nodes at `q` (m). Not a number if a node is not finite.
    pub fn value(&self, q: &[Vector3<f64>]) -> f64 {
        self.element_energies(q).iter().sum()
    }

    /// Energy of each element (J).
    pub fn element_energies(&self, q: &[Vector3<f64>]) -> Vec<f64> {
        self.check(q);
        let energy = |element: usize| {
            let x = self.gather(element, q);
            let points = self.points(element).iter();
            points
                .map(|point| point.volume * self.law.energy(&deformation(point, &x)))
                .sum()
        };
        let elements = 0..self.element_count();
        elements.into_par_iter().map(energy).collect()
    }

    /// Writes the derivative of the energy by the degrees of freedom (N).
    pub fn gradient(&self, q: &[Vector3<f64>], gradient: &mut [f64]) {
        self.check(q);
        assert_eq!(gradient.len(), self.dof_count(), "one entry per dof");
        gradient.fill(0.0);
        let elements = 0..self.element_count();
        // Only the elements are evaluated in parallel. A parallel sum would depend in its last
        // digits on the number of threads.
        let forces: Vec<Vec<Vector3<f64>>> = elements
            .into_par_iter()
            .map(|element| self.element_gradient(element, q))
            .collect();
        for (nodes, forces) in self.nodes.chunks(self.nodes_per_element).zip(&forces) {
            self.pattern.add_forces(gradient, nodes, forces);
        }
    }

    fn element_gradient(&self, element: usize, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let x = self.gather(element, q);
        let mut forces = vec![Vector3::zeros(); x.len()];
        for point in self.points(element) {
            let stress = self.law.stress(&deformation(point, &x));
            let stress = stress * point.volume;
            for (force, gradient) in forces.iter_mut().zip(&point.shape.gradients) {
                *force += stress * gradient;
            }
        }
        forces
    }

    /// Writes the second derivative (N/m), values in the order of [`Self::pattern`].
    ///
    /// `relaxed`, if asked for, takes the same matrix with the negative eigenvalues of the
    /// material's tangent at each quadrature point raised to zero; it is positive semidefinite.
    /// They belong to twists of compressed material, whose compressive stress would turn it.
    pub fn hessian(&self, q: &[Vector3<f64>], exact: &mut [f64], mut relaxed: Option<&mut [f64]>) {
        self.check(q);
        exact.fill(0.0);
        if let Some(relaxed) = relaxed.as_deref_mut() {
            relaxed.fill(0.0);
        }
        for first in (0..self.element_count()).step_by(BATCH) {
            let batch = first..(first + BATCH).min(self.element_count());
            let hessians: Vec<ElementHessian> = batch
                .clone()
                .into_par_iter()
                .map(|element| self.element_hessian(element, q, relaxed.is_some()))
                .collect();
            for (element, (blocks, relaxed_blocks)) in batch.zip(&hessians) {
                let slots = self.pattern.stencil_slots(self.element_nodes(element));
                for (k, slot) in slots.enumerate() {
                    slot.add(exact, &blocks[k]);
                    if let Some(relaxed) = relaxed.as_deref_mut() {
                        slot.add(relaxed, &relaxed_blocks[k]);
                    }
                }
            }
        }
    }

    fn element_hessian(
        &self,
        element: usize,
        q: &[Vector3<f64>],
        with_relaxed: bool,
    ) -> ElementHessian {
        let x = self.gather(element, q);
        let stiffness = 2.0 * self.law.shear();
        let laplacian = &self.laplacians[self.quadrature.table_of(element)];
        let linear = |&l: &f64| Matrix3::from_diagonal_element(stiffness * l);
        let mut exact: Vec<Matrix3<f64>> = laplacian.iter().map(linear).collect();
        // By how much the relaxed Hessian is above the exact one.
        let mut raise = vec![Matrix3::zeros(); if with_relaxed { exact.len() } else { 0 }];
        // What is left of the tangent after 2 mu I is four outer products: no matrix of nine by
        // nine is formed.
        for point in self.points(element) {
            let tangent = self.law.tangent(&deformation(point, &x));
            let gradients = &point.shape.gradients;
            let weight = point.volume;
            add_outer(
                &mut exact,
                &tangent.rotation,
                gradients,
                weight * self.law.lame(),
            );
            let Tangent { twists, .. } = &tangent;
            let factors = twists.iter().zip(tangent.exact.iter().zip(tangent.relaxed));
            for (twist, (&factor, relaxed)) in factors {
                add_outer(&mut exact, twist, gradients, weight * factor);
                // Where the tangent has no negative eigenvalue the two factors are one number.
                if with_relaxed && relaxed != factor {
                    add_outer(&mut raise, twist, gradients, weight * (relaxed - factor));
                }
            }
        }
        for (raise, exact) in raise.iter_mut().zip(&exact) {
            *raise += exact;
        }
        (exact, raise)
    }

    fn element_count(&self) -> usize {
        self.nodes.len() / self.nodes_per_element
    }

    fn points(&self, element: usize) -> &[QuadraturePoint] {
        &self.quadrature.tables()[self.quadrature.table_of(element)]
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        let n = self.nodes_per_element;
        &self.nodes[n * element..n * (element + 1)]
    }

    /// Node vectors of an element from its first node, so that a body far from the origin loses no
    /// digits: gradients of shape functions sum to zero.
    fn gather(&self, element: usize, q: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let nodes = self.element_nodes(element);
        let origin = q[nodes[0] as usize];
        nodes.iter().map(|&n| q[n as usize] - origin).collect()
    }

    fn check(&self, q: &[Vector3<f64>]) {
        assert_eq!(q.len(), self.pattern.point_count(), "one vector per node");
    }

    /// The free nodes' coordinates, one after the other (m).
    pub fn unknowns(&self, q: &[Vector3<f64>]) -> Vec<f64> {
        self.check(q);
        let free = self.pattern.free_points().iter();
        free.flat_map(|&n| <[f64; 3]>::from(q[n as usize]))
            .collect()
    }

    /// Puts the free nodes' coordinates (m) among all nodes.
    pub fn set_unknowns(&self, unknowns: &[f64], q: &mut [Vector3<f64>]) {
        self.check(q);
        assert_eq!(unknowns.len(), self.dof_count(), "one entry per dof");
        for (&node, x) in self.pattern.free_points().iter().zip(unknowns.chunks(3)) {
            q[node as usize] = Vector3::from_column_slice(x);
        }
    }
}

fn laplacian(points: &[QuadraturePoint]) -> Vec<f64> {
    lower_integrals(points, |point, i, j| {
        let gradients = &point.shape.gradients;
        gradients[i].dot(&gradients[j])
    })
}

/// Integrals over an element of what belongs to two of its nodes, for its lower blocks.
pub(crate) fn lower_integrals(
    points: &[QuadraturePoint],
    integrand: impl Fn(&QuadraturePoint, usize, usize) -> f64,
) -> Vec<f64> {
    let nodes = points.first().map_or(0, |point| point.shape.values.len());
    let lower = (0..nodes).flat_map(|i| (0..=i).map(move |j| (i, j)));
    lower
        .map(|(i, j)| points.iter().map(|p| p.volume * integrand(p, i, j)).sum())
        .collect()
}

#[inline]
fn deformation(point: &QuadraturePoint, x: &[Vector3<f64>]) -> Matrix3<f64> {
    let mut f = Matrix3::zeros();
    for (x, gradient) in x.iter().zip(&point.shape.gradients) {
        f += x * gradient.transpose();
    }
    f
}

/// Adds `factor (T g_i)(T g_j)^T` to each lower block.
fn add_outer(
    blocks: &mut [Matrix3<f64>],
    matrix: &Matrix3<f64>,
    gradients: &[Vector3<f64>],
    factor: f64,
) {
    let turned: Vec<Vector3<f64>> = gradients.iter().map(|g| matrix * g).collect();
    let mut blocks = blocks.iter_mut();
    for (i, row) in turned.iter().enumerate() {
        let row = row * factor;
        for (column, block) in turned[..=i].iter().zip(&mut blocks) {
            *block += row * column.transpose();
        }
    }
}
