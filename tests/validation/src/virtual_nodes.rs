//! Sharp creases as Patkar, Jin and Fedkiw 2014 make them: a mesh that is cut along lines with virtual nodes
//! and sewn together again, so that its parts can only turn about the cut.
//!
//! A cut triangle ABC becomes two whole triangles, (A, B', C') and (A', B, C), each with its material up to the
//! cut; primed nodes are copies. On every cut edge an embedded node exists once per side, and rows attach them:
//!
//! ```text
//! h = w_A A + w_B B'     h' = w_A A' + w_B B     h - h' = 0       w_A + w_B = 1
//! ```
//!
//! Where cuts cross, a node has up to four copies, each attached to the first. Material is scaled by its share of a
//! triangle, which the paper does not say; it is exact for what is linear over triangles.
//! [`CutCloth`] is the explicit loop in which the paper stabilises the rows, [`projected_newton`] its quasistatic
//! way. The product has edges on its lines and a compliance in series, and none of this.

mod chords;
mod cut_cloth;
mod pieces;
mod projected_newton;

pub use cut_cloth::{CutCloth, Stabilisation};
pub use projected_newton::{Projected, projected_newton};

use std::collections::BTreeMap;

use nalgebra::{DMatrix, Vector3};
use ruga_crease::TracedLine;
use ruga_mesh::{EdgeId, FaceId, Id, TriMesh};

use crate::Link;

use chords::{Chords, add_chords};
use pieces::{Piece, SAME, pieces};

/// What becomes of a line that ends inside a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineEnds {
    /// It ends at the last edge that it crosses. The paper warns that such a cut locks.
    AtEdges,
    /// It is extended by one triangle at either end, to the vertex opposite, as in the paper's figure 4.
    AtVertices,
}

/// One virtual triangle.
#[derive(Clone, Debug)]
pub struct VirtualFace {
    /// The triangle that it is a copy of.
    pub face: FaceId,
    /// Its nodes.
    pub nodes: [u32; 3],
    /// Its material by barycentric coordinates, a convex polygon.
    pub material: Vec<[f64; 3]>,
    /// Part of the triangle that is material, in (0, 1].
    pub share: f64,
}

/// A mesh cut along lines with virtual nodes, and the rows that sew it together.
#[derive(Clone, Debug)]
pub struct VirtualNodes {
    /// The virtual triangles.
    pub faces: Vec<VirtualFace>,
    /// The vertex that each node is a copy of. The first nodes are the vertices themselves.
    pub vertices: Vec<u32>,
    /// Rows `sum w x = 0`, per coordinate: nodes and weights.
    pub rows: Vec<Vec<(u32, f64)>>,
}

impl VirtualNodes {
    /// Cuts a mesh along lines that were traced over it.
    ///
    /// # Panics
    /// When a line goes through a vertex.
    pub fn cut(mesh: &TriMesh, lines: &[TracedLine], ends: LineEnds) -> Self {
        let mut chords = Chords::new();
        for line in lines {
            add_chords(mesh, line, ends, &mut chords);
        }
        let none = Vec::new();
        let faces = 0..mesh.face_count();
        let all: Vec<Piece> = faces
            .flat_map(|face| pieces(face, chords.get(&face).unwrap_or(&none)))
            .collect();
        Cutting::new(mesh, all).finish()
    }

    /// Number of nodes that are copies.
    pub fn copies(&self) -> usize {
        self.pairs().count()
    }

    /// The virtual triangles as a mesh.
    ///
    /// # Panics
    /// When a line ends [at an edge](LineEnds::AtEdges), where three virtual triangles meet.
    pub fn mesh(&self) -> TriMesh {
        let faces = self.faces.iter().map(|face| face.nodes).collect();
        TriMesh::new(self.vertices.len(), faces).expect("cuts from border to border or vertex")
    }

    /// Values of the vertices, for every node that of the vertex it is a copy of.
    pub fn spread<T: Clone>(&self, of_vertices: &[T]) -> Vec<T> {
        let nodes = self.vertices.iter();
        nodes.map(|&v| of_vertices[v as usize].clone()).collect()
    }

    /// How many vectors of differences between nodes and their copies the rows leave free: what can
    /// open along the cut.
    pub fn free_vectors(&self) -> usize {
        let copies = self.copies();
        let first = self.vertices.len() - copies;
        let mut matrix = DMatrix::<f64>::zeros(self.rows.len().max(1), copies.max(1));
        for (row, terms) in self.rows.iter().enumerate() {
            for &(node, weight) in terms {
                // Weights of a vertex and its copies sum to zero in a row: only differences count.
                if let Some(copy) = (node as usize).checked_sub(first) {
                    matrix[(row, copy)] += weight;
                }
            }
        }
        copies - if copies == 0 { 0 } else { matrix.rank(1e-9) }
    }

    /// Mass of every node under an areal density (kg/m²), a third of each triangle's material.
    pub fn masses(&self, rest: &[Vector3<f64>], density: f64) -> Vec<f64> {
        let mut masses = vec![0.0; self.vertices.len()];
        for face in &self.faces {
            let [a, b, c] = face
                .nodes
                .map(|node| rest[self.vertices[node as usize] as usize]);
            let third = density * face.share * (b - a).cross(&(c - a)).norm() / 6.0;
            for node in face.nodes {
                masses[node as usize] += third;
            }
        }
        masses
    }

    /// Largest distance between the two sides of the cut (m).
    pub fn gap(&self, positions: &[Vector3<f64>]) -> f64 {
        let gaps = self.rows.iter().map(|row| {
            let terms = row.iter().map(|&(node, w)| positions[node as usize] * w);
            terms.sum::<Vector3<f64>>().norm()
        });
        gaps.fold(0.0, f64::max)
    }

    /// Springs between nodes and their copies that resist a fold.
    ///
    /// The distance `|A - A'| = 2 d sin(theta/2)` grows with the distance `d` of A from the line. With one stiffness for
    /// all springs a fold is as stiff as the mesh happens to lie; with `k L/d^2`, `L` the length of line that
    /// the spring owns, it is not, but the springs of nodes near the line are as stiff as one likes.
    pub fn springs(&self, rest: &[Vector3<f64>], law: SpringLaw) -> Vec<Link> {
        let mut springs: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for pieces in self.faces.chunk_by(|a, b| a.face == b.face) {
            let [one, other] = pieces else { continue };
            let Some(way) = common_way(one, other) else {
                continue;
            };
            let corners = one
                .nodes
                .map(|node| rest[self.vertices[node as usize] as usize]);
            let [from, to] = way.map(|s| corners[0] * s[0] + corners[1] * s[1] + corners[2] * s[2]);
            let along = to - from;
            let share = along.norm() / 3.0;
            let pairs = one.nodes.into_iter().zip(other.nodes).zip(corners);
            // The tip of a cut has no copy.
            for ((a, b), corner) in pairs.filter(|((a, b), _)| a != b) {
                let off = along.normalize().cross(&(corner - from)).norm();
                let own = match law {
                    SpringLaw::Even(stiffness) => stiffness * share,
                    SpringLaw::ByDistance(stiffness) => stiffness * share / (off * off),
                };
                *springs.entry([a.min(b), a.max(b)]).or_default() += own;
            }
        }
        let links = springs.into_iter();
        let links = links.map(|(vertices, stiffness)| Link {
            vertices,
            stiffness,
        });
        links.collect()
    }

    /// Every copy, and the node of which it is one.
    pub fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let nodes = (0..).zip(&self.vertices);
        nodes.filter(|(node, v)| node != *v).map(|(n, &v)| [v, n])
    }
}

/// Stiffness of the springs between nodes and their copies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpringLaw {
    /// The same for every length of the line (N/m²), wherever its nodes are: the paper says nothing else.
    Even(f64),
    /// `k L/d^2` with this `k` (N): moment per length and angle.
    ByDistance(f64),
}

/// The side that the material of two halves of a triangle shares.
fn common_way(one: &VirtualFace, other: &VirtualFace) -> Option<[[f64; 3]; 2]> {
    let is_same = |p: &[f64; 3], q: &[f64; 3]| (0..3).all(|i| (p[i] - q[i]).abs() < SAME);
    let is_common = |p: &&[f64; 3]| other.material.iter().any(|q| is_same(p, q));
    let mut common = one.material.iter().filter(is_common);
    Some([*common.next()?, *common.next()?])
}

/// Pieces whose corners are glued where their material is one.
struct Cutting<'a> {
    mesh: &'a TriMesh,
    pieces: Vec<Piece>,
    /// Pieces of every face.
    of_face: Vec<Vec<usize>>,
    /// A corner of the same node, for corners numbered `3 piece + corner`.
    same: Vec<usize>,
}

impl<'a> Cutting<'a> {
    fn new(mesh: &'a TriMesh, pieces: Vec<Piece>) -> Self {
        let mut of_face = vec![Vec::new(); mesh.face_count()];
        for (number, piece) in pieces.iter().enumerate() {
            of_face[piece.face].push(number);
        }
        Self {
            mesh,
            same: (0..3 * pieces.len()).collect(),
            pieces,
            of_face,
        }
    }

    fn finish(mut self) -> VirtualNodes {
        self.glue();
        let (nodes, vertices) = self.number();
        let faces = self.pieces.iter().zip(&nodes).map(|(piece, &nodes)| {
            let material = piece.polygon.clone();
            VirtualFace {
                face: FaceId::from_index(piece.face),
                nodes,
                material,
                share: piece.share(),
            }
        });
        VirtualNodes {
            faces: faces.collect(),
            rows: self.rows(&nodes),
            vertices,
        }
    }

    /// Stretches of an edge that belong to a face's pieces, in fractions of the way from its first vertex, with the
    /// piece's corners at the edge's two vertices.
    fn stretches(&self, edge: EdgeId, side: usize) -> Vec<([f64; 2], [usize; 2])> {
        let Some((face, corner)) = self.mesh.edge_sides(edge)[side] else {
            return Vec::new();
        };
        let next = (corner + 1) % 3;
        let first = self.mesh.edges()[edge].vertices[0];
        let is_along = self.mesh.faces()[face][corner] == first;
        let own = self.of_face[face.index()].iter().filter_map(|&piece| {
            let [low, high] = self.pieces[piece].side(corner)?;
            let ends = [corner, next].map(|corner| 3 * piece + corner);
            Some(match is_along {
                true => ([low, high], ends),
                false => ([1.0 - high, 1.0 - low], [ends[1], ends[0]]),
            })
        });
        own.collect()
    }

    /// Makes one node of corners wherever pieces of neighbours share a stretch of their edge.
    fn glue(&mut self) {
        for edge in self.mesh.edges().ids() {
            let [left, right] = [0, 1].map(|side| self.stretches(edge, side));
            for (a, of_left) in &left {
                for (b, of_right) in &right {
                    if a[1].min(b[1]) - a[0].max(b[0]) > SAME {
                        for (&one, &other) in of_left.iter().zip(of_right) {
                            let [one, other] = [one, other].map(|corner| self.node(corner));
                            self.same[one.max(other)] = one.min(other);
                        }
                    }
                }
            }
        }
    }

    fn node(&self, mut corner: usize) -> usize {
        while self.same[corner] != corner {
            corner = self.same[corner];
        }
        corner
    }

    /// Nodes of every piece, and the vertex of every node: the vertices themselves, then copies.
    fn number(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut vertices: Vec<u32> = (0..self.mesh.vertex_count() as u32).collect();
        let mut number = vec![None; self.same.len()];
        let vertex = |piece: &Piece, corner: usize| {
            self.mesh.faces()[FaceId::from_index(piece.face)][corner].0
        };
        // What has its vertex in its material is the vertex.
        for (i, piece) in self.pieces.iter().enumerate() {
            for corner in (0..3).filter(|&corner| piece.has(corner)) {
                number[self.node(3 * i + corner)] = Some(vertex(piece, corner));
            }
        }
        let mut nodes = Vec::with_capacity(self.pieces.len());
        for (i, piece) in self.pieces.iter().enumerate() {
            nodes.push([0, 1, 2].map(|corner| {
                *number[self.node(3 * i + corner)].get_or_insert_with(|| {
                    vertices.push(vertex(piece, corner));
                    vertices.len() as u32 - 1
                })
            }));
        }
        (nodes, vertices)
    }

    /// Rows of all embedded nodes: on edges, and where cuts cross in a face.
    fn rows(&self, nodes: &[[u32; 3]]) -> Vec<Vec<(u32, f64)>> {
        let of_corner = |corner: usize| nodes[corner / 3][corner % 3];
        let mut rows = Vec::new();
        for edge in self.mesh.edges().ids() {
            let sides = [0, 1].map(|side| self.stretches(edge, side));
            // Where a line ends at an edge, the face beyond is whole.
            let [left, right] = &sides;
            let mut cut = if left.len() > 1 { left } else { right }.clone();
            cut.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
            for pair in cut.windows(2) {
                let at = pair[0].0[1];
                let ends = [pair[0].1, pair[1].1].map(|ends| ends.map(of_corner));
                let weights = [1.0 - at, at];
                rows.extend(row(&ends[0], &ends[1], &weights));
            }
        }
        for own in &self.of_face {
            rows.extend(self.crossing_rows(own, nodes));
        }
        rows
    }

    /// Rows of the crossings in one face, each piece's node attached to the first piece's.
    fn crossing_rows(&self, own: &[usize], nodes: &[[u32; 3]]) -> Vec<Vec<(u32, f64)>> {
        let mut rows = Vec::new();
        let mut known: Vec<([f64; 3], usize)> = Vec::new();
        for &piece in own {
            for at in self.pieces[piece].crossings() {
                let is_it = |other: &&([f64; 3], usize)| {
                    (0..3).all(|i| (other.0[i] - at[i]).abs() < 1e3 * SAME)
                };
                match known.iter().find(is_it) {
                    Some(&(_, first)) => rows.extend(row(&nodes[first], &nodes[piece], &at)),
                    None => known.push((at, piece)),
                }
            }
        }
        rows
    }
}

/// Attaches one side of an embedded node to another; `None` where they are one.
fn row(one: &[u32], other: &[u32], weights: &[f64]) -> Option<Vec<(u32, f64)>> {
    let differ = one.iter().zip(other).zip(weights);
    let differ = differ.filter(|((a, b), _)| a != b);
    let mut terms: Vec<_> = differ
        .flat_map(|((&a, &b), &weight)| [(a, weight), (b, -weight)])
        .collect();
    terms.sort_by_key(|term| term.0);
    (!terms.is_empty()).then_some(terms)
}
