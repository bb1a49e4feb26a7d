//! One step in time, as an energy.

use nalgebra::Vector3;

use crate::Dynamics;

/// Velocities, and what they make of the next step.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    dynamics: Dynamics,
    /// Mass of every vertex, kg.
    masses: Vec<f64>,
    /// Velocity of every vertex, m/s.
    velocities: Vec<Vector3<f64>>,
}

/// `1/2 sum w |x - c|^2`, which implicit Euler adds to the elastic energy.
///
/// With step `h`, damping `d` and the state `x0, v0` before, the positions after solve
/// `m (x - x0 - h v0) / h^2 + m d (x - x0) / h = f(x)`: Li 2014, eq. 5.2, for end positions instead
/// of velocities and without its linearisation. That is the minimum for `w = m (1 + d h) / h^2` and
/// `c = x0 + h v0 / (1 + d h)`.
#[derive(Clone, Debug)]
pub(crate) struct Inertia {
    /// Weight of every vertex, N/m.
    pub(crate) weights: Vec<f64>,
    /// Where every vertex would go without forces, m.
    pub(crate) centres: Vec<Vector3<f64>>,
}

impl Motion {
    /// At rest.
    pub(crate) fn new(dynamics: Dynamics, masses: Vec<f64>) -> Self {
        Self {
            dynamics,
            velocities: vec![Vector3::zeros(); masses.len()],
            masses,
        }
    }

    /// What a step from `start` adds to the energy.
    pub(crate) fn inertia(&self, start: &[Vector3<f64>]) -> Inertia {
        let Dynamics { time_step, damping } = self.dynamics;
        let slowed = 1.0 + damping * time_step;
        let ways = self.velocities.iter().map(|v| v * (time_step / slowed));
        Inertia {
            weights: self
                .masses
                .iter()
                .map(|mass| mass * slowed / (time_step * time_step))
                .collect(),
            centres: start.iter().zip(ways).map(|(x, way)| x + way).collect(),
        }
    }

    /// Takes over the velocities of a step from `start` to `end`.
    pub(crate) fn moved(&mut self, start: &[Vector3<f64>], end: &[Vector3<f64>]) {
        let pairs = start.iter().zip(end);
        self.velocities = pairs
            .map(|(start, end)| (end - start) / self.dynamics.time_step)
            .collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a spring falls into its rest as `x'' + d x' + k x / m = 0`, to first order in the
    /// step.
    #[test]
    fn a_damped_oscillator_follows_its_solution() {
        let (stiffness, mass, damping) = (400.0, 1.0, 8.0);
        let end = |time_step: f64| {
            let dynamics = Dynamics { time_step, damping };
            let mut motion = Motion::new(dynamics, vec![mass]);
            let mut x = vec![Vector3::x()];
            for _ in 0..(0.3 / time_step).round() as usize {
                let inertia = motion.inertia(&x);
                let (weight, centre) = (inertia.weights[0], inertia.centres[0]);
                // The minimum of the spring's energy and the step's.
                let next = vec![centre * (weight / (weight + stiffness))];
                motion.moved(&x, &next);
                x = next;
            }
            x[0].x
        };
        let frequency = (stiffness / mass - 0.25 * damping * damping).sqrt();
        let phase = 0.3 * frequency;
        let decay = (-0.5 * damping * 0.3_f64).exp();
        let exact = decay * (phase.cos() + 0.5 * damping / frequency * phase.sin());
        let [coarse, fine] = [1e-3, 5e-4].map(|step| (end(step) - exact).abs());
        assert!(
            fine < 0.01 && (coarse / fine - 2.0).abs() < 0.1,
            "{coarse} {fine}"
        );
    }
}
