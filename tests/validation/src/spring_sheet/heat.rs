//! Heat, loss of mass, and what both make of springs: the paper's sections 5 and 6.

use nalgebra::Vector3;

use super::conduction::Conduction;
use super::lattice::SpringLattice;
use super::projection::SpringColour;

/// How heat and mass depend on each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BurnRule {
    /// Eq. (1) and (4) as they stand. With `dm < 0` burning cools; the rate goes by the mass at the start, so that
    /// nothing stops it but the cold, and a particle may end with less than no mass; and no heat is lost.
    Printed,
    /// What burns heats. No more burns than there is above the least mass, and heat is lost in proportion to what the
    /// particle is hotter than its surroundings.
    Mended,
}

/// What a sheet is made of. The paper gives no value of any of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuel {
    /// How heat and mass depend on each other.
    pub rule: BurnRule,
    /// Diffusivity, the paper's alpha (m2/s).
    pub diffusivity: f64,
    /// Temperature above which mass is lost (K).
    pub ignition: f64,
    /// Share of the mass at the start that is lost per second and kelvin above ignition, the paper's mu (1/(K s)).
    pub rate: f64,
    /// Change of temperature (K) with which all of a particle's mass is lost: the paper's `eta` times its mass at the
    /// start. The paper's eta is in K/kg, so that the same paper in finer particles would burn less hot.
    pub rise: f64,
    /// Temperature to which heat is lost (K), and the time (s) in which all but `1/e` of it is; mended rule alone.
    pub loss: Option<(f64, f64)>,
    /// Share of mass at which a particle vanishes, the paper's `m_loss` over the mass at the start. Below
    /// `least_share` nothing vanishes.
    pub loss_share: f64,
    /// Least share of mass that a particle can have, the paper's `m_min` over the mass at the start. As printed, no
    /// equation knows it.
    pub least_share: f64,
}

/// A hot sphere, the paper's *heat ball*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatBall {
    /// Its centre (m).
    pub centre: Vector3<f64>,
    /// Its radius (m).
    pub radius: f64,
    /// What it adds to the temperature of particles in it (K/s). The paper's `T_ext` is this times the time step.
    pub heating: f64,
}

impl HeatBall {
    /// Adds to the heating (K/s) of the particles whose positions (m) are in the ball.
    pub fn add_to(&self, heating: &mut [f64], positions: &[Vector3<f64>]) {
        for (own, position) in heating.iter_mut().zip(positions) {
            if (position - self.centre).norm() <= self.radius {
                *own += self.heating;
            }
        }
    }
}

/// What burning has left of a spring, by the relative masses `m' = m - m_loss` at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringState {
    /// Neither end is burnt: the spring is there, and shorter by what both have lost.
    Shrunk,
    /// One end is burnt: the spring is cut, eq. (7).
    PartlyBurnt,
    /// Both ends are burnt.
    Burnt,
}

impl SpringState {
    /// The state by the relative masses of both ends. The paper prints `m'_1 = m_0 - m_loss`, where it must be `m_1`,
    /// and leaves open what an end with a relative mass of zero beside one below is; here that counts as cut.
    pub fn of(ends: [f64; 2]) -> Self {
        match ends.map(|own| own >= 0.0) {
            [true, true] => Self::Shrunk,
            [false, false] => Self::Burnt,
            _ => Self::PartlyBurnt,
        }
    }
}

/// Temperatures and masses of a sheet's particles. Masses are shares of those at the start.
#[derive(Clone, Debug)]
pub struct SpringFire {
    /// What the sheet is made of.
    pub fuel: Fuel,
    /// Temperature of every particle (K).
    pub temperatures: Vec<f64>,
    /// Share of mass left in every particle.
    pub shares: Vec<f64>,
    /// Weight of the rate in every particle: the paper's texture, 0 to 1.
    pub weights: Vec<f64>,
    /// What the step before lost, of which eq. (1) has the heat.
    lost: Vec<f64>,
}

impl SpringFire {
    /// So many particles with all of their mass at one temperature (K).
    pub fn new(fuel: Fuel, particles: usize, temperature: f64) -> Self {
        Self {
            fuel,
            temperatures: vec![temperature; particles],
            shares: vec![1.0; particles],
            weights: vec![1.0; particles],
            lost: vec![0.0; particles],
        }
    }

    /// One step of `h` seconds: heat by eq. (1) and (2), along the springs of `lattice` at `positions` (m), then mass by
    /// eq. (4). `heating` (K/s) is what comes from outside: heat balls, or a heat texture.
    ///
    /// # Panics
    /// When there are fewer positions or heatings than particles.
    pub fn step(
        &mut self,
        lattice: &SpringLattice,
        positions: &[Vector3<f64>],
        heating: &[f64],
        h: f64,
    ) {
        let springs = SpringColour::ALL.map(|colour| lattice.set(colour).ends());
        let ends = springs.into_iter().flatten().copied();
        let sign = match self.fuel.rule {
            BurnRule::Printed => -1.0,
            BurnRule::Mended => 1.0,
        };
        for (i, temperature) in self.temperatures.iter_mut().enumerate() {
            *temperature += h * heating[i] + sign * self.fuel.rise * self.lost[i];
            if let (BurnRule::Mended, Some((surroundings, time))) = (self.fuel.rule, self.fuel.loss)
            {
                // Implicit Euler, so that no step is too long.
                *temperature -= (*temperature - surroundings) * h / (time + h);
            }
        }
        let reach = self.fuel.diffusivity * h;
        Conduction::new(ends, positions).step(reach, &mut self.temperatures);
        for i in 0..self.shares.len() {
            let above = (self.temperatures[i] - self.fuel.ignition).max(0.0);
            let asked = h * self.fuel.rate * self.weights[i] * above;
            self.lost[i] = match self.fuel.rule {
                BurnRule::Printed => asked,
                BurnRule::Mended => asked.min((self.shares[i] - self.fuel.least_share).max(0.0)),
            };
            self.shares[i] -= self.lost[i];
        }
    }

    /// Relative mass of every particle, as a share of the mass at the start: negative where it is burnt.
    pub fn relative_masses(&self) -> Vec<f64> {
        let relative = |share: &f64| share - self.fuel.loss_share;
        self.shares.iter().map(relative).collect()
    }
}
