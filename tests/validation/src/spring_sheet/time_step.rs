//! Inertia around fast projection.

use nalgebra::Vector3;

use super::collider::Collider;
use super::conjugate_gradient::Solver;
use super::lattice::SpringLattice;
use super::projection::{Mobility, Projection, ProjectionReport, project_and_correct};

/// How a step in time uses masses and the time step `h`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeRule {
    /// Eq. (8) and (9) as they stand: a force accelerates whatever the mass, and a velocity is a displacement.
    /// `v~ = v + h F,  x~ = x + v~`, then the projection without masses.
    Printed,
    /// `v~ = v + h F/m,  x~ = x + h v~`, but the projection still without masses. As printed, eq. (9) moves a particle in
    /// 2 ms as far as its velocity would in a second, and no sheet survives that; this is the least that has to be
    /// mended before there are pictures.
    Massless,
    /// `v~ = v + h F/m,  x~ = x + h v~`, then the projection by masses.
    Mended,
}

/// Time step of the paper (s).
pub const TIME_STEP: f64 = 0.002;

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
    /// What particles do not enter.
    pub colliders: Vec<Collider>,
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
            time_step: TIME_STEP,
            rule,
            colliders: Vec::new(),
            solver: Solver::default(),
        }
    }

    /// One step in time under forces (N) on the particles, eq. (8) to (15).
    ///
    /// Colliders move first; then positions are corrected in every projection step, velocities once at the end.
    /// All particles collide, where the paper tests corners and virtual centres: a centre that is free to enter a
    /// sphere would hang in it.
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
        self.colliders.iter_mut().for_each(|own| own.advance(h));
        let (colliders, held) = (&self.colliders, &self.held);
        let mut pushes = vec![vec![0.0; before.len()]; colliders.len()];
        let report = project_and_correct(
            lattice,
            &mobility,
            projection,
            &mut self.positions,
            &mut self.solver,
            &mut |positions| {
                for (own, pushes) in colliders.iter().zip(&mut pushes) {
                    own.correct_positions(positions, held, pushes);
                }
            },
        );
        let moved = self.positions.iter().zip(&before);
        for (velocity, (after, before)) in self.velocities.iter_mut().zip(moved) {
            *velocity += (after - before) / h;
        }
        for (own, pushes) in self.colliders.iter().zip(&mut pushes) {
            pushes.iter_mut().for_each(|push| *push /= h);
            own.correct_velocities(&mut self.velocities, &self.positions, pushes);
        }
        report
    }

    /// Momentum of all particles (kg m/s).
    pub fn momentum(&self) -> Vector3<f64> {
        let own = self.velocities.iter().zip(&self.masses);
        own.map(|(velocity, &mass)| velocity * mass).sum()
    }

    fn mobility(&self) -> Mobility {
        if self.rule != TimeRule::Mended {
            return Mobility::printed(&self.held);
        }
        let masses = self.masses.iter().zip(&self.held);
        let free = masses.map(|(&mass, &held)| if held { 0.0 } else { mass });
        Mobility::by_mass(&free.collect::<Vec<_>>())
    }
}
