//! Where each 3×3 block of the Hessian lies among the values of its lower triangle.

use nalgebra::{Matrix3, Vector3};

/// Marks a pinned vertex.
const PINNED: u32 = u32::MAX;

/// Lower triangle, diagonal included, in compressed columns over the free vertices.
///
/// Free vertices keep their order; free vertex `j` has the columns `3j`, `3j + 1`, `3j + 2` for x,
/// y, z. Below its diagonal block, each neighbour block holds three consecutive rows per column:
///
/// ```text
/// column 3j    : d d d  a a a  b b b        the three columns have stride, stride - 1
/// column 3j + 1:   d d  a a a  b b b        and stride - 2 entries,
/// column 3j + 2:     d  a a a  b b b        so that no search is ever needed
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub(crate) free_of: Vec<u32>,
    pub(crate) free_vertices: Vec<u32>,
    pub(crate) column_starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    neighbours: Vec<Vec<u32>>,
    diagonals: Vec<Slot>,
}

/// Place of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    /// Index of the block's first entry.
    start: u32,
    /// Entries of the column vertex's first column.
    stride: u32,
    placement: Placement,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Placement {
    AsIs,
    Transposed,
    /// One of the vertices is pinned.
    Absent,
}

impl Pattern {
    /// `pairs` lists every two vertices that share a stencil, in any order, repeats allowed.
    pub(crate) fn new(pinned: &[bool], pairs: impl Iterator<Item = [u32; 2]>) -> Self {
        let free_vertices: Vec<u32> = (0..pinned.len() as u32)
            .filter(|&v| !pinned[v as usize])
            .collect();
        let mut free_of = vec![PINNED; pinned.len()];
        for (free, &vertex) in free_vertices.iter().enumerate() {
            free_of[vertex as usize] = free as u32;
        }
        let mut neighbours = vec![Vec::new(); free_vertices.len()];
        for [a, b] in pairs {
            let (a, b) = (free_of[a as usize], free_of[b as usize]);
            if a != PINNED && b != PINNED {
                neighbours[a.min(b) as usize].push(a.max(b));
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        Self::lay_out(free_of, free_vertices, neighbours)
    }

    fn lay_out(free_of: Vec<u32>, free_vertices: Vec<u32>, neighbours: Vec<Vec<u32>>) -> Self {
        let mut column_starts = vec![0];
        let mut rows = Vec::new();
        let mut diagonals = Vec::with_capacity(neighbours.len());
        for (j, below) in neighbours.iter().enumerate() {
            diagonals.push(Slot {
                start: rows.len() as u32,
                stride: 3 + 3 * below.len() as u32,
                placement: Placement::AsIs,
            });
            for c in 0..3 {
                rows.extend(3 * j + c..3 * j + 3);
                for &i in below {
                    rows.extend(3 * i as usize..3 * i as usize + 3);
                }
                column_starts.push(rows.len());
            }
        }
        Self {
            free_of,
            free_vertices,
            column_starts,
            rows,
            neighbours,
            diagonals,
        }
    }

    /// Free index of a vertex, if it is free.
    #[inline]
    pub(crate) fn free(&self, vertex: u32) -> Option<usize> {
        let free = self.free_of[vertex as usize];
        (free != PINNED).then_some(free as usize)
    }

    /// Slot of the block (row vertex, column vertex), for two different vertices of one stencil.
    pub(crate) fn slot(&self, row: u32, column: u32) -> Slot {
        let absent = Slot {
            start: 0,
            stride: 0,
            placement: Placement::Absent,
        };
        let (Some(row), Some(column)) = (self.free(row), self.free(column)) else {
            return absent;
        };
        let (low, high) = (row.min(column), row.max(column));
        let Ok(rank) = self.neighbours[low].binary_search(&(high as u32)) else {
            return absent;
        };
        let diagonal = self.diagonals[low];
        Slot {
            start: diagonal.start + 3 + 3 * rank as u32,
            stride: diagonal.stride,
            placement: if row > column {
                Placement::AsIs
            } else {
                Placement::Transposed
            },
        }
    }

    /// Adds forces on vertices to a vector over the free ones' coordinates.
    #[inline]
    pub(crate) fn add_forces(
        &self,
        gradient: &mut [f64],
        vertices: &[u32],
        forces: &[Vector3<f64>],
    ) {
        for (&vertex, force) in vertices.iter().zip(forces) {
            if let Some(free) = self.free(vertex) {
                let target = &mut gradient[3 * free..3 * free + 3];
                target[0] += force.x;
                target[1] += force.y;
                target[2] += force.z;
            }
        }
    }

    /// Adds the lower triangle of a vertex's own block.
    #[inline]
    pub(crate) fn add_diagonal(&self, values: &mut [f64], vertex: u32, block: &Matrix3<f64>) {
        let free = self.free_of[vertex as usize];
        if free == PINNED {
            return;
        }
        let slot = self.diagonals[free as usize];
        let first = slot.start as usize;
        let second = first + slot.stride as usize;
        let third = second + slot.stride as usize - 1;
        values[first] += block.m11;
        values[first + 1] += block.m21;
        values[first + 2] += block.m31;
        values[second] += block.m22;
        values[second + 1] += block.m32;
        values[third] += block.m33;
    }

    /// Adds the block of two different vertices.
    #[inline]
    pub(crate) fn add_block(values: &mut [f64], slot: Slot, block: &Matrix3<f64>) {
        let block = match slot.placement {
            Placement::AsIs => *block,
            Placement::Transposed => block.transpose(),
            Placement::Absent => return,
        };
        let first = slot.start as usize;
        let second = first + slot.stride as usize - 1;
        let third = second + slot.stride as usize - 2;
        for (column, start) in [first, second, third].into_iter().enumerate() {
            let target = &mut values[start..start + 3];
            target[0] += block[(0, column)];
            target[1] += block[(1, column)];
            target[2] += block[(2, column)];
        }
    }
}
