//! Errors of a request for centres or rows.

use ruga_mesh::{FaceId, VertexId};

/// Reason why no centres or rows can be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConstraintError {
    /// The mesh has no faces, or no vertex is a candidate.
    #[error("there is nothing to constrain: the mesh has no faces, or the region no vertices")]
    EmptyRegion,
    /// An array doesn't fit the mesh or the list of centres.
    #[error("{found} {what} were given; {expected} are needed")]
    WrongLength {
        /// Name of what the array holds.
        what: &'static str,
        /// Elements needed.
        expected: usize,
        /// Elements found.
        found: usize,
    },
    /// A candidate is no vertex of the mesh.
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
    /// A normal is NaN or infinite.
    #[error("the normal of vertex {vertex} is not finite", vertex = vertex.0)]
    NormalNotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// A centre is on no face of the mesh.
    #[error("centre {centre} is on face {face}, but the mesh has {count} faces", face = face.0)]
    FaceOutOfRange {
        /// Its number in the list.
        centre: usize,
        /// The face asked for.
        face: FaceId,
        /// Faces there are.
        count: usize,
    },
    /// Barycentric coordinates of a centre are negative, not finite, or don't sum to one.
    #[error(
        "centre {centre} has the barycentric coordinates {barycentric:?}; none may be negative, and their sum is one"
    )]
    OutsideFace {
        /// Its number in the list.
        centre: usize,
        /// The coordinates found.
        barycentric: [f64; 3],
    },
    /// A centre has no normal: those of the vertices around it aren't unit vectors or cancel.
    #[error("centre {centre} has no normal: faces around it are degenerate or folded")]
    NoNormal {
        /// Its number in the list.
        centre: usize,
    },
    /// A spacing is zero, negative or not finite.
    #[error("the spacing at vertex {vertex} is {spacing} m; it must be positive", vertex = vertex.0)]
    BadSpacing {
        /// The vertex.
        vertex: VertexId,
        /// The spacing found, m.
        spacing: f64,
    },
    /// A spacing asks for far more centres than the region has vertices.
    #[error(
        "the spacing asks for {wanted:.3e} centres, but the region has {vertices} vertices; accepted: a spacing longer than the mesh's edges, in metres"
    )]
    TooManyCentres {
        /// Centres asked for; infinite where their number overflows.
        wanted: f64,
        /// Vertices there are.
        vertices: usize,
    },
    /// A setting of how centres are spread is outside its range.
    #[error("{setting} is {value}; accepted: {accepted}")]
    BadSetting {
        /// Name of the setting.
        setting: &'static str,
        /// The value found.
        value: f64,
        /// The values that it may have.
        accepted: &'static str,
    },
    /// A kernel's width or cut is zero, negative or not finite.
    #[error(
        "the kernel at centre {centre} has sigma {sigma} m and cut {cut}; both must be positive"
    )]
    BadKernel {
        /// The centre's number in the list.
        centre: usize,
        /// The width found, m.
        sigma: f64,
        /// The cut found, in widths.
        cut: f64,
    },
}
