//! Minimises a plate's energy by L-BFGS in the metric of its linear resistance.
//!
//! With heights scaled by `sqrt(D k^4 + K(k))` every wave of the unstrained plate is equally
//! stiff, and from the flat state the critical wave grows first. In plain heights shorter waves do.

use std::collections::VecDeque;

use rustfft::num_complex::Complex64;

use super::height_field::noise;
use super::plate::Plate;

/// When [`Plate::relax`] stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxSettings {
    /// Squared gradient, in the metric of the linear resistance, over `C eps_c^2`; about the energy
    /// that is still to gain, over twice the scale of the energy gap.
    pub tolerance: f64,
    /// Steps of one descent at most.
    pub max_iterations: usize,
    /// Size of the noise (m) that a state which looks like a minimum is disturbed with, to leave it
    /// if it is a saddle; 0 for none.
    pub kick: f64,
    /// Seed of that noise.
    pub seed: u64,
}

impl RelaxSettings {
    /// Those of a film of some thickness, m.
    pub fn new(thickness: f64) -> Self {
        Self {
            tolerance: 1e-7,
            max_iterations: 3000,
            kick: 1e-2 * thickness,
            seed: 1,
        }
    }
}

/// How a relaxation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxed {
    /// Energy per area less that of the flat plate, J/m^2.
    pub energy_gap: f64,
    /// What is compared with [`RelaxSettings::tolerance`].
    pub residual: f64,
    /// Steps.
    pub iterations: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
}

/// Disturbances of one relaxation at most.
const MAX_KICKS: u64 = 20;

/// Steps in which a disturbance has grown if there is anything for it to grow on.
const STEPS_AFTER_KICK: usize = 60;

/// Decrease of the energy over `C eps_c^2 / 2` that tells a saddle from a minimum.
const SADDLE: f64 = 1e-4;

/// Steps that the curvature is remembered from.
const MEMORY: usize = 12;

/// A pair of steps and the change of gradient over it, with the inverse of their product.
type Pair = (Vec<Complex64>, Vec<Complex64>, f64);

impl Plate {
    /// Moves heights (m, row after row) to a minimum of the energy under mean compressive strains
    /// along x and y.
    pub fn relax(
        &self,
        heights: &mut [f64],
        strain: [f64; 2],
        settings: &RelaxSettings,
    ) -> Relaxed {
        let saddle = SADDLE * 0.5 * self.energy_scale();
        let mut reached = self.descend(heights, strain, settings, 0);
        for kick in 0..MAX_KICKS {
            if settings.kick == 0.0 {
                break;
            }
            let mut disturbed = noise(&self.grid, settings.kick, settings.seed + kick);
            for (d, h) in disturbed.iter_mut().zip(&*heights) {
                *d += h;
            }
            let next = self.descend(&mut disturbed, strain, settings, STEPS_AFTER_KICK);
            let gain = reached.energy_gap - next.energy_gap;
            let iterations = reached.iterations + next.iterations;
            if gain > 0.0 {
                heights.copy_from_slice(&disturbed);
                reached = next;
            }
            reached.iterations = iterations;
            if gain < saddle {
                break;
            }
        }
        reached
    }

    /// `C eps_c^2`, J/m^2.
    fn energy_scale(&self) -> f64 {
        self.film.membrane_stiffness * self.film.critical_strain.powi(2)
    }

    /// At least `least` steps of L-BFGS. The mean of the heights is not changed.
    fn descend(
        &self,
        heights: &mut [f64],
        strain: [f64; 2],
        settings: &RelaxSettings,
        least: usize,
    ) -> Relaxed {
        let scales: Vec<f64> = self.resistance.iter().map(|r| r.sqrt()).collect();
        let [start, _] = self.grid.coefficients([heights, heights]);
        let mut x: Vec<_> = start.iter().zip(&scales).map(|(h, s)| h * s).collect();
        let evaluate = |x: &[Complex64]| {
            // The mean feels no force and may have no resistance.
            let inverse = |mode: usize| if mode == 0 { 0.0 } else { 1.0 / scales[mode] };
            let mut heights: Vec<_> = (0..x.len()).map(|mode| x[mode] * inverse(mode)).collect();
            heights[0] = start[0];
            let (energy, mut gradient) = self.energy(&heights, strain);
            for (mode, g) in gradient.iter_mut().enumerate() {
                *g *= inverse(mode);
            }
            (energy, gradient, heights)
        };
        let scale = self.energy_scale();
        let (mut energy, mut gradient, mut now) = evaluate(&x);
        let mut pairs: VecDeque<Pair> = VecDeque::new();
        let mut residual = dot(&gradient, &gradient) / scale;
        let mut iterations = 0;
        while (residual > settings.tolerance || iterations < least)
            && iterations < settings.max_iterations
        {
            iterations += 1;
            let mut step = direction(&gradient, &pairs);
            let mut slope = dot(&gradient, &step);
            if slope >= 0.0 {
                pairs.clear();
                step = gradient.iter().map(|g| -g).collect();
                slope = -dot(&gradient, &gradient);
            }
            let mut length = 1.0;
            let found = loop {
                let trial: Vec<_> = x.iter().zip(&step).map(|(x, p)| x + p * length).collect();
                let (reached, at, heights) = evaluate(&trial);
                if reached <= energy + 1e-4 * length * slope {
                    break Some((trial, reached, at, heights));
                }
                length *= 0.5;
                if length < 1e-12 {
                    break None;
                }
            };
            let Some((trial, reached, at, heights)) = found else {
                break;
            };
            let moved: Vec<_> = trial.iter().zip(&x).map(|(a, b)| a - b).collect();
            let changed: Vec<_> = at.iter().zip(&gradient).map(|(a, b)| a - b).collect();
            let product = dot(&moved, &changed);
            // A pair without curvature would make the next direction climb.
            if product > 1e-10 * dot(&changed, &changed) {
                pairs.push_back((moved, changed, 1.0 / product));
            }
            if pairs.len() > MEMORY {
                pairs.pop_front();
            }
            (x, energy, gradient, now) = (trial, reached, at, heights);
            residual = dot(&gradient, &gradient) / scale;
        }
        let [field, _] = self.grid.fields([&now, &vec![Complex64::ZERO; now.len()]]);
        heights.copy_from_slice(&field);
        Relaxed {
            energy_gap: energy - self.flat_energy(strain),
            residual,
            iterations,
            converged: residual <= settings.tolerance,
        }
    }
}

/// The two-loop recursion of L-BFGS (Nocedal 1980).
fn direction(gradient: &[Complex64], pairs: &VecDeque<Pair>) -> Vec<Complex64> {
    let mut p: Vec<_> = gradient.iter().map(|g| -g).collect();
    let mut shares = Vec::with_capacity(pairs.len());
    for (moved, changed, inverse) in pairs.iter().rev() {
        let share = inverse * dot(moved, &p);
        add(&mut p, changed, -share);
        shares.push(share);
    }
    if let Some((_, changed, inverse)) = pairs.back() {
        let scale = 1.0 / (inverse * dot(changed, changed));
        for p in &mut p {
            *p *= scale;
        }
    }
    for ((moved, changed, inverse), share) in pairs.iter().zip(shares.iter().rev()) {
        let other = inverse * dot(changed, &p);
        add(&mut p, moved, share - other);
    }
    p
}

fn add(target: &mut [Complex64], other: &[Complex64], factor: f64) {
    for (t, o) in target.iter_mut().zip(other) {
        *t += o * factor;
    }
}

fn dot(a: &[Complex64], b: &[Complex64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.re * b.re + a.im * b.im)
        .sum()
}
