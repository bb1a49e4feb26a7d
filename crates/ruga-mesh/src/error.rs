//! Errors of a face list.

use crate::{FaceId, VertexId};

/// Why a face list is no oriented manifold triangle mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A mesh has more vertices or faces than can be numbered.
    #[error("the mesh has {count} {what}, but at most {limit} are accepted")]
    TooLarge {
        /// `vertices` or `faces`.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are accepted: [`TriMesh::MAX_COUNT`](crate::TriMesh::MAX_COUNT).
        limit: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} uses vertex {vertex}, but the mesh has {count} vertices", face = face.0, vertex = vertex.0)]
    VertexOutOfRange {
        /// The face.
        face: FaceId,
        /// The vertex it names.
        vertex: VertexId,
        /// Vertices there are.
        count: usize,
    },
    /// A face uses one vertex twice.
    #[error("face {face} uses vertex {vertex} twice: its area is zero", face = face.0, vertex = vertex.0)]
    RepeatedVertex {
        /// The face.
        face: FaceId,
        /// The repeated vertex.
        vertex: VertexId,
    },
    /// Two faces have the same three vertices.
    #[error("faces {first} and {second} have the same three vertices; delete one", first = first.0, second = second.0)]
    DuplicateFaces {
        /// The earlier face.
        first: FaceId,
        /// The later face.
        second: FaceId,
    },
    /// More than two faces meet at one edge.
    #[error("{count} faces meet at the edge between vertices {a} and {b} (one of them is face {face}); at most two are accepted", a = vertices[0].0, b = vertices[1].0, face = face.0)]
    NonManifoldEdge {
        /// The edge's vertices.
        vertices: [VertexId; 2],
        /// One face at it.
        face: FaceId,
        /// Faces at it.
        count: usize,
    },
    /// Two neighbours run their common edge in the same direction.
    #[error("faces {first} and {second} have opposite winding (common edge between vertices {a} and {b}); flip one", first = first.0, second = second.0, a = vertices[0].0, b = vertices[1].0)]
    InconsistentWinding {
        /// The earlier face.
        first: FaceId,
        /// The later face.
        second: FaceId,
        /// The common edge.
        vertices: [VertexId; 2],
    },
}
