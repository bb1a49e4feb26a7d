//! Sparsity of the lattice's Hessian and assembly into its lower triangle.

use nalgebra::Matrix3;

/// Marks a pinned node.
const PINNED: u32 = u32::MAX;

/// Lower triangle, diagonal included, in compressed columns over the free nodes.
///
/// Free nodes keep their order; free node `j` has the columns `3j`, `3j + 1`, `3j + 2` for x, y,
/// z. Below its diagonal block, each neighbour block holds three consecutive rows per column:
///
/// ```text
/// column 3j    : d d d  a a a  b b b        the three columns have stride, stride - 1
/// column 3j + 1:   d d  a a a  b b b        and stride - 2 entries,
/// column 3j + 2:     d  a a a  b b b        so only the neighbour's rank is searched for
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    free_of: Vec<u32>,
    pub(crate) free_nodes: Vec<u32>,
    pub(crate) column_starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    /// Per free node the neighbours with higher numbers, ascending.
    neighbours: Vec<Vec<u32>>,
}

impl Pattern {
    /// Couples all nodes of each stencil.
    pub(crate) fn new<'a>(pinned: &[bool], stencils: impl Iterator<Item = &'a [u32]>) -> Self {
        let free_nodes: Vec<u32> = (0..pinned.len() as u32)
            .filter(|&node| !pinned[node as usize])
            .collect();
        let mut free_of = vec![PINNED; pinned.len()];
        for (free, &node) in free_nodes.iter().enumerate() {
            free_of[node as usize] = free as u32;
        }
        let mut this = Self {
            free_of,
            column_starts: Vec::new(),
            rows: Vec::new(),
            neighbours: vec![Vec::new(); free_nodes.len()],
            free_nodes,
        };
        this.widen(stencils);
        this
    }

    /// Couples all nodes of more stencils.
    pub(crate) fn widen<'a>(&mut self, stencils: impl Iterator<Item = &'a [u32]>) {
        let Self {
            free_of,
            neighbours,
            ..
        } = self;
        for stencil in stencils {
            let free = || {
                let numbers = stencil.iter().map(|&node| free_of[node as usize]);
                numbers.filter(|&free| free != PINNED)
            };
            for low in free() {
                neighbours[low as usize].extend(free().filter(|&high| high > low));
            }
        }
        for list in neighbours.iter_mut() {
            list.sort_unstable();
            list.dedup();
        }
        (self.column_starts, self.rows) = lay_out(&self.neighbours);
    }

    /// Number of a node among the free ones.
    #[inline]
    pub(crate) fn free(&self, node: u32) -> Option<usize> {
        let free = self.free_of[node as usize];
        (free != PINNED).then_some(free as usize)
    }

    pub(crate) fn node_count(&self) -> usize {
        self.free_of.len()
    }

    /// Adds a stencil's symmetric matrix: its blocks `(i, j)`, `j <= i`, row by row.
    pub(crate) fn add_stencil(&self, values: &mut [f64], nodes: &[u32], blocks: &[Matrix3<f64>]) {
        let mut blocks = blocks.iter();
        for (i, &row) in nodes.iter().enumerate() {
            for (&column, block) in nodes[..=i].iter().zip(&mut blocks) {
                self.add(values, row, column, block);
            }
        }
    }

    /// Adds one block, or its mirror image if that is the one below the diagonal.
    ///
    /// Blocks of pinned nodes are left out, as are those outside the pattern.
    pub(crate) fn add(&self, values: &mut [f64], row: u32, column: u32, block: &Matrix3<f64>) {
        let (Some(row), Some(column)) = (self.free(row), self.free(column)) else {
            return;
        };
        if row == column {
            for c in 0..3 {
                let start = self.column_starts[3 * column + c];
                for r in c..3 {
                    values[start + r - c] += block[(r, c)];
                }
            }
            return;
        }
        let (low, high) = (row.min(column), row.max(column));
        let Ok(rank) = self.neighbours[low].binary_search(&(high as u32)) else {
            return;
        };
        for c in 0..3 {
            // The column's part of the diagonal block comes first.
            let start = self.column_starts[3 * low + c] + 3 - c + 3 * rank;
            for r in 0..3 {
                let entry = if row > column { (r, c) } else { (c, r) };
                values[start + r] += block[entry];
            }
        }
    }
}

fn lay_out(neighbours: &[Vec<u32>]) -> (Vec<usize>, Vec<usize>) {
    let mut column_starts = vec![0];
    let mut rows = Vec::new();
    for (j, below) in neighbours.iter().enumerate() {
        for c in 0..3 {
            rows.extend(3 * j + c..3 * j + 3);
            for &i in below {
                rows.extend(3 * i as usize..3 * i as usize + 3);
            }
            column_starts.push(rows.len());
        }
    }
    (column_starts, rows)
}
