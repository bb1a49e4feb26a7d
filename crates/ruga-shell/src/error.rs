//! Mistakes that a caller can make.

use thiserror::Error;

/// A mistake in the mesh, the parameters or the pose given to this crate.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ShellError {
    /// An array does not have one entry per vertex or per face.
    #[error("{what} has {found} entries, expected {expected}")]
    LengthMismatch {
        /// The array.
        what: &'static str,
        /// Number of vertices or faces.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A rest triangle is too thin to have a shape.
    #[error(
        "rest triangle {face} has area {area:e} m2, under {minimum:e} m2 (a millionth of its \
         longest edge squared)"
    )]
    DegenerateFace {
        /// Index of the face.
        face: usize,
        /// Its rest area (m²).
        area: f64,
        /// The least area accepted (m²).
        minimum: f64,
    },
    /// A vertex that may move belongs to no face: nothing would hold it.
    #[error("vertex {vertex} is free but belongs to no face")]
    IsolatedVertex {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A material or coupling parameter outside its range.
    #[error("{name} = {value} of {element} {index} is outside its range ({range})")]
    ParameterOutOfRange {
        /// `"face"`, `"edge"` or `"vertex"`.
        element: &'static str,
        /// Its index.
        index: usize,
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is accepted.
        range: &'static str,
    },
    /// A position, base point, normal or offset is not a finite number.
    #[error("the {what} of vertex {vertex} is not finite")]
    NotFinite {
        /// The array.
        what: &'static str,
        /// Index of the vertex.
        vertex: usize,
    },
    /// A base normal is not of unit length.
    #[error("the base normal of vertex {vertex} has length {length}, expected 1")]
    NormalNotUnit {
        /// Index of the vertex.
        vertex: usize,
        /// Its length.
        length: f64,
    },
    /// A rest stretch turns a face inside out or flattens it.
    #[error("the rest stretch of face {face} has determinant {determinant}, expected > 0")]
    InvertedStretch {
        /// Index of the face.
        face: usize,
        /// The determinant.
        determinant: f64,
    },
    /// A natural curvature is set on a layer that bends in hinges.
    #[error(
        "hinges cannot have a natural curvature, because their Poisson ratio is -1/3 whatever the \
         material's; build the layer with BendingModel::VertexCurvature"
    )]
    CurvatureOnHinges,
    /// A natural curvature has components that are not a symmetric tensor's.
    #[error("the natural curvature of face {face} is not symmetric: {xy} and {yx} 1/m")]
    AsymmetricCurvature {
        /// Index of the face.
        face: usize,
        /// First row, second column (1/m).
        xy: f64,
        /// Second row, first column (1/m).
        yx: f64,
    },
    /// What a layer of one sheet may change is asked of a pair.
    #[error("{what} can be set on a layer of one sheet only, and this one is a pair")]
    PairOfSheets {
        /// What was to be set.
        what: &'static str,
    },
    /// A factor of the bending stiffness is out of range.
    #[error("bending factor {value}, expected a positive number")]
    BendingFactor {
        /// The factor.
        value: f64,
    },
    /// A stiffness on the gradient of the drift is out of range.
    #[error(
        "stiffness {value} N/m on the gradient of the drift, expected a finite number that is not negative"
    )]
    DriftGradient {
        /// The stiffness.
        value: f64,
    },
    /// A crease or line anchor is put on an edge that cannot have it.
    #[error("edge {edge} cannot be creased: it lies at the border or is not in the mesh")]
    CreaseOutside {
        /// Index of the edge.
        edge: usize,
    },
    /// Two creases are put on one edge.
    #[error("edge {edge} has two creases; merge them or leave one out")]
    CreaseTwice {
        /// Index of the edge.
        edge: usize,
    },
    /// A compression direction has no component in its face.
    #[error("the compression direction of face {face} has no component in the face")]
    NoDirection {
        /// Index of the face.
        face: usize,
    },
    /// The bending and foundation stiffness of a response query is not positive definite.
    #[error(
        "the sheet is unstable without any compression: gradient stiffness {gradient_stiffness} \
         N/m is too negative, or no vertex is free"
    )]
    UnstableSheet {
        /// The query's gradient stiffness (N/m).
        gradient_stiffness: f64,
    },
}
