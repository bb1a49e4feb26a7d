//! The symmetric matrix of an energy over vertices: where each 3×3 block of it is stored.

use std::sync::{Arc, OnceLock};

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Points that a thread takes at least: more than a part of a layer has, which one thread solves alone.
const AT_ONCE: usize = 1 << 15;

/// Marks a pinned vertex.
const PINNED: u32 = u32::MAX;

/// Sparsity of a symmetric matrix between points that have three coordinates each, the vertices of a
/// mesh or the nodes of a lattice: lower triangle, diagonal included, in compressed columns over the
/// points that are not pinned.
///
/// Free points keep their order; free point `j` has the columns `3j`, `3j + 1`, `3j + 2` for x, y,
/// z. Below its diagonal block, each neighbour block holds three consecutive rows per column:
///
/// ```text
/// column 3j    : d d d  a a a  b b b        the three columns have stride, stride - 1
/// column 3j + 1:   d d  a a a  b b b        and stride - 2 entries,
/// column 3j + 2:     d  a a a  b b b        so only the neighbour's rank is searched for
/// ```
///
/// Stencils that are assembled again and again look their blocks up once, as [`BlockSlot`]s.
///
/// # Panics
/// Methods that take a point panic when there is none of that number, and those that make a pattern when it has more
/// than 2³² - 1 entries.
#[derive(Clone, Debug)]
pub struct BlockPattern {
    // A mark instead of an option, which would double the table.
    free_of: Vec<u32>,
    free_points: Vec<u32>,
    // Shared with the solver.
    column_starts: Arc<[usize]>,
    /// Written when they are first asked for.
    rows: OnceLock<Arc<[u32]>>,
    /// Per free point the neighbours with higher numbers, ascending.
    neighbours: Vec<Vec<u32>>,
}

/// Place of one block among the values.
#[derive(Clone, Copy, Debug)]
pub struct BlockSlot {
    /// Index of the block's first entry.
    start: u32,
    /// Entries of the column point's first column; in the two lowest bits the placement.
    shape: u32,
}

/// Where a block lies.
#[derive(Clone, Copy, Debug)]
enum Placement {
    Diagonal = 0,
    BelowDiagonal = 1,
    /// The block is stored as its mirror image.
    AboveDiagonal = 2,
    /// One of the points is pinned, or no stencil couples them.
    Absent = 3,
}

impl BlockSlot {
    /// A slot in eight bytes: assembly reads one for every block of every stencil, and a layer with a matrix keeps
    /// them all.
    fn new(start: usize, stride: usize, placement: Placement) -> Self {
        debug_assert!(stride < 1 << 30, "a column of {stride} entries");
        Self {
            start: start as u32,
            shape: (stride as u32) << 2 | placement as u32,
        }
    }

    fn placement(self) -> Placement {
        match self.shape & 3 {
            0 => Placement::Diagonal,
            1 => Placement::BelowDiagonal,
            2 => Placement::AboveDiagonal,
            _ => Placement::Absent,
        }
    }
}

impl BlockPattern {
    /// The pattern that couples each free point with itself, and all points of each stencil.
    pub fn new<'a>(pinned: &[bool], stencils: impl Iterator<Item = &'a [u32]>) -> Self {
        let free_points: Vec<u32> = (0..pinned.len() as u32)
            .filter(|&point| !pinned[point as usize])
            .collect();
        let mut free_of = vec![PINNED; pinned.len()];
        for (free, &point) in free_points.iter().enumerate() {
            free_of[point as usize] = free as u32;
        }
        let mut this = Self {
            free_of,
            column_starts: Arc::default(),
            rows: OnceLock::new(),
            neighbours: vec![Vec::new(); free_points.len()],
            free_points,
        };
        this.widen(stencils);
        this
    }

    /// Couples all points of more stencils; slots and value arrays made before don't fit any more.
    pub fn widen<'a>(&mut self, stencils: impl Iterator<Item = &'a [u32]>) {
        let Self {
            free_of,
            neighbours,
            ..
        } = self;
        for stencil in stencils {
            let free = || {
                let numbers = stencil.iter().map(|&point| free_of[point as usize]);
                numbers.filter(|&free| free != PINNED)
            };
            for low in free() {
                neighbours[low as usize].extend(free().filter(|&high| high > low));
            }
        }
        let tidy = |list: &mut Vec<u32>| {
            list.sort_unstable();
            list.dedup();
            // A vertex is named ten times as often as it has neighbours.
            list.shrink_to_fit();
        };
        let lists = neighbours.par_iter_mut().with_min_len(AT_ONCE);
        lists.for_each(tidy);
        self.lay_out();
    }

    /// The pattern over the points of `self` and then those of `other`, with the free ones of `other`
    /// that each free point of `self` is coupled with, ascending.
    pub fn beside(&self, other: &Self, coupled: &[Vec<u32>]) -> Self {
        let (points, free) = (self.free_of.len() as u32, self.free_points.len() as u32);
        let shifted = |numbers: &[u32], by: u32| -> Vec<u32> {
            let shift = |&number: &u32| {
                if number == PINNED {
                    PINNED
                } else {
                    number + by
                }
            };
            numbers.iter().map(shift).collect()
        };
        let own = self.neighbours.iter().zip(coupled);
        // Numbers of `other` come after all of `self`, so a joined list is ascending again.
        let own = own.map(|(near, far)| [near.as_slice(), &shifted(far, free)].concat());
        let others = other.neighbours.iter().map(|list| shifted(list, free));
        let mut this = Self {
            free_of: [self.free_of.as_slice(), &shifted(&other.free_of, free)].concat(),
            free_points: [
                self.free_points.as_slice(),
                &shifted(&other.free_points, points),
            ]
            .concat(),
            column_starts: Arc::default(),
            rows: OnceLock::new(),
            neighbours: own.chain(others).collect(),
        };
        this.lay_out();
        this
    }

    fn lay_out(&mut self) {
        let (mut starts, mut entries) = (vec![0], 0);
        for below in &self.neighbours {
            for own in [3, 2, 1] {
                entries += own + 3 * below.len();
                starts.push(entries);
            }
        }
        assert!(
            u32::try_from(entries).is_ok(),
            "{entries} entries are too many"
        );
        self.column_starts = starts.into();
        self.rows = OnceLock::new();
    }

    fn written_rows(&self) -> &Arc<[u32]> {
        self.rows.get_or_init(|| {
            let mut rows = Vec::with_capacity(self.column_starts.last().copied().unwrap_or(0));
            for (j, below) in (0..).zip(&self.neighbours) {
                for c in 0..3 {
                    rows.extend(3 * j + c..3 * j + 3);
                    for &i in below {
                        rows.extend(3 * i..3 * i + 3);
                    }
                }
            }
            rows.into()
        })
    }

    /// Number of points, pinned ones included.
    pub fn point_count(&self) -> usize {
        self.free_of.len()
    }

    /// The free points; the `k`-th has the unknowns `3k`, `3k + 1`, `3k + 2`.
    pub fn free_points(&self) -> &[u32] {
        &self.free_points
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        3 * self.free_points.len()
    }

    /// Start of each column in [`rows`](Self::rows); one more than there are unknowns.
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Row of each entry, sorted within each column.
    pub fn rows(&self) -> &[u32] {
        self.written_rows()
    }

    /// Column starts and rows, to be kept beside the pattern without a copy.
    pub fn shared(&self) -> (Arc<[usize]>, Arc<[u32]>) {
        (
            Arc::clone(&self.column_starts),
            Arc::clone(self.written_rows()),
        )
    }

    /// Number of a point among the free ones, if it is free.
    #[inline]
    pub fn free(&self, point: u32) -> Option<usize> {
        let free = self.free_of[point as usize];
        (free != PINNED).then_some(free as usize)
    }

    /// Slot of the block (row point, column point).
    pub fn slot(&self, row: u32, column: u32) -> BlockSlot {
        let absent = BlockSlot::new(0, 0, Placement::Absent);
        let (Some(row), Some(column)) = (self.free(row), self.free(column)) else {
            return absent;
        };
        // The lower triangle keeps a block in the column of its lower point.
        let (low, high) = (row.min(column), row.max(column));
        let first = self.column_starts[3 * low];
        let stride = self.column_starts[3 * low + 1] - first;
        let slot = |start: usize, placement| BlockSlot::new(start, stride, placement);
        if row == column {
            return slot(first, Placement::Diagonal);
        }
        match self.neighbours[low].binary_search(&(high as u32)) {
            Ok(rank) if row > column => slot(first + 3 + 3 * rank, Placement::BelowDiagonal),
            Ok(rank) => slot(first + 3 + 3 * rank, Placement::AboveDiagonal),
            Err(_) => absent,
        }
    }

    /// Slots of a stencil's blocks `(i, j)`, `j <= i`, row by row.
    pub fn stencil_slots(&self, points: &[u32]) -> impl Iterator<Item = BlockSlot> {
        let pairs = (0..points.len()).flat_map(|i| (0..=i).map(move |j| [i, j]));
        pairs.map(|[i, j]| self.slot(points[i], points[j]))
    }

    /// The matrix with these values times one vector per free point.
    ///
    /// # Panics
    /// When there are fewer values than entries, or vectors than free points.
    pub fn product(&self, values: &[f64], v: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let (rows, mut product) = (self.rows(), vec![Vector3::zeros(); v.len()]);
        for (column, range) in self.column_starts.windows(2).enumerate() {
            let (j, c) = (column / 3, column % 3);
            let entries = range[0]..range[1];
            for (&row, value) in rows[entries.clone()].iter().zip(&values[entries]) {
                let row = row as usize;
                let (i, r) = (row / 3, row % 3);
                product[i][r] += value * v[j][c];
                // An entry below the diagonal stands for its mirror image as well.
                if row != column {
                    product[j][c] += value * v[i][r];
                }
            }
        }
        product
    }

    /// Adds forces on points to a vector over the free ones' coordinates.
    #[inline]
    pub fn add_forces(&self, gradient: &mut [f64], points: &[u32], forces: &[Vector3<f64>]) {
        for (&point, force) in points.iter().zip(forces) {
            if let Some(free) = self.free(point) {
                let target = &mut gradient[3 * free..3 * free + 3];
                target[0] += force.x;
                target[1] += force.y;
                target[2] += force.z;
            }
        }
    }
}

impl BlockSlot {
    /// Adds a block to the values of a matrix: nothing where it is absent, and of one on the diagonal
    /// the lower triangle.
    #[inline]
    pub fn add(self, values: &mut [f64], block: &Matrix3<f64>) {
        let (first, stride) = (self.start as usize, (self.shape >> 2) as usize);
        let block = match self.placement() {
            Placement::BelowDiagonal => *block,
            Placement::AboveDiagonal => block.transpose(),
            Placement::Absent => return,
            Placement::Diagonal => {
                let (second, third) = (first + stride, first + 2 * stride - 1);
                values[first] += block.m11;
                values[first + 1] += block.m21;
                values[first + 2] += block.m31;
                values[second] += block.m22;
                values[second + 1] += block.m32;
                values[third] += block.m33;
                return;
            }
        };
        // Each column holds one entry less of the diagonal block than the one before, so this block
        // lies one, then two entries nearer to the start of its column.
        let columns = [first, first + stride - 1, first + 2 * stride - 3];
        for (column, start) in columns.into_iter().enumerate() {
            let target = &mut values[start..start + 3];
            target[0] += block[(0, column)];
            target[1] += block[(1, column)];
            target[2] += block[(2, column)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A layer of 17 thousand vertices has two million of them.
    #[test]
    fn slots_are_small() {
        assert_eq!(size_of::<BlockSlot>(), 8);
    }
}
