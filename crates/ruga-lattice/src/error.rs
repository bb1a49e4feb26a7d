//! Mistakes that a caller can make.

use ruga_mesh::{FaceId, VertexId};

use crate::ElementId;

/// Reasons to refuse a lattice, an energy or an embedding.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The surface has a border, so that no inside is defined.
    #[error(
        "the surface is not closed: {count} open edges, one of them between vertices {a} and {b}; \
         close its holes",
        a = vertices[0].0, b = vertices[1].0
    )]
    OpenSurface {
        /// Number of edges with one face only.
        count: usize,
        /// Ends of the first of them.
        vertices: [VertexId; 2],
    },
    /// Faces of the surface pass through each other.
    #[error(
        "the surface intersects itself: {count} pairs of faces cross, one of them faces {first} \
         and {second}",
        first = faces[0].0, second = faces[1].0
    )]
    SelfIntersection {
        /// Number of pairs of faces that cross or overlap.
        count: usize,
        /// The first pair.
        faces: [FaceId; 2],
    },
    /// A closed part of the surface has its normals towards the wrong side.
    #[error(
        "the closed part with face {face} is inside out, or lies within another body: its volume is \
         {volume:e} m3 and {depth} bodies are around it; flip its faces or remove it",
        face = face.0
    )]
    WrongSide {
        /// The first face of the part.
        face: FaceId,
        /// Signed volume of the part (m³).
        volume: f64,
        /// Number of other bodies that the part is inside of.
        depth: i64,
    },
    /// The mesh has no faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// An array does not have the size it must have.
    #[error("{what}: {found} entries, expected {expected}")]
    Length {
        /// The array.
        what: &'static str,
        /// Entries it must have.
        expected: usize,
        /// Entries it has.
        found: usize,
    },
    /// An entry of an array is infinite or not a number.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// The array.
        what: &'static str,
        /// Index of the entry.
        index: usize,
    },
    /// A setting or a material parameter is outside its range.
    #[error("{name} = {value}; accepted: {accepted}")]
    Setting {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range.
        accepted: &'static str,
    },
    /// A material point names a face that does not exist.
    #[error("point {point} lies on face {face}, but the mesh has {count} faces", face = face.0)]
    FaceOutOfRange {
        /// Index of the point.
        point: usize,
        /// The face it names.
        face: FaceId,
        /// Number of faces.
        count: usize,
    },
    /// A point of the lattice names an element that the lattice does not have.
    #[error("place {point} lies in element {element}, but the lattice has {count} elements", element = element.0)]
    ElementOutOfRange {
        /// Index of the point.
        point: usize,
        /// The element it names.
        element: ElementId,
        /// Number of elements.
        count: usize,
    },
    /// A vertex has no face and so no place on the surface.
    #[error("vertex {vertex} belongs to no face", vertex = vertex.0)]
    IsolatedVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A normal is too short to have a direction.
    #[error("the normal of point {point} has length {length:e}")]
    NoNormal {
        /// Index of the point.
        point: usize,
        /// Its length.
        length: f64,
    },
    /// The surface could not be cut along the cells in any position of the lattice that was tried.
    #[error(
        "the surface cannot be cut along the cells: near {position:?} m, in the mesh's own axes, it touches itself, or has \
         details under a billionth of a cell"
    )]
    CannotCut {
        /// Where the last attempt failed (m).
        position: [f64; 3],
    },
}

pub(crate) fn check_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), LatticeError> {
    if expected == found {
        Ok(())
    } else {
        Err(LatticeError::Length {
            what,
            expected,
            found,
        })
    }
}
