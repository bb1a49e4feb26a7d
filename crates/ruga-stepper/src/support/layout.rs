//! The unknowns of a layer and of the lattice below it, side by side.

use ruga_mesh::BlockPattern;
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
    /// The same by blocks: the layer's vertices, then all nodes.
    pub(crate) blocks: BlockPattern,
    /// Where each column of the shell starts in the shell's own values.
    layer_starts: Vec<usize>,
}

impl Layout {
    /// `coupled` are the free nodes that each vertex of the layer is coupled with, ascending.
    pub(crate) fn new(
        layer: &BlockPattern,
        lattice: &BlockPattern,
        coupled: &[Vec<u32>],
    ) -> Result<Self, SolverError> {
        let blocks = layer.beside(lattice, coupled);
        let (starts, rows) = blocks.shared();
        Ok(Self {
            pattern: LowerPattern::new(starts, rows)?,
            blocks,
            layer_starts: layer.column_starts().to_vec(),
        })
    }

    /// Coordinates of the layer's vertices.
    pub(crate) fn layer_unknowns(&self) -> usize {
        self.layer_starts.len() - 1
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
}
