//! The stiffness of an embedded surface as the nodes feel it.

use nalgebra::Matrix3;

use crate::error::check_length;
use crate::{Embedding, LatticeEnergy, LatticeError};

/// Sparsity of the Hessian of a surface's energy over some points of an embedding.
///
/// The `k`-th of `points` has the unknowns `3k`, `3k + 1`, `3k + 2`. The Hessian is symmetric and
/// given by its lower triangle in compressed columns.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePattern<'a> {
    /// Points that the surface's unknowns belong to.
    pub points: &'a [u32],
    /// Where each column starts in `rows`; one more than there are unknowns.
    pub column_starts: &'a [usize],
    /// Row of each entry.
    pub rows: &'a [usize],
}

impl SurfacePattern<'_> {
    fn check(&self, embedding: &Embedding) -> Result<(), LatticeError> {
        let unknowns = 3 * self.points.len();
        check_length("column starts", unknowns + 1, self.column_starts.len())?;
        let columns = self.column_starts.windows(2);
        if let Some(column) = columns.into_iter().position(|pair| pair[0] > pair[1]) {
            return Err(LatticeError::ColumnStarts { column });
        }
        let entries = self.column_starts[unknowns];
        check_length("rows of the surface's Hessian", entries, self.rows.len())?;
        if let Some(&row) = self.rows.iter().find(|&&row| row >= unknowns) {
            return check_length("unknowns of the surface", row + 1, unknowns);
        }
        let points = embedding.point_count();
        match self.points.iter().find(|&&point| point as usize >= points) {
            None => Ok(()),
            Some(&point) => check_length("embedded points", point as usize + 1, points),
        }
    }

    /// The entries of the three columns of a point: other point, row and column within the block,
    /// index.
    fn entries(&self, point: usize) -> impl Iterator<Item = (usize, [usize; 2], usize)> + '_ {
        (0..3).flat_map(move |column| {
            let start = self.column_starts[3 * point + column];
            let end = self.column_starts[3 * point + column + 1];
            (start..end).map(move |k| (self.rows[k] / 3, [self.rows[k] % 3, column], k))
        })
    }
}

impl LatticeEnergy {
    /// Widens the pattern by the nodes that a surface couples, for [`Self::add_pulled_back`].
    ///
    /// A stencil of the surface that reaches across a border couples nodes that no element has in
    /// common. Value arrays made for the former pattern don't fit any more.
    ///
    /// # Errors
    /// [`LatticeError::Length`] or [`LatticeError::ColumnStarts`] when the arrays of the pattern
    /// contradict each other, or the embedding; [`LatticeError::Length`] for an embedding in another
    /// lattice than the energy's.
    pub fn couple_surface(
        &mut self,
        embedding: &Embedding,
        surface: &SurfacePattern,
    ) -> Result<(), LatticeError> {
        surface.check(embedding)?;
        let nodes = self.blocks().node_count();
        check_length("nodes of the embedding", nodes, embedding.node_count())?;
        let mut stencils = Vec::new();
        for (column, &point) in surface.points.iter().enumerate() {
            let mut nodes: Vec<u32> = embedding.nodes(point).collect();
            let mut last = column;
            for (row, _, _) in surface.entries(column) {
                if row != last {
                    nodes.extend(embedding.nodes(surface.points[row]));
                    last = row;
                }
            }
            nodes.sort_unstable();
            nodes.dedup();
            stencils.push(nodes);
        }
        // Most points of an element couple the same nodes.
        stencils.sort_unstable();
        stencils.dedup();
        self.blocks_mut().widen(stencils.iter().map(Vec::as_slice));
        Ok(())
    }

    /// Adds `B^T K B` to a Hessian in the order of [`Self::pattern`] (RK 6.2, eq. 15), for a
    /// surface stiffness `K` with the given values.
    ///
    /// # Panics
    /// When the surface is not one that [`Self::couple_surface`] accepted, or arrays have wrong
    /// lengths.
    pub fn add_pulled_back(
        &self,
        embedding: &Embedding,
        surface: &SurfacePattern,
        values: &[f64],
        hessian: &mut [f64],
    ) {
        assert_eq!(values.len(), surface.rows.len(), "one value per entry");
        assert_eq!(hessian.len(), self.pattern().1.len(), "in pattern order");
        let mut product = NodeRows::new(self.blocks().node_count());
        let mut sum = ElementSum::new(self.blocks().node_count());
        // Points of one element come one after the other: what they add to its nodes is looked up
        // in the pattern only once.
        let mut order: Vec<usize> = (0..surface.points.len()).collect();
        let nodes = |k: &usize| embedding.nodes(surface.points[*k]).collect::<Vec<u32>>();
        order.sort_by_cached_key(nodes);
        for group in order.chunk_by(|a, b| nodes(a) == nodes(b)) {
            for &column in group {
                let point = surface.points[column];
                // The lower triangle L with half the diagonal is half of K: K = L + L^T. Column by
                // column, first B^T L, then that times B.
                for (row, place, k) in surface.entries(column) {
                    let half = if row == column && place[0] == place[1] {
                        0.5
                    } else {
                        1.0
                    };
                    let value = half * values[k];
                    for (node, weight) in embedding.rows().row(surface.points[row] as usize) {
                        product.add(node, place, weight * value);
                    }
                }
                let weights: Vec<f64> = embedding.rows().row(point as usize).map(|t| t.1).collect();
                sum.add(product.drain(), &weights);
            }
            sum.flush(&nodes(&group[0]), |row, column, block| {
                self.blocks().add(hessian, row, column, block);
                if row == column {
                    self.blocks().add(hessian, row, column, &block.transpose());
                }
            });
        }
    }
}

/// Blocks between any nodes (rows) and those of one element (columns).
struct ElementSum {
    /// Where each node's row is among the rows.
    row_of: Vec<Option<u32>>,
    nodes: Vec<u32>,
    /// Row by row.
    blocks: Vec<Matrix3<f64>>,
}

impl ElementSum {
    fn new(nodes: usize) -> Self {
        Self {
            row_of: vec![None; nodes],
            nodes: Vec::new(),
            blocks: Vec::new(),
        }
    }

    /// Adds the product of a column of blocks and a row of weights.
    fn add(&mut self, column: Vec<(u32, Matrix3<f64>)>, weights: &[f64]) {
        for (node, block) in column {
            let row = *self.row_of[node as usize].get_or_insert_with(|| {
                self.nodes.push(node);
                let filled = self.blocks.len() + weights.len();
                self.blocks.resize(filled, Matrix3::zeros());
                self.nodes.len() as u32 - 1
            }) as usize;
            let targets = &mut self.blocks[row * weights.len()..(row + 1) * weights.len()];
            for (target, weight) in targets.iter_mut().zip(weights) {
                *target += block * *weight;
            }
        }
    }

    /// Hands out all blocks with their row and column, and begins anew.
    fn flush(&mut self, columns: &[u32], mut each: impl FnMut(u32, u32, &Matrix3<f64>)) {
        let rows = self
            .nodes
            .iter()
            .zip(self.blocks.chunks_exact(columns.len()));
        for (&row, blocks) in rows {
            for (&column, block) in columns.iter().zip(blocks) {
                each(row, column, block);
            }
            self.row_of[row as usize] = None;
        }
        self.nodes.clear();
        self.blocks.clear();
    }
}

/// One block per node, most of them zero.
struct NodeRows {
    blocks: Vec<Matrix3<f64>>,
    is_touched: Vec<bool>,
    touched: Vec<u32>,
}

impl NodeRows {
    fn new(nodes: usize) -> Self {
        Self {
            blocks: vec![Matrix3::zeros(); nodes],
            is_touched: vec![false; nodes],
            touched: Vec::new(),
        }
    }

    fn add(&mut self, node: u32, [row, column]: [usize; 2], value: f64) {
        let index = node as usize;
        if !std::mem::replace(&mut self.is_touched[index], true) {
            self.touched.push(node);
        }
        self.blocks[index][(row, column)] += value;
    }

    /// The blocks in the order in which they were first touched; all are zero afterwards.
    fn drain(&mut self) -> Vec<(u32, Matrix3<f64>)> {
        let touched = std::mem::take(&mut self.touched);
        let take = |node: u32| {
            let index = node as usize;
            self.is_touched[index] = false;
            (
                node,
                std::mem::replace(&mut self.blocks[index], Matrix3::zeros()),
            )
        };
        touched.into_iter().map(take).collect()
    }
}

impl Embedding {
    /// Nodes that carry a point.
    fn nodes(&self, point: u32) -> impl Iterator<Item = u32> + '_ {
        self.rows().row(point as usize).map(|(node, _)| node)
    }
}
