//! Topology, typed ids, material points, Loop subdivision and surface lookup for triangle meshes.

mod error;
mod ids;
mod topology;

pub use error::MeshError;
pub use ids::{EdgeId, FaceId, Id, PerEdge, PerElement, PerFace, PerVertex, VertexId};
pub use topology::{Edge, Ring, Submesh, TriMesh};
