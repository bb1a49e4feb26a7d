//! Connectivity of an oriented manifold triangle mesh with border.

use crate::{EdgeId, FaceId, Id, MeshError, PerEdge, PerFace, PerVertex, VertexId};

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
        let (edges, face_edges) = build_edges(&faces)?;
        let (vertex_face_starts, vertex_faces) = build_vertex_faces(vertex_count, &faces);
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
    let keys = faces.iter().map(|(face, vertices)| {
        let mut key = *vertices;
        key.sort_unstable();
        (key, face)
    });
    let sorted = sorted_by_vertices(keys.collect());
    match sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(MeshError::DuplicateFaces {
            first: pair[0].1,
            second: pair[1].1,
        }),
        None => Ok(()),
    }
}

/// Pairs in the order that sorting them gives, most of it by counting.
///
/// Few keys begin with the same vertex, so that little is left to compare.
fn sorted_by_vertices<const N: usize, T: Copy + Ord>(
    pairs: Vec<([VertexId; N], T)>,
) -> Vec<([VertexId; N], T)> {
    let firsts = || pairs.iter().map(|(key, _)| key[0]);
    let starts = starts(firsts().max().map_or(0, |v| v.index() + 1), firsts());
    let mut cursor = starts.clone();
    let mut sorted = pairs.clone();
    for pair in pairs {
        let slot = &mut cursor[pair.0[0].index()];
        sorted[*slot as usize] = pair;
        *slot += 1;
    }
    for range in starts.windows(2) {
        sorted[range[0] as usize..range[1] as usize].sort_unstable();
    }
    sorted
}

type EdgeTables = (PerEdge<Edge>, PerFace<[EdgeId; 3]>);

fn build_edges(faces: &PerFace<[VertexId; 3]>) -> Result<EdgeTables, MeshError> {
    // Half-edges sorted by their undirected key meet their twins without a hash map.
    let mut half_edges = Vec::with_capacity(3 * faces.len());
    for (face, vertices) in faces.iter() {
        for corner in 0..3 {
            let (a, b) = (vertices[corner], vertices[(corner + 1) % 3]);
            half_edges.push(([a.min(b), a.max(b)], (face, corner)));
        }
    }
    let half_edges = sorted_by_vertices(half_edges);
    // Back into the order of first appearance, which numbers the edges and picks the first error.
    let mut groups: Vec<&[([VertexId; 2], (FaceId, usize))]> = vec![&[]; half_edges.len()];
    for group in half_edges.chunk_by(|l, r| l.0 == r.0) {
        let (face, corner) = group[0].1;
        groups[3 * face.index() + corner] = group;
    }

    let mut edges = Vec::with_capacity(half_edges.len() / 2);
    let mut face_edges = PerFace::filled(faces.len(), [EdgeId(0); 3]);
    for group in groups.into_iter().filter(|group| !group.is_empty()) {
        let directed = |(_, (face, corner)): ([VertexId; 2], (FaceId, usize))| {
            [faces[face][corner], faces[face][(corner + 1) % 3]]
        };
        if group.len() > 2 {
            return Err(MeshError::NonManifoldEdge {
                vertices: group[0].0,
                face: group[0].1.0,
                count: group.len(),
            });
        }
        // Neighbours that wind alike run their common edge in opposite directions.
        if group.len() == 2 && directed(group[0]) == directed(group[1]) {
            return Err(MeshError::InconsistentWinding {
                first: group[0].1.0,
                second: group[1].1.0,
                vertices: group[0].0,
            });
        }
        let mut edge = Edge {
            vertices: directed(group[0]),
            faces: [None; 2],
            apexes: [None; 2],
        };
        for (side, &(_, (face, corner))) in group.iter().enumerate() {
            edge.faces[side] = Some(face);
            edge.apexes[side] = Some(faces[face][(corner + 2) % 3]);
            face_edges[face][corner] = EdgeId::from_index(edges.len());
        }
        edges.push(edge);
    }
    Ok((edges.into(), face_edges))
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
