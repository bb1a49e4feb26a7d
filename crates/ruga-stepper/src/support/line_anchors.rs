//! Springs between crease lines of a layer and places in the soft body below.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use ruga_lattice::{Embedding, Lattice, LatticeEnergy, LatticeError};
use ruga_mesh::{BlockPattern, Id};
use ruga_shell::{LineAnchor, line_spring_energy, line_spring_pulls};

use crate::LayerSpec;
use crate::skin::skin_mesh::SkinMesh;

/// Line anchors whose lower ends lie in the flesh and move with it.
///
/// ```text
/// E = sum over edges of k_a l/6 (u_0^2 + u_0 u_1 + u_1^2)      u_i = n_i.(x_i - p_i) - h_i + d_i
/// p = B q      places at rest h below the line's vertices      d: depth to which the line is drawn
/// ```
/// The energy of [`LineAnchor`] with the lower ends in the place of the surface below: what pulls the line down pulls
/// the flesh up. `n` are the normals that material parallel to the surface has at `p`. A solve holds them fast like
/// those of the foundation, so that the energy is quadratic in `x` and `q`. Forces of a spring lie along `n` and
/// cancel; their torque `(x - p) x n` does so but for the way that the line has slid over its place.
#[derive(Clone, Debug)]
pub(crate) struct LineAnchors {
    embedding: Embedding,
    /// The layer's vertex over every place.
    vertices: Vec<u32>,
    /// Height of that vertex over the place at rest, m.
    heights: Vec<f64>,
    /// Normals at the places that the energy stands on.
    normals: Vec<Vector3<f64>>,
    edges: Vec<AnchoredEdge>,
}

/// The springs along an edge of a line.
#[derive(Clone, Copy, Debug)]
struct AnchoredEdge {
    /// The places below its ends.
    ends: [u32; 2],
    /// Length at rest, m.
    length: f64,
    /// `k_a l`, N/m.
    stiffness: f64,
    /// Depth to which its ends are drawn, m.
    depths: [f64; 2],
}

/// Forces against line anchors: the derivative of their energy.
#[derive(Clone, Debug)]
pub(crate) struct Pulls {
    /// On vertices of the layer, some of which are there several times, N.
    pub(crate) on_vertices: Vec<(u32, Vector3<f64>)>,
    /// On all nodes of the lattice, N.
    pub(crate) on_nodes: Vec<Vector3<f64>>,
}

impl LineAnchors {
    /// The anchors of `spec` below the lines of `skin`, without stiffness; `None` where it has none.
    pub(crate) fn new(
        lattice: &Lattice,
        spec: &LayerSpec,
        skin: &SkinMesh,
    ) -> Result<Option<Self>, LatticeError> {
        let rest = &skin.rest;
        // Where lines with different anchors meet, a vertex has a place for each.
        let mut number: BTreeMap<(usize, u32), u32> = BTreeMap::new();
        let (mut vertices, mut heights, mut edges) = (Vec::new(), Vec::new(), Vec::new());
        for crease in &skin.creases {
            let Some(anchor) = spec.creases[crease.line].anchor else {
                continue;
            };
            let ends = skin.mesh.edges()[crease.edge].vertices;
            let [a, b] = ends.map(|v| rest.positions[v.index()]);
            let ends = ends.map(|v| {
                *number.entry((crease.line, v.0)).or_insert_with(|| {
                    vertices.push(v.0);
                    heights.push(anchor.depth);
                    vertices.len() as u32 - 1
                })
            });
            edges.push(AnchoredEdge {
                ends,
                length: (b - a).norm(),
                stiffness: 0.0,
                depths: [0.0; 2],
            });
        }
        if edges.is_empty() {
            return Ok(None);
        }
        let normals: Vec<_> = (vertices.iter())
            .map(|&v| rest.normals[v as usize])
            .collect();
        let below = vertices.iter().zip(&normals).zip(&heights);
        let places: Vec<_> = below
            .map(|((&v, n), height)| rest.positions[v as usize] - n * *height)
            .collect();
        let places = lattice.locate_near(&places)?;
        Ok(Some(Self {
            embedding: Embedding::of_lattice_points(lattice, &places, &normals)?,
            vertices,
            heights,
            normals,
            edges,
        }))
    }

    /// Widens the pattern of a lattice by the nodes that the springs couple.
    pub(crate) fn couple(&self, lattice: &mut LatticeEnergy) -> Result<(), LatticeError> {
        let stencils = self.edges.iter().map(|edge| edge.ends.to_vec());
        lattice.couple_surface(&self.embedding, stencils)
    }

    /// Nodes that every one of so many vertices of the layer is coupled with.
    pub(crate) fn coupled_nodes(&self, vertices: usize) -> Vec<Vec<u32>> {
        let mut coupled = vec![Vec::new(); vertices];
        for edge in &self.edges {
            for end in edge.ends {
                let nodes = edge.ends.iter().flat_map(|&end| self.row(end));
                let vertex = self.vertices[end as usize] as usize;
                coupled[vertex].extend(nodes.map(|(node, _)| node));
            }
        }
        coupled
    }

    /// Replaces stiffness and depths of the springs along all edges with an anchor, in the order of the mesh's.
    pub(crate) fn set(&mut self, anchors: &[LineAnchor]) {
        debug_assert_eq!(anchors.len(), self.edges.len(), "one anchor per edge");
        for (edge, anchor) in self.edges.iter_mut().zip(anchors) {
            edge.stiffness = anchor.stiffness * edge.length;
            edge.depths = anchor.depths;
        }
    }

    /// Stands the energy on the normals of a lattice with its nodes at `q` (m).
    pub(crate) fn hold(&mut self, q: &[Vector3<f64>]) {
        let now = self.embedding.normals(q).into_iter();
        for (normal, now) in self.normals.iter_mut().zip(now) {
            // What has collapsed has none, and keeps the one before until it has one again.
            if now != Vector3::zeros() {
                *normal = now;
            }
        }
    }

    /// Energy (J) with the layer's vertices at `x` and the nodes at `q` (m).
    pub(crate) fn value(&self, x: &[Vector3<f64>], q: &[Vector3<f64>]) -> f64 {
        let heights = self.heights_over(x, q);
        let energy =
            |edge: &AnchoredEdge| line_spring_energy(edge.stiffness, self.excess(edge, &heights));
        self.edges.iter().map(energy).sum()
    }

    /// The derivatives by the layer's vertices and by all nodes.
    pub(crate) fn gradient(&self, x: &[Vector3<f64>], q: &[Vector3<f64>]) -> Pulls {
        let heights = self.heights_over(x, q);
        let mut pulls = vec![Vector3::zeros(); self.vertices.len()];
        for edge in &self.edges {
            let own = line_spring_pulls(edge.stiffness, self.excess(edge, &heights));
            for (end, pull) in edge.ends.iter().zip(own) {
                pulls[*end as usize] += self.normals[*end as usize] * pull;
            }
        }
        let opposite: Vec<_> = pulls.iter().map(|pull| -pull).collect();
        let on_nodes = self.embedding.pull_back(&opposite);
        let on_vertices = self.vertices.iter().copied().zip(pulls);
        Pulls {
            on_vertices: on_vertices.collect(),
            on_nodes,
        }
    }

    /// Adds the second derivatives that a vertex takes part in, over `blocks` whose nodes come after so many
    /// vertices. They are constant as long as the normals are.
    pub(crate) fn add_to_vertices(&self, blocks: &BlockPattern, first: u32, values: &mut [f64]) {
        for edge in &self.edges {
            for i in 0..2 {
                let vertex = self.vertices[edge.ends[i] as usize];
                for j in 0..2 {
                    let block = self.block(edge, i, j);
                    for (node, weight) in self.row(edge.ends[j]) {
                        let slot = blocks.slot(vertex, first + node);
                        slot.add(values, &(block * -weight));
                    }
                    // A pair is stored once.
                    if j <= i {
                        let other = self.vertices[edge.ends[j] as usize];
                        blocks.slot(vertex, other).add(values, &block);
                    }
                }
            }
        }
    }

    /// Adds the second derivatives between nodes, in the order of the lattice's pattern.
    pub(crate) fn add_to_nodes(&self, lattice: &LatticeEnergy, values: &mut [f64]) {
        let mut columns: Vec<BTreeMap<u32, Matrix3<f64>>> =
            vec![BTreeMap::new(); self.vertices.len()];
        for edge in &self.edges {
            for (row, column) in [(0, 0), (1, 1), (0, 1)] {
                // The lower triangle: rows are not above columns.
                let (row, column) = match edge.ends[row] >= edge.ends[column] {
                    true => (row, column),
                    false => (column, row),
                };
                let sum = columns[edge.ends[column] as usize].entry(edge.ends[row]);
                *sum.or_insert_with(Matrix3::zeros) += self.block(edge, row, column);
            }
        }
        let columns = columns
            .into_iter()
            .map(|column| column.into_iter().collect());
        let columns: Vec<Vec<(u32, Matrix3<f64>)>> = columns.collect();
        lattice.add_pulled_back(&self.embedding, &columns, values);
    }

    /// Second derivative by end `i` (rows) and end `j` (columns) of an edge: `k_a l` times a third or a sixth.
    fn block(&self, edge: &AnchoredEdge, i: usize, j: usize) -> Matrix3<f64> {
        let share = if i == j { 3.0 } else { 6.0 };
        let [a, b] = [i, j].map(|end| self.normals[edge.ends[end] as usize]);
        a * b.transpose() * (edge.stiffness / share)
    }

    /// Heights of the vertices over their places beyond those at rest, m.
    fn heights_over(&self, x: &[Vector3<f64>], q: &[Vector3<f64>]) -> Vec<f64> {
        let places = self.embedding.positions(q);
        let ends = self.vertices.iter().zip(&places);
        let ends = ends.zip(self.normals.iter().zip(&self.heights));
        ends.map(|((&v, p), (n, height))| n.dot(&(x[v as usize] - p)) - height)
            .collect()
    }

    /// Heights of the ends of an edge over where the springs would have them, m.
    fn excess(&self, edge: &AnchoredEdge, heights: &[f64]) -> [f64; 2] {
        [0, 1].map(|i| heights[edge.ends[i] as usize] + edge.depths[i])
    }

    /// Nodes that carry a place, with their weights.
    fn row(&self, place: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.embedding.rows().row(place as usize)
    }
}
