//! Distances over a region in units of the local spacing.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::Vector3;
use petgraph::Directed;
use petgraph::csr::Csr;
use petgraph::unionfind::UnionFind;
use ruga_mesh::{Edge, Id, PerVertex, TriMesh, VertexId};

/// The vertices of a region, linked along edges and across pairs of faces.
///
/// A link is as long as its length over the mean spacing of its ends. With edges alone, distances
/// on a regular mesh are up to 15 % too long, depending on direction; with the links from apex to
/// apex across an edge, unfolded, 4 %.
pub(crate) struct RegionGraph {
    links: Csr<(), u64, Directed, u32>,
    pieces: UnionFind<u32>,
}

/// A length in whole steps of 1e-9 of the spacing.
///
/// Lengths that differ by rounding are then the same, and so is every choice between equals on a
/// mesh that was moved or turned.
pub(crate) fn ticks(length: f64) -> u64 {
    (length * TICKS_PER_SPACING).round() as u64
}

const TICKS_PER_SPACING: f64 = 1e9;

/// The nearest source of every vertex.
pub(crate) struct Voronoi {
    /// Distance in ticks; `u64::MAX` where no source reaches.
    pub(crate) distance: Vec<u64>,
    /// Number of the nearest source.
    pub(crate) owner: Vec<u32>,
}

impl Voronoi {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            distance: vec![u64::MAX; vertex_count],
            owner: vec![u32::MAX; vertex_count],
        }
    }
}

impl RegionGraph {
    pub(crate) fn new(
        mesh: &TriMesh,
        positions: &[Vector3<f64>],
        spacing: &PerVertex<f64>,
        is_candidate: &PerVertex<bool>,
    ) -> Self {
        // An edge and a diagonal, each in both directions.
        let mut links: Vec<(u32, u32, u64)> = Vec::with_capacity(4 * mesh.edges().len());
        let mut pieces = UnionFind::new(mesh.vertex_count());
        let mut link = |[a, b]: [VertexId; 2], length: f64| {
            let length = ticks(length / (0.5 * (spacing[a] + spacing[b])));
            links.extend([(a.0, b.0, length), (b.0, a.0, length)]);
        };
        for (_, edge) in mesh.edges().iter() {
            let [tail, head] = edge.vertices;
            if !(is_candidate[tail] && is_candidate[head]) {
                continue;
            }
            pieces.union(tail.0, head.0);
            link(
                edge.vertices,
                (positions[tail.index()] - positions[head.index()]).norm(),
            );
            if let [Some(left), Some(right)] = edge.apexes
                && is_candidate[left]
                && is_candidate[right]
                && let Some(length) = unfolded_diagonal(edge, positions)
            {
                link([left, right], length);
            }
        }
        // Of links between the same two vertices the shortest stays.
        links.sort_unstable();
        links.dedup_by_key(|l| (l.0, l.1));
        let mut graph = Csr::from_sorted_edges(&links).expect("the links were sorted just above");
        // Made of links alone, the graph ends at the last vertex that has one.
        while graph.node_count() < mesh.vertex_count() {
            graph.add_node(());
        }
        Self {
            links: graph,
            pieces,
        }
    }

    /// A vertex that stands for the connected piece of the region that `vertex` is in.
    pub(crate) fn piece(&self, vertex: VertexId) -> u32 {
        self.pieces.find(vertex.0)
    }

    /// Dijkstra from more sources, going on only where they are nearer than the earlier ones.
    ///
    /// `sources` are vertices with their numbers; they start at `head_start` ticks.
    pub(crate) fn add_sources(
        &self,
        voronoi: &mut Voronoi,
        sources: impl IntoIterator<Item = (VertexId, u32)>,
        head_start: u64,
    ) {
        let Voronoi { distance, owner } = voronoi;
        let mut queue = BinaryHeap::new();
        for (source, number) in sources {
            distance[source.index()] = head_start;
            owner[source.index()] = number;
            // With the vertex in the key the queue has no ties, and an owner does not depend on its
            // order.
            queue.push(Reverse((head_start, source.0)));
        }
        while let Some(Reverse((reached, from))) = queue.pop() {
            if reached > distance[from as usize] {
                continue;
            }
            let number = owner[from as usize];
            let neighbours = self.links.neighbors_slice(from);
            for (&to, length) in neighbours.iter().zip(self.links.edges_slice(from)) {
                // A link over many spacings takes all the ticks there are.
                let candidate = reached.saturating_add(*length);
                if candidate < distance[to as usize] {
                    distance[to as usize] = candidate;
                    owner[to as usize] = number;
                    queue.push(Reverse((candidate, to)));
                }
            }
        }
    }
}

/// Distance of an edge's apexes with its faces unfolded; `None` where the straight line misses
/// the edge.
fn unfolded_diagonal(edge: &Edge, positions: &[Vector3<f64>]) -> Option<f64> {
    let [tail, head] = edge.vertices.map(|v| positions[v.index()]);
    let length = (head - tail).norm();
    let along = (head - tail).try_normalize(0.0)?;
    let unfold = |apex: VertexId| {
        let arm = positions[apex.index()] - tail;
        let x = arm.dot(&along);
        (x, (arm - along * x).norm())
    };
    let (left, right) = (unfold(edge.apexes[0]?), unfold(edge.apexes[1]?));
    let height = left.1 + right.1;
    let crossing = left.0 + (right.0 - left.0) * left.1 / height;
    // Past an end the straight line leaves the two faces, and is no way over the surface.
    (crossing >= 0.0 && crossing <= length).then(|| (right.0 - left.0).hypot(height))
}
