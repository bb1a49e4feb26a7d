//! Successive fast projection: one set after another, over and over.

use nalgebra::Vector3;

use super::conjugate_gradient::Solver;
use super::lattice::SpringLattice;

/// The four sets of springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringColour {
    /// From a centre to the corners of its cell.
    Red,
    /// From centre to centre.
    Green,
    /// From corner to corner along edges.
    Blue,
    /// From corner to corner across a cell.
    Yellow,
}

impl SpringColour {
    /// All of them, in the order in which the paper projects.
    pub const ALL: [Self; 4] = [Self::Red, Self::Green, Self::Blue, Self::Yellow];
}

/// How projection treats each particle: its weight in the matrix, and the share of its move that it makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    pub(super) counted: Vec<f64>,
    pub(super) moved: Vec<f64>,
}

impl Mobility {
    /// The printed way, eq. (16): no masses, and held particles count in the matrix as if they could move, of which
    /// only the step is left out. The numbers of the paper's table 1 come out in this way and in no other.
    pub fn printed(held: &[bool]) -> Self {
        Self {
            counted: vec![1.0; held.len()],
            moved: held.iter().map(|&own| f64::from(!own)).collect(),
        }
    }

    /// No masses, but held particles are left out of the matrix as well: each projection is then a Newton step.
    pub fn without_held(held: &[bool]) -> Self {
        let moved: Vec<f64> = held.iter().map(|&own| f64::from(!own)).collect();
        Self {
            counted: moved.clone(),
            moved,
        }
    }

    /// The mended way: `(G M^-1 G^T) lambda = C, x <- x - M^-1 G^T lambda`, as in Goldenthal et al. 2007, from whom the
    /// paper has the method. It keeps momentum whatever the masses (kg); a particle without mass is held.
    pub fn by_mass(masses: &[f64]) -> Self {
        // The scale of the masses cancels between matrix and step; one of 1 keeps the system as well scaled as printed.
        let most = masses.iter().copied().fold(0.0, f64::max);
        let inverse = |&mass: &f64| if mass > 0.0 { most / mass } else { 0.0 };
        let moved: Vec<f64> = masses.iter().map(inverse).collect();
        Self {
            counted: moved.clone(),
            moved,
        }
    }
}

/// Settings of [`fast_projection`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Most projection steps, each on to all four sets. The paper takes 7.
    pub steps: usize,
    /// Largest `|C|/l` at which projection stops before. The paper prints 1e-7 and does not say of what; 0 makes all
    /// steps.
    pub threshold: f64,
    /// Weight of blue and yellow springs, eq. (19): 1 in the paper but for a tenth in its figure 10 (d).
    pub weight: f64,
    /// Order of the sets.
    pub order: [SpringColour; 4],
}

impl Default for Projection {
    fn default() -> Self {
        Self {
            steps: 7,
            threshold: 1e-7,
            weight: 1.0,
            order: SpringColour::ALL,
        }
    }
}

/// What a fast projection came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProjectionReport {
    /// Norms of the constraints of red, green, blue and yellow springs (m), before the first step and after each.
    pub errors: Vec<[f64; 4]>,
    /// Whether the threshold was reached.
    pub converged: bool,
    /// Iterations of conjugate gradients, over all sets and steps.
    pub iterations: usize,
}

impl ProjectionReport {
    /// Steps in which the sum of the norms over the four sets rose, of which the paper says that there are none.
    pub fn rises(&self) -> usize {
        let sums: Vec<f64> = self.errors.iter().map(|own| own.iter().sum()).collect();
        sums.windows(2).filter(|pair| pair[1] > pair[0]).count()
    }
}

/// Projects positions (m) on to the four sets of a lattice in turn, eq. (18).
///
/// Does nothing when there are fewer positions or mobilities than particles.
pub fn fast_projection(
    lattice: &SpringLattice,
    mobility: &Mobility,
    settings: &Projection,
    positions: &mut [Vector3<f64>],
    solver: &mut Solver,
) -> ProjectionReport {
    project_and_correct(lattice, mobility, settings, positions, solver, &mut |_| ())
}

/// Projects in the same way, and corrects the positions (m) before the first step and after each.
///
/// So collisions cannot be undone by the projection, eq. (14); the constraints may be, which the paper grants.
pub(super) fn project_and_correct(
    lattice: &SpringLattice,
    mobility: &Mobility,
    settings: &Projection,
    positions: &mut [Vector3<f64>],
    solver: &mut Solver,
    correct: &mut dyn FnMut(&mut [Vector3<f64>]),
) -> ProjectionReport {
    let mut report = ProjectionReport::default();
    if positions.len().min(mobility.moved.len()) < lattice.particle_count() {
        return report;
    }
    correct(positions);
    let mut is_done = report.record(lattice, positions, settings.threshold);
    for _ in 0..settings.steps {
        if is_done {
            break;
        }
        for colour in settings.order {
            let weight = match colour {
                SpringColour::Blue | SpringColour::Yellow => settings.weight,
                SpringColour::Red | SpringColour::Green => 1.0,
            };
            let set = lattice.set(colour);
            report.iterations += set.project(positions, mobility, weight, solver);
        }
        correct(positions);
        is_done = report.record(lattice, positions, settings.threshold);
    }
    report.converged = is_done;
    report
}

impl ProjectionReport {
    /// Notes the norms of all constraints; says whether none is above the threshold.
    fn record(
        &mut self,
        lattice: &SpringLattice,
        positions: &[Vector3<f64>],
        threshold: f64,
    ) -> bool {
        let mut most = 0.0_f64;
        let norms = SpringColour::ALL.map(|colour| {
            let set = lattice.set(colour);
            let constraints = set.constraints(positions).zip(set.target_lengths());
            let squares = constraints.map(|(constraint, length)| {
                most = most.max((constraint / length).abs());
                constraint * constraint
            });
            squares.sum::<f64>().sqrt()
        });
        self.errors.push(norms);
        most <= threshold
    }
}
