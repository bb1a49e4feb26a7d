//! Splits edges of a mesh at given places, and with them the faces beside.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{EdgeId, FaceId, FaceOrigin, Id, PerFace, TriMesh, VertexId};

/// Faces that a thread splits at least.
const FACES_AT_ONCE: usize = 1024;

/// A mesh with some edges split.
#[derive(Clone, Debug)]
pub struct EdgeSplit {
    /// The new mesh; its first vertices are those of the old one.
    pub mesh: TriMesh,
    /// The new vertices, which follow the old ones.
    pub born: Vec<BornVertex>,
    /// Where every new face lies in which old one, by old faces ascending.
    pub origins: PerFace<FaceOrigin>,
}

/// A vertex on an edge of the mesh before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BornVertex {
    /// The edge.
    pub edge: EdgeId,
    /// Its ends.
    pub ends: [VertexId; 2],
    /// Fraction of the way from the first end to the second.
    pub fraction: f64,
}

/// Gives every edge with a fraction in `places` a vertex at that part of the way between its two
/// vertices, and splits the faces beside it; `positions` (m) gets those of the new vertices.
///
/// ```text
///       2               2               2
///      / \             /|\             / \
///     X---X           / | \           X---X
///    / `.  \         /  |  \         / \ / \
///   0----`--1       0---X---1       0---X---1
/// ```
/// Of the two diagonals of a quadrilateral the shorter one is taken.
///
/// # Panics
/// When there is not one place per edge and one position per vertex.
pub fn split_edges(
    mesh: &TriMesh,
    places: &[Option<f64>],
    positions: &mut Vec<Vector3<f64>>,
) -> EdgeSplit {
    assert_eq!(places.len(), mesh.edges().len(), "one place per edge");
    assert_eq!(
        positions.len(),
        mesh.vertex_count(),
        "one position per vertex"
    );
    let (mut born, mut numbers) = (Vec::new(), Vec::with_capacity(places.len()));
    for ((edge, ends), place) in mesh.edges().iter().zip(places) {
        numbers.push(place.map(|_| positions.len() as u32));
        let Some(fraction) = *place else { continue };
        let ends = ends.vertices;
        let [a, b] = ends.map(|v| positions[v.index()]);
        positions.push(a.lerp(&b, fraction));
        born.push(BornVertex {
            edge,
            ends,
            fraction,
        });
    }
    let parts = |face: usize| {
        let face = FaceId::from_index(face);
        let places = places_in(mesh, face, &numbers, places);
        let vertex = |at: usize| places[at].0;
        let length = |[a, b]: [usize; 2]| {
            let [a, b] = [a, b].map(|at| positions[vertex(at) as usize]);
            (b - a).norm()
        };
        let cut = std::array::from_fn(|edge| vertex(3 + edge) != u32::MAX);
        let part = move |child: [usize; 3]| {
            let corners = child.map(|at| places[at].1);
            (child.map(|at| places[at].0), FaceOrigin { face, corners })
        };
        children(cut, length).into_iter().map(part)
    };
    let old = (0..mesh.face_count()).into_par_iter();
    let (faces, origins): (Vec<_>, Vec<_>) =
        old.with_min_len(FACES_AT_ONCE).flat_map_iter(parts).unzip();
    let mesh = TriMesh::new(positions.len(), faces);
    EdgeSplit {
        mesh: mesh.expect("neighbours are cut at the same vertices"),
        born,
        origins: origins.into(),
    }
}

/// Vertex and weights of a face's three corners, then of the new vertices on its edges.
fn places_in(
    mesh: &TriMesh,
    face: FaceId,
    numbers: &[Option<u32>],
    places: &[Option<f64>],
) -> [(u32, [f64; 3]); 6] {
    let corners = mesh.faces()[face];
    let edges = mesh.face_edges(face);
    std::array::from_fn(|at| {
        let mut weights = [0.0; 3];
        if at < 3 {
            weights[at] = 1.0;
            return (corners[at].0, weights);
        }
        let corner = at - 3;
        let edge = edges[corner];
        let (Some(vertex), Some(fraction)) = (numbers[edge.index()], places[edge.index()]) else {
            return (u32::MAX, weights);
        };
        let is_along = mesh.edges()[edge].vertices[0] == corners[corner];
        let fraction = if is_along { fraction } else { 1.0 - fraction };
        weights[corner] = 1.0 - fraction;
        weights[(corner + 1) % 3] = fraction;
        (vertex, weights)
    })
}

/// The parts of a face whose edges are `cut`: corners are 0 to 2, the cut of edge `i` is `3 + i`.
/// Of the two diagonals of a quadrilateral the one with the lesser `length` is taken.
fn children(cut: [bool; 3], length: impl Fn([usize; 2]) -> f64) -> Vec<[usize; 3]> {
    let next = |i: usize| (i + 1) % 3;
    let count = cut.iter().filter(|cut| **cut).count();
    let Some(first) = cut.iter().position(|&is_cut| is_cut) else {
        return vec![[0, 1, 2]];
    };
    if count == 1 {
        let (b, apex) = (next(first), next(next(first)));
        return vec![[first, 3 + first, apex], [3 + first, b, apex]];
    }
    let Some(whole) = cut.iter().position(|&is_cut| !is_cut) else {
        return vec![[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
    };
    // The apex is opposite the whole edge from `a` to `b`; both other edges are cut.
    let (a, b) = (whole, next(whole));
    let apex = next(b);
    let (left, right) = (3 + apex, 3 + b);
    let mut parts = vec![[apex, left, right]];
    // The shorter diagonal leaves the larger least angle.
    if length([left, b]) <= length([a, right]) {
        parts.extend([[left, a, b], [left, b, right]]);
    } else {
        parts.extend([[left, a, right], [a, b, right]]);
    }
    parts
}
