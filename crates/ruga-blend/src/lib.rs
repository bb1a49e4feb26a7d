//! Blend-shape driver: weights in, posed positions and normals at material points out.

mod artist_mesh;

pub use artist_mesh::{ArtistMesh, BlendShape};
