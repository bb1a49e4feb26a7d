//! One set of springs: what it joins, how long it ought to be, and its projection.

use nalgebra::Vector3;
use thiserror::Error;

use super::conjugate_gradient::{NEIGHBOURS, Solver};
use super::projection::Mobility;

/// Springs of one set that may meet at a particle. The paper's matrix has seven entries a row: a spring and three
/// more at either end. With more than six neighbours, it says, the projection does not converge.
const STAR: usize = 4;

/// What is wrong with a spring sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SpringError {
    /// A spring or a cell names a particle that is not there, or one twice.
    #[error("element {element} has no distinct particles among the {particles} there are")]
    Ends {
        /// Number of the spring or cell.
        element: usize,
        /// Particles that there are.
        particles: usize,
    },
    /// More than four springs of one set meet.
    #[error("more than four springs of one set meet at particle {particle}")]
    Star {
        /// The particle at which they meet.
        particle: u32,
    },
    /// More than two cells share an edge.
    #[error("more than two cells share the edge from {} to {}", edge[0], edge[1])]
    Edge {
        /// Its ends.
        edge: [u32; 2],
    },
    /// A share of volume is no number.
    #[error("the share of volume of particle {particle} is no number")]
    Share {
        /// The particle.
        particle: usize,
    },
    /// A spring has no length, or one that is not a number.
    #[error("spring {spring} has no length")]
    Length {
        /// Number of the spring.
        spring: usize,
    },
}

/// Springs whose constraints are solved at once.
#[derive(Clone, Debug)]
pub struct SpringSet {
    /// Particles between which there are springs.
    particles: usize,
    ends: Vec<[u32; 2]>,
    initial: Vec<f64>,
    target: Vec<f64>,
    /// Springs with which each shares its first end (three places) and its second (three more). An empty place
    /// holds the spring itself.
    neighbours: Vec<[u32; NEIGHBOURS]>,
    /// 1 where a neighbour begins or ends at the shared particle as the spring does, -1 where not, 0 for empty places.
    signs: Vec<[f64; NEIGHBOURS]>,
}

impl SpringSet {
    /// A set of springs between `particles` particles, each of the length (m) that it has at first.
    ///
    /// # Errors
    /// [`SpringError`]: ends that are not there, lengths that are not positive, particles with more than four springs.
    pub fn new(
        ends: Vec<[u32; 2]>,
        lengths: Vec<f64>,
        particles: usize,
    ) -> Result<Self, SpringError> {
        let mut stars: Vec<Vec<u32>> = vec![Vec::new(); particles];
        for (spring, own) in ends.iter().enumerate() {
            let length = lengths.get(spring).copied().unwrap_or(f64::NAN);
            if !(length > 0.0 && length.is_finite()) {
                return Err(SpringError::Length { spring });
            }
            if own[0] == own[1] || own.iter().any(|&p| p as usize >= particles) {
                let element = spring;
                return Err(SpringError::Ends { element, particles });
            }
            for &particle in own {
                let star = &mut stars[particle as usize];
                star.push(spring as u32);
                if star.len() > STAR {
                    return Err(SpringError::Star { particle });
                }
            }
        }
        let mut neighbours = Vec::with_capacity(ends.len());
        let mut signs = Vec::with_capacity(ends.len());
        for (spring, own) in ends.iter().enumerate() {
            let mut columns = [spring as u32; NEIGHBOURS];
            let mut factors = [0.0; NEIGHBOURS];
            for (end, &particle) in own.iter().enumerate() {
                let star = stars[particle as usize].iter();
                let others = star.filter(|&&other| other as usize != spring);
                for (k, &other) in others.enumerate() {
                    let is_alike = ends[other as usize][end] == particle;
                    columns[3 * end + k] = other;
                    factors[3 * end + k] = if is_alike { 1.0 } else { -1.0 };
                }
            }
            neighbours.push(columns);
            signs.push(factors);
        }
        Ok(Self {
            particles,
            ends,
            target: lengths.clone(),
            initial: lengths,
            neighbours,
            signs,
        })
    }

    /// Particles at the ends of every spring.
    pub fn ends(&self) -> &[[u32; 2]] {
        &self.ends
    }

    /// Length that every spring ought to have (m).
    pub fn target_lengths(&self) -> &[f64] {
        &self.target
    }

    /// Gives every spring another target length (m), if there are as many and they are positive.
    ///
    /// # Errors
    /// [`SpringError::Length`] otherwise.
    pub fn set_target_lengths(&mut self, lengths: &[f64]) -> Result<(), SpringError> {
        let is_length = |l: &f64| *l > 0.0 && l.is_finite();
        let first = lengths.iter().position(|l| !is_length(l));
        let missing = (lengths.len() != self.ends.len()).then_some(lengths.len());
        if let Some(spring) = first.or(missing) {
            return Err(SpringError::Length { spring });
        }
        self.target.copy_from_slice(lengths);
        Ok(())
    }

    /// Gives every spring the length that the shares of volume at its ends leave it, eq. (6).
    ///
    /// The paper takes a share of volume for a share of length. As printed.
    pub(super) fn shrink(&mut self, shares: &[f64]) {
        for ((target, initial), ends) in self.target.iter_mut().zip(&self.initial).zip(&self.ends) {
            let [v0, v1] = ends.map(|p| shares[p as usize]);
            *target = initial * (0.5 * (v0 + v1));
        }
    }

    /// Keeps the springs that `kept` says, with their lengths.
    ///
    /// # Errors
    /// None for a set that was valid; the type is that of [`SpringSet::new`], which this calls.
    pub(super) fn retain(&self, kept: &[bool]) -> Result<Self, SpringError> {
        let is_kept = |i: &usize| kept.get(*i).copied().unwrap_or(true);
        let springs: Vec<usize> = (0..self.ends.len()).filter(is_kept).collect();
        let ends = springs.iter().map(|&i| self.ends[i]).collect();
        let initial = springs.iter().map(|&i| self.initial[i]).collect();
        let mut set = Self::new(ends, initial, self.particles)?;
        set.target = springs.iter().map(|&i| self.target[i]).collect();
        Ok(set)
    }

    /// Constraints, eq. (10), at positions (m).
    ///
    /// # Panics
    /// When there are fewer positions than particles.
    pub fn constraints<'a>(
        &'a self,
        positions: &'a [Vector3<f64>],
    ) -> impl Iterator<Item = f64> + 'a {
        self.ends.iter().zip(&self.target).map(|(ends, length)| {
            let [a, b] = ends.map(|p| positions[p as usize]);
            (a - b).norm_squared() / length - length
        })
    }

    /// Root of the mean square of length over target, less one.
    ///
    /// # Panics
    /// When there are fewer positions than particles.
    pub fn strain(&self, positions: &[Vector3<f64>]) -> f64 {
        let springs = self.ends.iter().zip(&self.target);
        let squares = springs.map(|(ends, length)| {
            let [a, b] = ends.map(|p| positions[p as usize]);
            ((a - b).norm() / length - 1.0).powi(2)
        });
        (squares.sum::<f64>() / self.ends.len().max(1) as f64).sqrt()
    }

    /// One projection on to the set, eq. (16, 17, 19); gives the iterations of conjugate gradients.
    ///
    /// `weight` is the paper's W. Its text divides by it, its formula multiplies; only multiplying makes a sheet
    /// of small weights soft, as its figure 10 has it.
    ///
    /// Does nothing when there are fewer positions or mobilities than particles.
    pub fn project(
        &self,
        positions: &mut [Vector3<f64>],
        mobility: &Mobility,
        weight: f64,
        solver: &mut Solver,
    ) -> usize {
        if positions.len().min(mobility.moved.len()) < self.particles {
            return 0;
        }
        self.linearise(positions, mobility, weight, solver);
        let iterations = solver.solve(&self.neighbours);
        let moves = solver.gradients.iter().zip(&solver.solution);
        for (&[a, b], (gradient, lambda)) in self.ends.iter().zip(moves) {
            let [a, b] = [a as usize, b as usize];
            positions[a] -= gradient * (lambda * mobility.moved[a]);
            positions[b] += gradient * (lambda * mobility.moved[b]);
        }
        iterations
    }

    /// Sets up gradients, matrix and right-hand side.
    fn linearise(
        &self,
        positions: &[Vector3<f64>],
        mobility: &Mobility,
        weight: f64,
        solver: &mut Solver,
    ) {
        solver.gradients.clear();
        solver.right.clear();
        for (ends, length) in self.ends.iter().zip(&self.target) {
            let [a, b] = ends.map(|p| positions[p as usize]);
            let along = a - b;
            solver.gradients.push(along * (2.0 / length));
            let constraint = along.norm_squared() / length - length;
            solver.right.push(weight * constraint);
        }
        solver.diagonal.clear();
        solver.values.clear();
        let gradients = &solver.gradients;
        for (i, gradient) in gradients.iter().enumerate() {
            let [a, b] = self.ends[i].map(|p| mobility.counted[p as usize]);
            let (columns, signs) = (&self.neighbours[i], &self.signs[i]);
            solver.diagonal.push((a + b) * gradient.norm_squared());
            solver.values.push(std::array::from_fn(|k| {
                let shared = if k < NEIGHBOURS / 2 { a } else { b };
                signs[k] * shared * gradient.dot(&gradients[columns[k] as usize])
            }));
        }
    }
}
