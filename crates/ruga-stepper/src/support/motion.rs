//! One step in time, as an energy.

use nalgebra::Vector3;

use crate::Dynamics;

/// `1/2 w (x - c)' M (x - c)`, which a step of implicit Euler adds to the elastic energy.
///
/// With step `h`, damping `d` and the state `x0, v0` before, the positions after solve
/// `M (x - x0 - h v0) / h^2 + d M (x - x0) / h = f(x)`: Li 2014, eq. 5.2, for end positions instead
/// of velocities and without its linearisation. That is the minimum for `w = (1 + d h) / h^2` and
/// `c = x0 + h v0 / (1 + d h)`. With a body's mass it is the whole of Rémillard and Kry 2013, eq. 15,
/// whose right side leaves out what the mass does after the first iteration.
#[derive(Clone, Debug)]
pub(crate) struct Inertia {
    dynamics: Dynamics,
    /// Positions that everything would reach without forces, m.
    pub(crate) centres: Vec<Vector3<f64>>,
}

impl Inertia {
    /// A step from `start` (m) with these velocities (m/s).
    pub(crate) fn new(
        dynamics: Dynamics,
        start: &[Vector3<f64>],
        velocities: &[Vector3<f64>],
    ) -> Self {
        let Dynamics { time_step, damping } = dynamics;
        // Damping is implicit as well, so that no step is too long for it.
        let slowed = 1.0 + damping * time_step;
        let end = |(x, v): (&Vector3<f64>, &Vector3<f64>)| x + v * (time_step / slowed);
        Self {
            dynamics,
            centres: start.iter().zip(velocities).map(end).collect(),
        }
    }

    /// The same step of some of its places, which have these centres (m).
    pub(crate) fn of_part(&self, centres: Vec<Vector3<f64>>) -> Self {
        let dynamics = self.dynamics;
        Self { dynamics, centres }
    }

    /// Length of the step, s.
    pub(crate) fn time_step(&self) -> f64 {
        self.dynamics.time_step
    }

    /// Stiffness that stands for a mass (kg), N/m; of a mass of one, `w`.
    pub(crate) fn weight(&self, mass: f64) -> f64 {
        let Dynamics { time_step, damping } = self.dynamics;
        mass * (1.0 + damping * time_step) / (time_step * time_step)
    }

    /// Displacements to `x` from where everything would go without forces, m.
    pub(crate) fn displacements(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        x.iter().zip(&self.centres).map(|(x, c)| x - c).collect()
    }
}

/// Velocities (m/s) after a step of so many seconds.
pub(crate) fn velocities(
    start: &[Vector3<f64>],
    end: &[Vector3<f64>],
    time_step: f64,
) -> Vec<Vector3<f64>> {
    let pairs = start.iter().zip(end);
    pairs
        // In implicit Euler the mean over a step is the velocity at its end.
        .map(|(start, end)| (end - start) / time_step)
        .collect()
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
            let (mut x, mut v) = (vec![Vector3::x()], vec![Vector3::zeros()]);
            for _ in 0..(0.3 / time_step).round() as usize {
                let inertia = Inertia::new(dynamics, &x, &v);
                let (weight, centre) = (inertia.weight(mass), inertia.centres[0]);
                // The minimum of the spring's energy and the step's.
                let next = vec![centre * (weight / (weight + stiffness))];
                v = velocities(&x, &next, time_step);
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
