//! Connectivity of an oriented manifold triangle mesh with border.

use rayon::prelude::*;

use crate::{EdgeId, FaceId, Id, MeshError, PerEdge, PerFace, PerVertex, VertexId};

/// Vertices whose half-edges a thread sorts at a time.
const VERTICES_AT_ONCE: usize = 4096;

/// An undirected edge and what lies on both sides of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Tail and head, in the direction in which `faces[0]` runs it.
    pub vertices: [VertexId; 2],
    /// The face to the left and, unless this is a border edge, the one to the right.
    pub faces: [Option<FaceId>; 2],
    /// The vertex opposite the edge in each of `faces`.
    pub apexes: [Option<VertexId>; 2],
}

impl Edge {
    /// Whether only one face is at this edge.
    pub fn is_border(&self) -> bool {
        self.faces[1].is_none()
    }
}

/// Faces, edges and their incidence; no positions.
///
/// # Panics
/// Methods that take an id panic when it is none of this mesh's.
#[derive(Clone, Debug)]
pub struct TriMesh {
    faces: PerFace<[VertexId; 3]>,
    edges: PerEdge<Edge>,
    face_edges: PerFace<[EdgeId; 3]>,
    vertex_face_starts: Vec<u32>,
    vertex_faces: Vec<FaceId>,
}

impl TriMesh {
    /// Most vertices, and most faces, that a mesh may have: 2^28. Ids have 32 bits, and three
    /// corners or edges per face must fit in them.
    pub const MAX_COUNT: usize = 1 << 28;

    /// Builds the connectivity of a face list.
    ///
    /// Vertices that no face uses are kept. A vertex where two fans of faces touch is accepted;
    /// see [`TriMesh::ring`].
    ///
    /// # Errors
    /// Every variant of [`MeshError`], for the first face that shows it.
    pub fn new(vertex_count: usize, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        // Before any array of that length is asked for, which would end the process.
        check_count("vertices", vertex_count)?;
        check_count("faces", faces.len())?;
        let faces: PerFace<[VertexId; 3]> = faces.into_iter().map(|f| f.map(VertexId)).collect();
        check_faces(vertex_count, &faces)?;
        let (tables, (vertex_face_starts, vertex_faces)) = rayon::join(
            || build_edges(vertex_count, &faces),
            || build_vertex_faces(vertex_count, &faces),
        );
        // Two faces on the same vertices share an edge, whose apexes then are the same.
        let is_folded = |edge: &Edge| edge.apexes[0] == edge.apexes[1];
        if !tables
            .as_ref()
            .is_ok_and(|tables| !tables.0.as_slice().iter().any(is_folded))
        {
            check_duplicates(&faces)?;
        }
        let (edges, face_edges) = tables?;
        Ok(Self {
            faces,
            edges,
            face_edges,
            vertex_face_starts,
            vertex_faces,
        })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_face_starts.len() - 1
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Vertices of every face, counter-clockwise seen from outside.
    pub fn faces(&self) -> &PerFace<[VertexId; 3]> {
        &self.faces
    }

    /// Every edge once, in order of first appearance.
    pub fn edges(&self) -> &PerEdge<Edge> {
        &self.edges
    }

    /// The edges of a face; edge `i` runs from corner `i` to corner `i + 1`.
    ///
    /// # Panics
    /// When `face` is none of this mesh's.
    pub fn face_edges(&self, face: FaceId) -> [EdgeId; 3] {
        self.face_edges[face]
    }

    /// Faces around a vertex, in order of their ids.
    ///
    /// # Panics
    /// When `vertex` is none of this mesh's.
    pub fn vertex_faces(&self, vertex: VertexId) -> &[FaceId] {
        let i = vertex.index();
        let range = self.vertex_face_starts[i] as usize..self.vertex_face_starts[i + 1] as usize;
        &self.vertex_faces[range]
    }

    /// The face across edge `corner` of `face`.
    ///
    /// # Panics
    /// When `face` is none of this mesh's, or `corner` is not 0, 1 or 2.
    pub fn neighbour(&self, face: FaceId, corner: usize) -> Option<FaceId> {
        let faces = self.edges[self.face_edges[face][corner]].faces;
        if faces[0] == Some(face) {
            faces[1]
        } else {
            faces[0]
        }
    }

    /// Whether each vertex lies on a border edge.
    pub fn border_vertices(&self) -> PerVertex<bool> {
        let mut border = PerVertex::filled(self.vertex_count(), false);
        for (_, edge) in self.edges.iter().filter(|(_, e)| e.is_border()) {
            border[edge.vertices[0]] = true;
            border[edge.vertices[1]] = true;
        }
        border
    }

    /// The faces at an edge, left and right, each with the corner at which the edge begins there.
    ///
    /// # Panics
    /// When `edge` is none of this mesh's.
    pub fn edge_sides(&self, edge: EdgeId) -> [Option<(FaceId, usize)>; 2] {
        self.edges[edge].faces.map(|face| {
            let corner = self.face_edges[face?].iter().position(|&e| e == edge);
            face.zip(corner)
        })
    }

    /// The faces for which `is_in` holds, in parts that hang together by edges; each begins with its
    /// first face, and the parts are in the order of these.
    pub fn connected_parts(&self, is_in: impl Fn(FaceId) -> bool) -> Vec<Vec<FaceId>> {
        let mut left: PerFace<bool> = self.faces.ids().map(is_in).collect();
        let mut parts = Vec::new();
        for seed in self.faces.ids() {
            if !std::mem::replace(&mut left[seed], false) {
                continue;
            }
            let mut part = vec![seed];
            let mut next = 0;
            while let Some(&from) = part.get(next) {
                for face in (0..3).filter_map(|corner| self.neighbour(from, corner)) {
                    if std::mem::replace(&mut left[face], false) {
                        part.push(face);
                    }
                }
                next += 1;
            }
            parts.push(part);
        }
        parts
    }

    /// The mesh of the chosen faces, in the order given.
    ///
    /// Faces of a valid mesh stay valid, so this cannot fail; a face chosen twice is taken once.
    ///
    /// # Panics
    /// When a chosen face is none of this mesh's.
    pub fn submesh(&self, chosen: &[FaceId]) -> Submesh {
        let mut taken = PerFace::filled(self.face_count(), false);
        let mut local = PerVertex::filled(self.vertex_count(), None);
        let (mut faces, mut vertices, mut kept) = (Vec::new(), Vec::new(), Vec::new());
        for &face in chosen {
            if std::mem::replace(&mut taken[face], true) {
                continue;
            }
            kept.push(face);
            faces.push(self.faces[face].map(|v| {
                *local[v].get_or_insert_with(|| {
                    vertices.push(v);
                    vertices.len() as u32 - 1
                })
            }));
        }
        let mesh =
            Self::new(vertices.len(), faces).expect("faces of a valid mesh are a valid mesh");
        Submesh {
            mesh,
            vertices: vertices.into(),
            faces: kept.into(),
        }
    }
}

/// Some faces of a larger mesh as a mesh of their own.
#[derive(Clone, Debug)]
pub struct Submesh {
    /// The part.
    pub mesh: TriMesh,
    /// For each of its vertices the vertex of the whole.
    pub vertices: PerVertex<VertexId>,
    /// For each of its faces the face of the whole.
    pub faces: PerFace<FaceId>,
}

fn check_count(what: &'static str, count: usize) -> Result<(), MeshError> {
    let limit = TriMesh::MAX_COUNT;
    if count <= limit {
        Ok(())
    } else {
        Err(MeshError::TooLarge { what, count, limit })
    }
}

fn check_faces(vertex_count: usize, faces: &PerFace<[VertexId; 3]>) -> Result<(), MeshError> {
    for (face, vertices) in faces.iter() {
        for (corner, &vertex) in vertices.iter().enumerate() {
            if vertex.index() >= vertex_count {
                return Err(MeshError::VertexOutOfRange {
                    face,
                    vertex,
                    count: vertex_count,
                });
            }
            // Each corner against the next one makes all three pairs.
            if vertices[(corner + 1) % 3] == vertex {
                return Err(MeshError::RepeatedVertex { face, vertex });
            }
        }
    }
    Ok(())
}

/// Refuses two faces on the same three vertices.
fn check_duplicates(faces: &PerFace<[VertexId; 3]>) -> Result<(), MeshError> {
    let mut sorted: Vec<([VertexId; 3], FaceId)> = faces
        .iter()
        .map(|(face, vertices)| {
            let mut key = *vertices;
            key.sort_unstable();
            (key, face)
        })
        .collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(MeshError::DuplicateFaces {
            first: pair[0].1,
            second: pair[1].1,
        }),
        None => Ok(()),
    }
}

type EdgeTables = (PerEdge<Edge>, PerFace<[EdgeId; 3]>);

fn build_edges(
    vertex_count: usize,
    faces: &PerFace<[VertexId; 3]>,
) -> Result<EdgeTables, MeshError> {
    let ends = |face: FaceId, corner: usize| [faces[face][corner], faces[face][(corner + 1) % 3]];
    let half_edges = || faces.ids().flat_map(|face| (0..3).map(move |c| (face, c)));
    // Half-edges meet their twins at the lower of their vertices, without a hash map.
    let lower = |(face, corner)| {
        ends(face, corner)
            .into_iter()
            .fold(VertexId(u32::MAX), Ord::min)
    };
    let starts = starts(vertex_count, half_edges().map(lower));
    let mut cursor = starts.clone();
    let mut at_lower = vec![(VertexId(0), FaceId(0), 0); 3 * faces.len()];
    for (face, corner) in half_edges() {
        let [a, b] = ends(face, corner);
        let slot = &mut cursor[a.min(b).index()];
        at_lower[*slot as usize] = (a.max(b), face, corner as u32);
        *slot += 1;
    }
    sort_by_other_end(&starts, &mut at_lower);

    // Euler's formula: no more on a disc.
    let mut edges = Vec::with_capacity(vertex_count + faces.len());
    let mut face_edges = PerFace::filled(faces.len(), [None; 3]);
    // In order of first appearance, which numbers the edges and picks the first error.
    for (face, corner) in half_edges() {
        if face_edges[face][corner].is_some() {
            continue;
        }
        let [a, b] = ends(face, corner);
        let (low, high) = (a.min(b), a.max(b));
        let at_low = &at_lower[starts[low.index()] as usize..starts[low.index() + 1] as usize];
        let group = &at_low[at_low.partition_point(|half| half.0 < high)
            ..at_low.partition_point(|half| half.0 <= high)];
        let count = group.len();
        if count > 2 {
            return Err(MeshError::NonManifoldEdge {
                vertices: [low, high],
                face,
                count,
            });
        }
        let mut edge = Edge {
            vertices: [a, b],
            faces: [None; 2],
            apexes: [None; 2],
        };
        for (side, &(_, other, at)) in group.iter().enumerate() {
            // Neighbours that wind alike run their common edge in opposite directions.
            let at = at as usize;
            if side == 1 && ends(other, at) == [a, b] {
                return Err(MeshError::InconsistentWinding {
                    first: face,
                    second: other,
                    vertices: [low, high],
                });
            }
            edge.faces[side] = Some(other);
            edge.apexes[side] = Some(faces[other][(at + 2) % 3]);
            face_edges[other][at] = Some(EdgeId::from_index(edges.len()));
        }
        edges.push(edge);
    }
    let all =
        |edges: &[Option<EdgeId>; 3]| edges.map(|edge| edge.expect("every half-edge has an edge"));
    let face_edges = face_edges.as_slice().iter().map(all).collect();
    Ok((edges.into(), face_edges))
}

/// A half-edge at the lower of its vertices: the other one, its face, and the corner there at which it begins.
type AtLower = (VertexId, FaceId, u32);

/// Sorts the half-edges of every vertex, which are those from its `starts` on, by their other ends, and stably: a hub
/// of very many faces would else be searched for each of them.
fn sort_by_other_end(starts: &[u32], mut half_edges: &mut [AtLower]) {
    let mut parts = Vec::new();
    for first in (0..starts.len() - 1).step_by(VERTICES_AT_ONCE) {
        let own = &starts[first..starts.len().min(first + VERTICES_AT_ONCE + 1)];
        let count = (own[own.len() - 1] - own[0]) as usize;
        let (part, rest) = half_edges.split_at_mut(count);
        parts.push((own, part));
        half_edges = rest;
    }
    parts.into_par_iter().for_each(|(starts, part)| {
        for range in starts.windows(2) {
            let [from, to] = [range[0], range[1]].map(|start| (start - starts[0]) as usize);
            part[from..to].sort_by_key(|half| half.0);
        }
    });
}

/// Where each vertex's part of a list begins that has an entry for every one of `vertices`, and its
/// end.
fn starts(vertex_count: usize, vertices: impl Iterator<Item = VertexId>) -> Vec<u32> {
    let mut starts = vec![0u32; vertex_count + 1];
    for vertex in vertices {
        starts[vertex.index() + 1] += 1;
    }
    for i in 0..vertex_count {
        starts[i + 1] += starts[i];
    }
    starts
}

fn build_vertex_faces(
    vertex_count: usize,
    faces: &PerFace<[VertexId; 3]>,
) -> (Vec<u32>, Vec<FaceId>) {
    let starts = starts(vertex_count, faces.as_slice().iter().flatten().copied());
    let mut cursor = starts.clone();
    let mut vertex_faces = vec![FaceId(0); 3 * faces.len()];
    // In the order of the faces, so that the list of each vertex is ascending.
    for (face, vertices) in faces.iter() {
        for vertex in vertices {
            let slot = &mut cursor[vertex.index()];
            vertex_faces[*slot as usize] = face;
            *slot += 1;
        }
    }
    (starts, vertex_faces)
}
