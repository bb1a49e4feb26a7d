//! The paper's explicit loop: a cloth that is cut and sewn together, with its ways to keep it so.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};
use ruga_mesh::TriMesh;
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};

use super::VirtualNodes;
use crate::DrawnSheet;

/// What is done about the rows in every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stabilisation {
    /// Velocities are made equal after a step (the paper's eq. 3).
    Post,
    /// Velocities are chosen before the positions move, so that these come out equal (eq. 5).
    Pre,
    /// Both, as in the paper.
    Both,
}

/// A cloth whose upper corners are held, cut and sewn, swinging under its weight.
///
/// Steps are those of Bridson 2002: half of a step's forces before the positions move, the other half
/// after. The second half is why equal velocities do not keep positions equal.
pub struct CutCloth {
    cut: VirtualNodes,
    energy: LayerEnergy,
    /// Mass of every node (kg).
    masses: Vec<f64>,
    is_held: Vec<bool>,
    /// `(H M^-1 H^T)^-1`, the paper's constant matrix.
    factor: Cholesky<f64, Dyn>,
    gravity: Vector3<f64>,
    positions: Vec<Vector3<f64>>,
    velocities: Vec<Vector3<f64>>,
}

/// Stiffness of the cloth in tension (N/m) and its thickness (m): with a mass of 1 kg/m² waves run at 3 m/s, slow
/// enough for steps of a hundredth of a second on edges of an eighth of a metre.
const TENSION: f64 = 9.0;
const THICKNESS: f64 = 0.02;

/// Share of its velocity that a node loses in a second.
const DAMPING: f64 = 0.2;

impl CutCloth {
    /// A cloth at rest, of an areal density of 1 kg/m².
    ///
    /// # Panics
    /// When a held vertex belongs to the cut, or the rows depend on each other.
    pub fn new(
        (mesh, rest): (&TriMesh, &[Vector3<f64>]),
        cut: VirtualNodes,
        (face, held): (FaceParameters, &[bool]),
        gravity: Vector3<f64>,
    ) -> Self {
        assert_eq!(mesh.vertex_count(), rest.len(), "a position per vertex");
        let (positions, is_held) = (cut.spread(rest), cut.spread(held));
        let scaled = cut.faces.iter().map(|own| FaceParameters {
            young: own.share * face.young,
            ..face
        });
        let parameters = LayerParameters {
            faces: scaled.collect(),
            tangential_stiffness: vec![0.0; positions.len()],
        };
        let energy = LayerEnergy::with_bending(
            &cut.mesh(),
            &positions,
            parameters,
            &is_held,
            BendingModel::Hinge,
        );
        let masses = cut.masses(rest, 1.0);
        let matrix = effective_mass(&cut.rows, &masses);
        Self {
            energy: energy.expect("a valid layer"),
            factor: matrix.cholesky().expect("independent rows"),
            velocities: vec![Vector3::zeros(); positions.len()],
            masses,
            is_held,
            gravity,
            positions,
            cut,
        }
    }

    /// A cut square sheet of soft cloth, held at its two upper corners.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn hanging(drawn: &DrawnSheet, cut: VirtualNodes) -> Self {
        let face = FaceParameters {
            young: TENSION / THICKNESS,
            poisson: 0.3,
            thickness: THICKNESS,
            normal_stiffness: 0.0,
            gradient_stiffness: 0.0,
        };
        let high = drawn.positions.iter().map(|x| x.y).fold(0.0, f64::max);
        let wide = drawn.positions.iter().map(|x| x.x).fold(0.0, f64::max);
        let is_held = |x: &Vector3<f64>| x.y == high && (x.x == 0.0 || x.x == wide);
        let held: Vec<_> = drawn.positions.iter().map(is_held).collect();
        // Aslant, so that the cloth swings out of its plane.
        let gravity = Vector3::new(0.0, -0.8, -0.6);
        Self::new((&drawn.mesh, &drawn.positions), cut, (face, &held), gravity)
    }

    /// The cut.
    pub fn cut(&self) -> &VirtualNodes {
        &self.cut
    }

    /// Where the nodes are (m).
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// Largest distance between the two sides of the cut (m).
    pub fn gap(&self) -> f64 {
        self.cut.gap(&self.positions)
    }

    /// Makes one step in time (s).
    pub fn step(&mut self, time_step: f64, stabilisation: Stabilisation) {
        self.push(0.5 * time_step);
        if stabilisation != Stabilisation::Post {
            let wanted = self.sums(&self.positions) / time_step;
            self.make_equal(&(wanted + self.sums(&self.velocities)));
        }
        for (x, v) in self.positions.iter_mut().zip(&self.velocities) {
            *x += v * time_step;
        }
        self.push(0.5 * time_step);
        if stabilisation != Stabilisation::Pre {
            self.make_equal(&self.sums(&self.velocities));
        }
    }

    /// Lets forces act on the velocities for some time (s).
    fn push(&mut self, time: f64) {
        let mut slope = vec![0.0; self.energy.dof_count()];
        self.energy.gradient(&self.positions, &mut slope);
        let free = self.energy.free_vertices();
        for (&v, slope) in free.iter().zip(slope.chunks_exact(3)) {
            let force = -Vector3::from_column_slice(slope);
            let velocity = &mut self.velocities[v as usize];
            *velocity +=
                (force / self.masses[v as usize] + self.gravity - *velocity * DAMPING) * time;
        }
    }

    /// `H x` of a field, a column per coordinate.
    fn sums(&self, field: &[Vector3<f64>]) -> DMatrix<f64> {
        let mut sums = DMatrix::zeros(self.cut.rows.len(), 3);
        for (row, terms) in self.cut.rows.iter().enumerate() {
            for &(node, weight) in terms {
                for axis in 0..3 {
                    sums[(row, axis)] += weight * field[node as usize][axis];
                }
            }
        }
        sums
    }

    /// Gives the bound nodes impulses that take `excess` off the differences of their velocities.
    fn make_equal(&mut self, excess: &DMatrix<f64>) {
        for axis in 0..3 {
            let excess = DVector::from(excess.column(axis));
            let impulses = self.factor.solve(&excess);
            for (terms, impulse) in self.cut.rows.iter().zip(impulses.iter()) {
                for &(node, weight) in terms {
                    let node = node as usize;
                    assert!(!self.is_held[node], "the cut is away from what is held");
                    self.velocities[node][axis] -= weight * impulse / self.masses[node];
                }
            }
        }
    }
}

/// `H M^-1 H^T`, the matrix of the paper's equations 3 and 5.
pub(super) fn effective_mass(rows: &[Vec<(u32, f64)>], masses: &[f64]) -> DMatrix<f64> {
    let mut dense = DMatrix::<f64>::zeros(rows.len(), masses.len());
    for (row, terms) in rows.iter().enumerate() {
        for &(node, weight) in terms {
            dense[(row, node as usize)] += weight / masses[node as usize].sqrt();
        }
    }
    &dense * dense.transpose()
}
