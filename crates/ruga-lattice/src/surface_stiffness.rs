//! The stiffness of an embedded surface as the nodes feel it.

use nalgebra::Matrix3;

use crate::error::check_length;
use crate::{Embedding, LatticeEnergy, LatticeError};

/// The lower triangle of a symmetric stiffness between the points of an embedding: for each point the
/// points from itself on that it is coupled with, ascending, and the block (their rows, its columns).
pub type SurfaceBlocks = [Vec<(u32, Matrix3<f64>)>];

impl LatticeEnergy {
    /// Widens the pattern by the nodes that the points of a surface couple, for
    /// [`Self::add_pulled_back`]: each of `stencils` is a point and those after it in its
    /// [`SurfaceBlocks`].
    ///
    /// A stencil of the surface that reaches across a border couples nodes that no element has in
    /// common. Value arrays made for the former pattern don't fit any more.
    ///
    /// # Errors
    /// [`LatticeError::Length`] for an embedding in another lattice than the energy's, or without one of
    /// the points.
    pub fn couple_surface(
        &mut self,
        embedding: &Embedding,
        stencils: impl Iterator<Item = Vec<u32>>,
    ) -> Result<(), LatticeError> {
        let nodes = self.blocks().point_count();
        check_length("nodes of the embedding", nodes, embedding.node_count())?;
        let points = embedding.point_count();
        let mut coupled = Vec::new();
        for stencil in stencils {
            if let Some(&beyond) = stencil.iter().find(|&&point| point as usize >= points) {
                return check_length("embedded points", beyond as usize + 1, points);
            }
            let nodes = stencil.iter().flat_map(|&point| embedding.nodes(point));
            let mut nodes: Vec<u32> = nodes.collect();
            nodes.sort_unstable();
            nodes.dedup();
            coupled.push(nodes);
        }
        // Most points of an element couple the same nodes.
        coupled.sort_unstable();
        coupled.dedup();
        self.blocks_mut().widen(coupled.iter().map(Vec::as_slice));
        Ok(())
    }

    /// Adds `B^T K B` to a Hessian in the order of [`Self::pattern`] (RK 6.2, eq. 15), for a
    /// surface stiffness `K`.
    ///
    /// # Panics
    /// When the surface has other points than those that [`Self::couple_surface`] accepted, or arrays
    /// have wrong lengths.
    pub fn add_pulled_back(
        &self,
        embedding: &Embedding,
        surface: &SurfaceBlocks,
        hessian: &mut [f64],
    ) {
        assert_eq!(hessian.len(), self.pattern().1.len(), "in pattern order");
        let mut product = NodeRows::new(self.blocks().point_count());
        let mut sum = ElementSum::new(self.blocks().point_count());
        // Points of one element come one after the other: what they add to its nodes is looked up
        // in the pattern only once.
        let mut order: Vec<u32> = (0..surface.len() as u32).collect();
        let nodes = |point: &u32| embedding.nodes(*point).collect::<Vec<u32>>();
        order.sort_by_cached_key(nodes);
        for group in order.chunk_by(|a, b| nodes(a) == nodes(b)) {
            for &column in group {
                // The lower triangle L with half the diagonal is half of K: K = L + L^T. Column by
                // column, first B^T L, then that times B.
                for &(row, mut block) in &surface[column as usize] {
                    if row == column {
                        block.fill_upper_triangle(0.0, 1);
                        block.set_diagonal(&(block.diagonal() * 0.5));
                    }
                    for (node, weight) in embedding.rows().row(row as usize) {
                        product.add(node, block * weight);
                    }
                }
                let row = embedding.rows().row(column as usize);
                let weights: Vec<f64> = row.map(|term| term.1).collect();
                sum.add(product.drain(), &weights);
            }
            sum.flush(&nodes(&group[0]), |row, column, block| {
                // A pair of nodes comes in both orders, and the slot transposes one of the two. On
                // the diagonal there is one order only.
                let slot = self.blocks().slot(row, column);
                slot.add(hessian, block);
                if row == column {
                    slot.add(hessian, &block.transpose());
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
    /// Blocks, row by row.
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
                // Rows are made when they are first touched: an element's points couple few of the
                // nodes.
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

    fn add(&mut self, node: u32, block: Matrix3<f64>) {
        let index = node as usize;
        if !std::mem::replace(&mut self.is_touched[index], true) {
            self.touched.push(node);
        }
        self.blocks[index] += block;
    }

    /// The blocks in the order in which they were first touched; all are zero afterwards.
    fn drain(&mut self) -> Vec<(u32, Matrix3<f64>)> {
        let touched = std::mem::take(&mut self.touched);
        let take = |node: u32| {
            let index = node as usize;
            // Only what was touched is cleared. Clearing all nodes for every point would cost their
            // product.
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
