//! Inertia around fast projection.

use nalgebra::Vector3;

use super::conjugate_gradient::Solver;
use super::lattice::SpringLattice;
use super::projection::{Mobility, Projection, ProjectionReport, fast_projection};

/// How a step in time uses masses and the time step `h`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeRule {
    /// Eq. (8) and (9) as they stand: a force accelerates whatever the mass, and a velocity is a displacement.
    /// `v~ = v + h F,  x~ = x + v~`, then the projection without masses.
    Printed,
    /// `v~ = v + h F/m,  x~ = x + h v~`, then the projection by masses.
    Mended,
}

/// Particles in motion on a lattice of springs.
#[derive(Clone, Debug)]
pub struct SpringMotion {
    /// Where they are (m).
    pub positions: Vec<Vector3<f64>>,
    /// How they move (m/s).
    pub velocities: Vec<Vector3<f64>>,
    /// Their masses (kg).
    pub masses: Vec<f64>,
    /// Which of them are held in their places.
    pub held: Vec<bool>,
    /// Length of a time step (s). The paper takes 0.002.
    pub time_step: f64,
    /// How it is used.
    pub rule: TimeRule,
    solver: Solver,
}

impl SpringMotion {
    /// Particles at rest, none of them held, in steps of 2 ms.
    pub fn at_rest(positions: Vec<Vector3<f64>>, masses: Vec<f64>, rule: TimeRule) -> Self {
        Self {
            velocities: vec![Vector3::zeros(); positions.len()],
            held: vec![false; positions.len()],
            positions,
            masses,
            time_step: 0.002,
            rule,
            solver: Solver::default(),
        }
    }

    /// One step in time under forces (N) on the particles, eq. (8) to (13).
    ///
    /// Collisions, eq. (14) and (15), are left out.
    pub fn step(
        &mut self,
        lattice: &SpringLattice,
        projection: &Projection,
        forces: &[Vector3<f64>],
    ) -> ProjectionReport {
        let h = self.time_step;
        let is_printed = self.rule == TimeRule::Printed;
        let of_velocity = if is_printed { 1.0 } else { h };
        let places = self.positions.iter_mut().zip(&mut self.velocities);
        let particles = self.masses.iter().zip(&self.held).zip(forces);
        for ((position, velocity), ((&mass, &held), force)) in places.zip(particles) {
            if held {
                *velocity = Vector3::zeros();
                continue;
            }
            let inertia = if is_printed { 1.0 } else { mass };
            *velocity += force * (h / inertia);
            *position += *velocity * of_velocity;
        }
        let before = self.positions.clone();
        let mobility = self.mobility();
        let report = fast_projection(
            lattice,
            &mobility,
            projection,
            &mut self.positions,
            &mut self.solver,
        );
        let moved = self.positions.iter().zip(&before);
        for (velocity, (after, before)) in self.velocities.iter_mut().zip(moved) {
            *velocity += (after - before) / h;
        }
        report
    }

    /// Momentum of all particles (kg m/s).
    pub fn momentum(&self) -> Vector3<f64> {
        let own = self.velocities.iter().zip(&self.masses);
        own.map(|(velocity, &mass)| velocity * mass).sum()
    }

    fn mobility(&self) -> Mobility {
        if self.rule == TimeRule::Printed {
            return Mobility::printed(&self.held);
        }
        let masses = self.masses.iter().zip(&self.held);
        let free = masses.map(|(&mass, &held)| if held { 0.0 } else { mass });
        Mobility::by_mass(&free.collect::<Vec<_>>())
    }
}
