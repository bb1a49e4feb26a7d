//! Splits edges of a mesh at given places, and with them the faces beside.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{EdgeId, FaceId, FaceOrigin, Id, PerFace, TriMesh, VertexId};

/// Faces that a thread splits at a time.
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

/// The faces of a mesh with some edges split, before a mesh is made of them.
#[derive(Clone, Debug)]
pub struct SplitFaces {
    /// Vertices of every new face; those of the old mesh keep their numbers.
    pub faces: Vec<[u32; 3]>,
    /// The new vertices, which follow the old ones.
    pub born: Vec<BornVertex>,
    /// The old face that every new one is a part of, ascending.
    pub parents: Vec<FaceId>,
    /// Where every new face lies, as `placed` gave it.
    pub origins: Vec<FaceOrigin>,
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
    let split = split_faces(mesh, places, positions, |part| *part);
    let mesh = TriMesh::new(positions.len(), split.faces);
    EdgeSplit {
        mesh: mesh.expect("neighbours are cut at the same vertices"),
        born: split.born,
        origins: split.origins.into(),
    }
}

/// Splits faces as [`split_edges`] does, for who gives up the old mesh before the new one is made; `placed` turns the
/// place of a new face in its old one into the place to keep.
///
/// # Panics
/// As [`split_edges`].
pub fn split_faces(
    mesh: &TriMesh,
    places: &[Option<f64>],
    positions: &mut Vec<Vector3<f64>>,
    placed: impl Fn(&FaceOrigin) -> FaceOrigin + Sync,
) -> SplitFaces {
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
    let split = |face: FaceId| {
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
    // A face has one part more than cut edges. Lists of the right length are filled in place: those of all threads,
    // put together, would be there twice.
    let old: Vec<FaceId> = mesh.faces().ids().collect();
    let cut_edges = |face: FaceId| {
        let edges = mesh.face_edges(face).into_iter();
        edges.filter(|edge| places[edge.index()].is_some()).count()
    };
    let count = old.iter().map(|&face| 1 + cut_edges(face)).sum();
    let mut made = SplitFaces {
        faces: vec![[0; 3]; count],
        born,
        parents: vec![FaceId(0); count],
        origins: vec![
            FaceOrigin {
                face: FaceId(0),
                corners: [[0.0; 3]; 3],
            };
            count
        ],
    };
    let mut rest = (
        made.faces.as_mut_slice(),
        made.parents.as_mut_slice(),
        made.origins.as_mut_slice(),
    );
    let mut pieces = Vec::new();
    for faces in old.chunks(FACES_AT_ONCE) {
        let count = faces.iter().map(|&face| 1 + cut_edges(face)).sum();
        let own = (
            rest.0.split_off_mut(..count),
            rest.1.split_off_mut(..count),
            rest.2.split_off_mut(..count),
        );
        if let (Some(vertices), Some(parents), Some(origins)) = own {
            pieces.push((faces, vertices, parents, origins));
        }
    }
    pieces
        .into_par_iter()
        .for_each(|(faces, vertices, parents, origins)| {
            let made = faces.iter().flat_map(|&face| split(face));
            let places = vertices.iter_mut().zip(parents).zip(origins);
            for (((vertices, parent), origin), (corners, part)) in places.zip(made) {
                (*vertices, *parent, *origin) = (corners, part.face, placed(&part));
            }
        });
    made
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
