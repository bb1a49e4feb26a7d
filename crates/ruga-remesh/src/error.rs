//! Errors in the input of a remesh or a cut.

use ruga_mesh::{FaceId, MaterialPoint, VertexId};

/// Reason why a mesh, a sizing or a setting is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RemeshError {
    /// An array does not fit the mesh.
    #[error("{what}: {got} entries, but the mesh asks for {expected}")]
    Length {
        /// The array.
        what: &'static str,
        /// Entries it has.
        got: usize,
        /// Entries it must have.
        expected: usize,
    },
    /// The triangles are no mesh.
    #[error(transparent)]
    Mesh(#[from] ruga_mesh::MeshError),
    /// A setting is outside its range.
    #[error("{name} = {value}; accepted: {accepted}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range.
        accepted: &'static str,
    },
    /// The shortest edge is set longer than the longest.
    #[error("min_edge = {min_edge} m is longer than max_edge = {max_edge} m")]
    EdgeRange {
        /// Setting, m.
        min_edge: f64,
        /// Setting, m.
        max_edge: f64,
    },
    /// A direction of a sizing has no part tangent to the surface.
    #[error("direction {direction:?} has no part at right angles to the normal {normal:?}")]
    Direction {
        /// The direction.
        direction: [f64; 3],
        /// The normal.
        normal: [f64; 3],
    },
    /// A vertex's material point is no place of the surface.
    #[error(
        "vertex {vertex}: face {face}, coordinates {barycentric:?} are no place of the surface; accepted: a face that it has and coordinates of sum 1",
        vertex = vertex.0, face = point.face.0, barycentric = point.barycentric
    )]
    Point {
        /// The vertex.
        vertex: VertexId,
        /// Its material point.
        point: MaterialPoint,
    },
    /// A position is infinite or not a number.
    #[error("vertex {vertex} has a coordinate that is not finite", vertex = vertex.0)]
    Position {
        /// The vertex.
        vertex: VertexId,
    },
    /// A level that a mesh is to be cut by is infinite or not a number.
    #[error("vertex {vertex}: level = {value}; accepted: a finite number", vertex = vertex.0)]
    Level {
        /// The vertex.
        vertex: VertexId,
        /// Its level.
        value: f64,
    },
    /// A sizing tensor is not finite, not symmetric or has a negative eigenvalue.
    #[error("the sizing tensor of vertex {vertex} must be finite, symmetric and not negative", vertex = vertex.0)]
    Tensor {
        /// The vertex.
        vertex: VertexId,
    },
    /// A number that drives the sizing at a face is not finite or out of range.
    #[error("face {face}: {what} = {value}; accepted: {accepted}", face = face.0)]
    Face {
        /// The face.
        face: FaceId,
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range.
        accepted: &'static str,
    },
    /// A vertex has no face, or two fans of faces touch at it.
    #[error("vertex {vertex} must have exactly one fan of faces around it; split or remove it", vertex = vertex.0)]
    NonManifoldVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// The sizing asks for more vertices than `max_vertices` allows.
    #[error(
        "the sizing asks for about {estimate} vertices, max_vertices is {limit}: coarsen the sizing or raise min_edge"
    )]
    TooManyVertices {
        /// Predicted number.
        estimate: usize,
        /// Setting.
        limit: usize,
    },
}
