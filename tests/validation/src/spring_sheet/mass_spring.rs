//! Springs that pull by Hooke's law, with which the paper compares its projection in figure 7.

use nalgebra::Vector3;

use super::collider::Collider;
use super::lattice::SpringLattice;
use super::projection::SpringColour;
use super::time_step::TIME_STEP;

/// Share of the stiffness at which explicit steps would begin to explode.
const SAFETY: f64 = 0.8;

/// Most springs at a particle: four of each of three colours at a corner; a centre has two colours.
const STAR: f64 = 12.0;

/// A mass-spring system on the particles and springs of a lattice, in explicit steps: `v += h F/m, x += h v`.
///
/// The paper says nothing of its stiffness. Here it is as stiff as explicit steps allow, which is the only choice that
/// favours neither side: `k = 0.8 (4/h^2) m/(2 n)` for `n = 12` springs at a particle of mass `m` and time step `h`.
#[derive(Clone, Debug)]
pub struct MassSpring {
    /// Where the particles are (m).
    pub positions: Vec<Vector3<f64>>,
    /// How they move (m/s).
    pub velocities: Vec<Vector3<f64>>,
    /// Mass of each (kg).
    pub mass: f64,
    /// Length of a time step (s).
    pub time_step: f64,
    /// What particles do not enter.
    pub colliders: Vec<Collider>,
}

impl MassSpring {
    /// Particles at rest, in steps of 2 ms.
    pub fn at_rest(positions: Vec<Vector3<f64>>, mass: f64) -> Self {
        Self {
            velocities: vec![Vector3::zeros(); positions.len()],
            positions,
            mass,
            time_step: TIME_STEP,
            colliders: Vec::new(),
        }
    }

    /// Force over change of length, of every spring (N/m).
    pub fn stiffness(&self) -> f64 {
        SAFETY * 4.0 * self.mass / (self.time_step * self.time_step * 2.0 * STAR)
    }

    /// One step in time with one acceleration (m/s2) of all particles.
    pub fn step(&mut self, lattice: &SpringLattice, acceleration: Vector3<f64>) {
        let h = self.time_step;
        let pull = self.stiffness() * h / self.mass;
        self.velocities
            .iter_mut()
            .for_each(|own| *own += acceleration * h);
        for colour in SpringColour::ALL {
            let set = lattice.set(colour);
            for (ends, length) in set.ends().iter().zip(set.target_lengths()) {
                let [a, b] = ends.map(|p| p as usize);
                let way = self.positions[b] - self.positions[a];
                let now = way.norm();
                if now > 0.0 {
                    let push = way * (pull * (now - length) / now);
                    self.velocities[a] += push;
                    self.velocities[b] -= push;
                }
            }
        }
        for (position, velocity) in self.positions.iter_mut().zip(&self.velocities) {
            *position += velocity * h;
        }
        let held = vec![false; self.positions.len()];
        let (mut pushes, still) = (vec![0.0; held.len()], vec![0.0; held.len()]);
        for own in &mut self.colliders {
            own.advance(h);
            own.correct_positions(&mut self.positions, &held, &mut pushes);
            // Pushes change no velocity here, so all of what goes inwards is still in it.
            own.correct_velocities(&mut self.velocities, &self.positions, &still);
        }
    }
}
