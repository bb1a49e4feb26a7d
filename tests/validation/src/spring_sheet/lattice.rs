//! The body-centred square of a quadrilateral mesh.

use nalgebra::Vector3;

use super::projection::SpringColour;
use super::spring_set::{SpringError, SpringSet};

/// Least share of volume of a particle. The paper has a least mass `m_min` without a value; a spring without
/// length has no gradient.
pub const LEAST_SHARE: f64 = 1e-3;

/// Which particles the springs of a sheet join, and their lengths: corners first, then a centre for each cell.
#[derive(Clone, Debug)]
pub struct SpringLattice {
    corners: usize,
    cells: Vec<[u32; 4]>,
    /// Red, green, blue, yellow.
    sets: [SpringSet; 4],
    /// Drawn triangles beside the springs of every set.
    beside: [Vec<Beside>; 4],
}

/// Drawn triangles that a spring lies between or above: two, or all four of its cell if it is yellow, or one at a
/// border. Number `4 c + k` lies at side `k` of cell `c`.
pub(super) type Beside = [Option<u32>; 4];

impl SpringLattice {
    /// Turns quadrilaterals into a lattice and gives its particles' positions (m).
    ///
    /// Centres lie above the mean of their corners by `thickness` (m), along the normal of the two diagonals; corners go
    /// round a cell.
    ///
    /// # Errors
    /// [`SpringError`], also for quadrilateral meshes with more than four edges at a corner.
    pub fn new(
        mut positions: Vec<Vector3<f64>>,
        cells: Vec<[u32; 4]>,
        thickness: f64,
    ) -> Result<(Self, Vec<Vector3<f64>>), SpringError> {
        let corners = positions.len();
        for (element, cell) in cells.iter().enumerate() {
            let is_twice = (0..4).any(|i| cell[..i].contains(&cell[i]));
            if is_twice || cell.iter().any(|&p| p as usize >= corners) {
                let particles = corners;
                return Err(SpringError::Ends { element, particles });
            }
            let [a, b, c, d] = cell.map(|p| positions[p as usize]);
            let normal = (c - a).cross(&(d - b));
            // A cell without area has no normal, and its centre stays in the plane.
            let up = normal.try_normalize(0.0).unwrap_or_default();
            positions.push((a + b + c + d) * 0.25 + up * thickness);
        }
        let (edges, sides) = edges(&cells)?;
        let centre = |side: u32| corners as u32 + side / 4;
        let two = |[a, b]: [Option<u32>; 2]| [a, b, None, None];
        let inner = sides.iter().filter_map(|side| Some([side[0]?, side[1]?]));
        let green = inner.clone().map(|side| side.map(centre));
        let beside = [
            corner_triangles(cells.len()),
            inner.map(|side| two(side.map(Some))).collect(),
            sides.iter().copied().map(two).collect(),
            cell_triangles(cells.len()),
        ];
        let numbered = || cells.iter().zip(0..);
        let red = numbered().flat_map(|(cell, i)| cell.map(|p| [centre(4 * i), p]));
        let yellow = cells.iter().flat_map(|&[a, b, c, d]| [[a, c], [b, d]]);
        let set = |ends: Vec<[u32; 2]>| {
            let length = |ends: &[u32; 2]| {
                let [a, b] = ends.map(|p| positions[p as usize]);
                (a - b).norm()
            };
            let lengths = ends.iter().map(length).collect();
            SpringSet::new(ends, lengths, positions.len())
        };
        let sets = [
            set(red.collect())?,
            set(green.collect())?,
            set(edges)?,
            set(yellow.collect())?,
        ];
        let lattice = Self {
            corners,
            cells,
            sets,
            beside,
        };
        Ok((lattice, positions))
    }

    /// A flat rectangle around the origin of so many square cells along x and y, of side `cell` (m), centres above.
    ///
    /// # Errors
    /// [`SpringError`] when `cell` is not a positive length.
    pub fn rectangle(
        [columns, rows]: [usize; 2],
        cell: f64,
        thickness: f64,
    ) -> Result<(Self, Vec<Vector3<f64>>), SpringError> {
        let middle = [columns, rows].map(|count| 0.5 * count as f64);
        let place = |i: usize, j: usize| {
            Vector3::new(i as f64 - middle[0], j as f64 - middle[1], 0.0) * cell
        };
        // Row by row along the shorter side, so that what belongs together lies together in memory.
        let positions = (0..=columns).flat_map(|i| (0..=rows).map(move |j| place(i, j)));
        let at = |i: usize, j: usize| (i * (rows + 1) + j) as u32;
        let square = |i, j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let cells = (0..columns).flat_map(|i| (0..rows).map(move |j| square(i, j)));
        Self::new(positions.collect(), cells.collect(), thickness)
    }

    /// Springs of one set.
    pub fn set(&self, colour: SpringColour) -> &SpringSet {
        &self.sets[colour as usize]
    }

    /// Springs of all sets.
    pub fn spring_count(&self) -> usize {
        self.sets.iter().map(|set| set.ends().len()).sum()
    }

    /// Corner particles, which come first.
    pub fn corner_count(&self) -> usize {
        self.corners
    }

    /// Corners and centres.
    pub fn particle_count(&self) -> usize {
        self.corners + self.cells.len()
    }

    /// Corners of the cells.
    pub fn cells(&self) -> &[[u32; 4]] {
        &self.cells
    }

    /// Leaves out the springs beside which no drawn triangle is there any more.
    ///
    /// # Errors
    /// None for a lattice that was valid.
    pub(super) fn without_burnt(
        &self,
        is_there: impl Fn(u32) -> bool,
    ) -> Result<Self, SpringError> {
        let mut lattice = self.clone();
        for (set, beside) in lattice.sets.iter_mut().zip(&mut lattice.beside) {
            let is_kept = |own: &Beside| own.iter().flatten().any(|&triangle| is_there(triangle));
            let kept: Vec<bool> = beside.iter().map(is_kept).collect();
            *set = set.retain(&kept)?;
            beside.retain(is_kept);
        }
        Ok(lattice)
    }

    /// Gives every spring its target length by the shares of volume left at its ends, eq. (6).
    ///
    /// Eq. (5) has `v = (m/rho)/(m_init/rho_init)`; without a change of density, as in the paper's figures, that is
    /// the share of mass. Shares are taken within [`LEAST_SHARE`] and 1.
    ///
    /// # Errors
    /// [`SpringError::Ends`] when there are not as many shares as particles, [`SpringError::Share`] for one that is no
    /// number.
    pub fn set_volume_shares(&mut self, shares: &[f64]) -> Result<(), SpringError> {
        let particles = self.particle_count();
        if shares.len() != particles {
            let element = shares.len();
            return Err(SpringError::Ends { element, particles });
        }
        if let Some(particle) = shares.iter().position(|share| share.is_nan()) {
            return Err(SpringError::Share { particle });
        }
        let within = |share: &f64| share.clamp(LEAST_SHARE, 1.0);
        let shares: Vec<f64> = shares.iter().map(within).collect();
        for set in &mut self.sets {
            set.shrink(&shares);
        }
        Ok(())
    }
}

/// Triangles beside red springs, corner by corner: at the side before the corner and at that after it.
fn corner_triangles(cells: usize) -> Vec<Beside> {
    let cells = 0..cells as u32;
    cells
        .flat_map(|c| {
            [3, 0, 1, 2].map(|k| [Some(4 * c + k), Some(4 * c + (k + 1) % 4), None, None])
        })
        .collect()
}

/// Triangles below yellow springs, two springs a cell.
fn cell_triangles(cells: usize) -> Vec<Beside> {
    let all = |c: u32| [0, 1, 2, 3].map(|k| Some(4 * c + k));
    (0..cells as u32).flat_map(|c| [all(c); 2]).collect()
}

/// Edges of quadrilaterals with the sides that lie along each: number `4 c + k` is the side of cell `c` after its
/// corner `k`.
type Edges = (Vec<[u32; 2]>, Vec<[Option<u32>; 2]>);

fn edges(cells: &[[u32; 4]]) -> Result<Edges, SpringError> {
    let mut sides = Vec::with_capacity(4 * cells.len());
    for (cell, i) in cells.iter().zip(0..) {
        for k in 0..4_u32 {
            let [p, q] = [k, (k + 1) % 4].map(|k| cell[k as usize]);
            sides.push(([p.min(q), p.max(q)], 4 * i + k));
        }
    }
    sides.sort_unstable();
    let mut edges = Vec::new();
    let mut along = Vec::new();
    for own in sides.chunk_by(|a, b| a.0 == b.0) {
        let edge = own[0].0;
        along.push(match own {
            [(_, first)] => [Some(*first), None],
            [(_, first), (_, second)] => [Some(*first), Some(*second)],
            _ => return Err(SpringError::Edge { edge }),
        });
        edges.push(edge);
    }
    Ok((edges, along))
}
