//! A sheet of springs that burns while it moves: the paper's time step as a whole.

use nalgebra::Vector3;

use super::heat::{HeatBall, SpringFire};
use super::lattice::SpringLattice;
use super::marching::{Remains, Remnant};
use super::projection::{Projection, ProjectionReport};
use super::spring_set::SpringError;
use super::time_step::SpringMotion;

/// What burning does to a sheet, as the paper's figure 4 tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effects {
    /// Burnt material is removed, and no spring shrinks: (a).
    Removal,
    /// Springs shrink, and nothing is removed: (b).
    Shrinkage,
    /// Both: (c) and (d).
    Both,
}

/// Everything that belongs to a sheet that burns.
///
/// A burnt particle stays as long as a spring ends at it, so that two pieces whose rims have one in common are apart in
/// the drawn mesh and still hang together: on coarse lattices pieces fall off later than they are seen to be cut.
#[derive(Clone, Debug)]
pub struct BurningSheet {
    /// Springs before anything burnt.
    whole: SpringLattice,
    /// Springs that are left.
    left: SpringLattice,
    /// What is left of the drawn triangles.
    remains: Vec<Remains>,
    /// Positions before anything moved (m).
    rest: Vec<Vector3<f64>>,
    /// Masses before anything burnt (kg).
    initial_masses: Vec<f64>,
    /// Particles in motion.
    pub motion: SpringMotion,
    /// Temperatures and shares of mass.
    pub fire: SpringFire,
    /// What burning does.
    pub effects: Effects,
    /// A hot sphere, and how it moves (m/s).
    pub ball: Option<(HeatBall, Vector3<f64>)>,
    /// Acceleration of everything (m/s2).
    pub gravity: Vector3<f64>,
    /// Share of its velocity that a particle keeps from step to step: drag of air, which the paper does not have.
    pub kept: f64,
    /// Settings of the projection.
    pub projection: Projection,
}

/// Mass (kg) that a particle keeps in motion when it has burnt away: of none the mended projection could not be
/// computed. As a share of that at the start.
const LEAST_MASS: f64 = 1e-3;

impl BurningSheet {
    /// A sheet at rest, with all of its mass.
    pub fn new(lattice: SpringLattice, motion: SpringMotion, fire: SpringFire) -> Self {
        Self {
            left: lattice.clone(),
            remains: Vec::new(),
            rest: motion.positions.clone(),
            initial_masses: motion.masses.clone(),
            whole: lattice,
            motion,
            fire,
            effects: Effects::Both,
            ball: None,
            gravity: Vector3::zeros(),
            kept: 1.0,
            projection: Projection::default(),
        }
    }

    /// One time step: heat, masses, removal, motion, in the paper's order.
    ///
    /// # Errors
    /// [`SpringError`] when a temperature is no number.
    pub fn step(&mut self) -> Result<ProjectionReport, SpringError> {
        let h = self.motion.time_step;
        let mut heating = vec![0.0; self.rest.len()];
        if let Some((ball, velocity)) = &mut self.ball {
            ball.centre += *velocity * h;
            ball.add_to(&mut heating, &self.motion.positions);
        }
        self.fire
            .step(&self.left, &self.motion.positions, &heating, h);
        let burnt = self.initial_masses.iter().zip(&self.fire.shares);
        let masses = burnt.map(|(mass, share)| mass * share.max(LEAST_MASS));
        self.motion.masses = masses.collect();
        self.remove()?;
        if self.effects != Effects::Removal {
            self.left.set_volume_shares(&self.fire.shares)?;
        }
        let gravity = self.gravity;
        let forces: Vec<Vector3<f64>> = self.motion.masses.iter().map(|m| gravity * *m).collect();
        let report = self.motion.step(&self.left, &self.projection, &forces);
        let velocities = &mut self.motion.velocities;
        velocities.iter_mut().for_each(|own| *own *= self.kept);
        Ok(report)
    }

    /// Takes away the springs of triangles that are gone, if any went in this step.
    fn remove(&mut self) -> Result<(), SpringError> {
        if self.effects == Effects::Shrinkage {
            return Ok(());
        }
        let remnant = self.cut(&self.rest);
        if remnant.remains != self.remains {
            self.left = remnant.springs(&self.whole)?;
            self.remains = remnant.remains;
        }
        Ok(())
    }

    /// What is left of the drawn mesh where the particles are.
    pub fn remnant(&self) -> Remnant {
        self.cut(&self.motion.positions)
    }

    /// What is left of the drawn mesh at other positions of the particles: at rest, or anything else with three
    /// numbers a particle that is to be known at its points.
    pub fn cut(&self, positions: &[Vector3<f64>]) -> Remnant {
        match self.effects {
            Effects::Shrinkage => {
                let all = vec![1.0; positions.len()];
                Remnant::new(&self.whole, positions, &all)
            }
            _ => Remnant::new(&self.whole, positions, &self.fire.relative_masses()),
        }
    }

    /// Positions before anything moved (m).
    pub fn rest(&self) -> &[Vector3<f64>] {
        &self.rest
    }

    /// Springs that are left.
    pub fn springs(&self) -> &SpringLattice {
        &self.left
    }
}
