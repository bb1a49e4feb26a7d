//! Errors of a driver and its poses.

use ruga_mesh::MeshError;

use crate::did_you_mean;

/// Reason why a mesh with blend shapes cannot drive a simulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlendError {
    /// The mesh has no triangle with an area.
    #[error("mesh '{mesh}' has no triangles")]
    NoTriangles {
        /// Name of the mesh.
        mesh: String,
    },
    /// The welded mesh is no oriented manifold.
    #[error("mesh '{mesh}': {source}")]
    Topology {
        /// Name of the mesh.
        mesh: String,
        /// Fault of the topology, with the file's triangle numbers and welded vertex numbers.
        source: MeshError,
    },
    /// A pose names a blend shape that the mesh does not have.
    #[error("blend shape '{name}' is none of the {available} that the mesh has{}", did_you_mean(nearest.as_deref()))]
    UnknownShape {
        /// The name asked for.
        name: String,
        /// The most similar name there is.
        nearest: Option<String>,
        /// Number of shapes that the mesh has.
        available: usize,
    },
    /// A weight of a pose is NaN or infinite.
    #[error("the weight of blend shape '{name}' is {value}, but must be a finite number")]
    WeightNotFinite {
        /// The shape.
        name: String,
        /// Its weight.
        value: f64,
    },
    /// A position, normal, texture coordinate or delta is NaN or infinite.
    #[error("mesh '{mesh}': {what} of vertex {vertex} is not finite")]
    NotFinite {
        /// Name of the mesh.
        mesh: String,
        /// Name of the array: `position`, `normal`, `texture coordinate` or the name of the shape.
        what: String,
        /// Vertex number in the file.
        vertex: usize,
    },
    /// An array has not one entry per vertex.
    #[error("mesh '{mesh}': {what} has {found} entries, but there are {expected} vertices")]
    Length {
        /// Name of the mesh.
        mesh: String,
        /// Name of the array.
        what: String,
        /// Entries it has.
        found: usize,
        /// Vertices of the mesh.
        expected: usize,
    },
    /// The mesh has no texture coordinates.
    #[error("mesh '{mesh}' has no texture coordinates (TEXCOORD_0 or `vt`): maps need them")]
    MissingUvs {
        /// Name of the mesh.
        mesh: String,
    },
}
