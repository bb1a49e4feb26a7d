//! What can be wrong with a request for centres or rows.

use ruga_mesh::VertexId;

/// Why no centres or rows can be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConstraintError {
    /// The mesh has no faces, or no vertex is a candidate.
    #[error("there is nothing to constrain: the mesh has no faces, or the region no vertices")]
    EmptyRegion,
    /// An array doesn't fit the mesh or the list of centres.
    #[error("{found} {what} were given; {expected} are needed")]
    WrongLength {
        /// What the array holds.
        what: &'static str,
        /// Elements needed.
        expected: usize,
        /// Elements found.
        found: usize,
    },
    /// A candidate or centre is no vertex of the mesh.
    #[error("vertex {vertex} was asked for, but the mesh has {count} vertices", vertex = vertex.0)]
    VertexOutOfRange {
        /// The vertex asked for.
        vertex: VertexId,
        /// Vertices there are.
        count: usize,
    },
    /// A position is NaN or infinite.
    #[error("the position of vertex {vertex} is not finite", vertex = vertex.0)]
    PositionNotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// The normal of a centre has no direction.
    #[error("the normal of centre {vertex} is no unit vector: its faces are degenerate", vertex = vertex.0)]
    NormalNotUnit {
        /// The centre.
        vertex: VertexId,
    },
    /// A spacing is zero, negative or not finite.
    #[error("the spacing at vertex {vertex} is {spacing} m; it must be positive", vertex = vertex.0)]
    BadSpacing {
        /// The vertex.
        vertex: VertexId,
        /// The spacing found, m.
        spacing: f64,
    },
    /// A kernel's width or cut is zero, negative or not finite.
    #[error("the kernel at centre {vertex} has sigma {sigma} m and cut {cut}; both must be positive", vertex = vertex.0)]
    BadKernel {
        /// The centre.
        vertex: VertexId,
        /// The width found, m.
        sigma: f64,
        /// The cut found, in widths.
        cut: f64,
    },
}
