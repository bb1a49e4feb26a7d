//! What the springs below a layer add to the stiffness of a lattice that carries it.

use std::ops::AddAssign;

use nalgebra::{Matrix3, Vector3};
use ruga_lattice::Embedding;
use ruga_shell::FoundationStiffness;

/// The matrix `F` of [`FoundationStiffness`] between vertices, for products with the embedding `B`:
/// with `e = x - B q` the springs' energy has the second derivatives `F`, `-F B` and `B' F B`.
#[derive(Clone, Debug)]
pub(crate) struct Springs(pub(crate) FoundationStiffness);

impl Springs {
    /// Vertices whose deviations pull at vertex `i`, ascending.
    pub(crate) fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        self.0.normal.row(i).map(|(j, _)| j as usize)
    }

    /// Every vertex with its neighbours of higher numbers.
    pub(crate) fn stencils(&self) -> impl Iterator<Item = Vec<u32>> {
        (0..self.0.tangential.len()).map(|j| self.below(j).map(|(i, _)| i).collect())
    }

    /// The lower triangle of `F` (N/m), over these unit normals.
    pub(crate) fn hessian(&self, normals: &[Vector3<f64>]) -> Vec<Vec<(u32, Matrix3<f64>)>> {
        let column = |j: usize| {
            let rows = self.below(j);
            rows.map(move |(i, m)| (i, self.block(normals, [i as usize, j], m)))
        };
        (0..self.0.tangential.len())
            .map(|j| column(j).collect())
            .collect()
    }

    /// The neighbours of `j` from itself on.
    fn below(&self, j: usize) -> impl Iterator<Item = (u32, f64)> {
        let neighbours = self.0.normal.row(j);
        neighbours.filter(move |(i, _)| *i as usize >= j)
    }

    /// Row `i` of `F B`: nodes, ascending, each with its block (N/m).
    pub(crate) fn times(
        &self,
        embedding: &Embedding,
        normals: &[Vector3<f64>],
        i: usize,
    ) -> Vec<(u32, Matrix3<f64>)> {
        // All blocks but the tangential spring's begin with the normal here: one vector per node is
        // enough.
        let mut lifts: Vec<(u32, Vector3<f64>)> = Vec::new();
        for (j, m) in self.0.normal.row(i) {
            let lift = normals[j as usize] * m;
            let row = embedding.rows().row(j as usize);
            lifts.extend(row.map(|(node, weight)| (node, lift * weight)));
        }
        add_up(&mut lifts);
        let n = normals[i];
        let tangential = (Matrix3::identity() - n * n.transpose()) * self.0.tangential[i];
        let mut blocks: Vec<_> = lifts
            .into_iter()
            .map(|(node, lift)| (node, n * lift.transpose()))
            .collect();
        // The tangential spring acts at the vertex itself, so that its nodes are among those that
        // were just collected.
        for (node, weight) in embedding.rows().row(i) {
            if let Ok(place) = blocks.binary_search_by_key(&node, |block| block.0) {
                blocks[place].1 += tangential * weight;
            }
        }
        blocks
    }

    fn block(&self, normals: &[Vector3<f64>], [i, j]: [usize; 2], m: f64) -> Matrix3<f64> {
        let block = normals[i] * normals[j].transpose() * m;
        if i != j {
            return block;
        }
        let across = Matrix3::identity() - normals[i] * normals[i].transpose();
        block + across * self.0.tangential[i]
    }
}

/// Sorts by node and adds up what belongs to the same one.
fn add_up<T: Copy + AddAssign>(terms: &mut Vec<(u32, T)>) {
    terms.sort_by_key(|term| term.0);
    terms.dedup_by(|next, sum| {
        let is_same = next.0 == sum.0;
        if is_same {
            sum.1 += next.1;
        }
        is_same
    });
}
