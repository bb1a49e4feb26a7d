//! The unknowns of a layer and of the lattice below it, side by side.

use nalgebra::Matrix3;
use ruga_solver::{LowerPattern, SolverError};

/// Lower triangle of the Hessian by `[x, q]`: coordinates of the layer's vertices, then those of the
/// lattice's free nodes.
///
/// ```text
/// [ shell        .     ]   a shell's column goes on with the nodes that its vertex is coupled with;
/// [ cross     lattice  ]   the lattice's columns come last and are as they are in the lattice
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(crate) pattern: LowerPattern,
    /// Where each column of the shell starts in the shell's own values.
    layer_starts: Vec<usize>,
    /// Free nodes that each vertex is coupled with, ascending.
    cross: Vec<Vec<u32>>,
}

impl Layout {
    /// `shell` and `lattice` are column starts and rows.
    pub(crate) fn new(
        shell: (&[usize], &[usize]),
        cross: Vec<Vec<u32>>,
        lattice: (&[usize], &[usize]),
    ) -> Result<Self, SolverError> {
        let unknowns = 3 * cross.len();
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in 0..unknowns {
            rows.extend_from_slice(&shell.1[shell.0[column]..shell.0[column + 1]]);
            for &node in &cross[column / 3] {
                let first = unknowns + 3 * node as usize;
                rows.extend(first..first + 3);
            }
            starts.push(rows.len());
        }
        let body = rows.len();
        rows.extend(lattice.1.iter().map(|row| unknowns + row));
        starts.extend(lattice.0[1..].iter().map(|start| body + start));
        Ok(Self {
            pattern: LowerPattern::new(starts, rows)?,
            layer_starts: shell.0.to_vec(),
            cross,
        })
    }

    /// Coordinates of the layer's vertices.
    pub(crate) fn layer_unknowns(&self) -> usize {
        3 * self.cross.len()
    }

    /// Whether any vertex is coupled with nodes.
    pub(crate) fn is_coupled(&self) -> bool {
        self.cross.iter().any(|nodes| !nodes.is_empty())
    }

    /// The lattice's part of the values.
    pub(crate) fn body<'v>(&self, values: &'v mut [f64]) -> &'v mut [f64] {
        let start = self.pattern.column_starts()[self.layer_unknowns()];
        &mut values[start..]
    }

    /// Adds a Hessian in the order of the shell's own pattern.
    pub(crate) fn add_layer(&self, shell: &[f64], values: &mut [f64]) {
        let starts = self.pattern.column_starts();
        for (column, range) in self.layer_starts.windows(2).enumerate() {
            let own = &shell[range[0]..range[1]];
            let target = &mut values[starts[column]..starts[column] + own.len()];
            for (target, value) in target.iter_mut().zip(own) {
                *target += value;
            }
        }
    }

    /// Adds to the block of a vertex with itself.
    pub(crate) fn add_vertex(&self, vertex: usize, block: &Matrix3<f64>, values: &mut [f64]) {
        for c in 0..3 {
            let start = self.pattern.column_starts()[3 * vertex + c];
            for r in c..3 {
                values[start + r - c] += block[(r, c)];
            }
        }
    }

    /// Adds to the block of a vertex (rows) with a free node that it is coupled with (columns).
    pub(crate) fn add_cross(
        &self,
        vertex: usize,
        node: u32,
        block: &Matrix3<f64>,
        values: &mut [f64],
    ) {
        let Ok(rank) = self.cross[vertex].binary_search(&node) else {
            return;
        };
        let behind = 3 * (self.cross[vertex].len() - rank);
        for c in 0..3 {
            let first = self.pattern.column_starts()[3 * vertex + c + 1] - behind;
            for r in 0..3 {
                values[first + r] += block[(c, r)];
            }
        }
    }
}
