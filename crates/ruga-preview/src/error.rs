//! What keeps a page from being made.

use ruga_blend::BlendError;
use thiserror::Error;

/// A mesh, poses and maps that do not fit each other.
#[derive(Debug, Error)]
pub enum PreviewError {
    /// The mesh cannot follow poses.
    #[error(transparent)]
    Mesh(#[from] BlendError),
    /// There is nothing to show.
    #[error("no pose has a normal map")]
    NoMaps,
    /// A map or a picture has not as many texels as its size says, or none.
    #[error("a map of {size} x {size} texels has {found} of them")]
    TexelCount {
        /// Texels per side.
        size: u32,
        /// Texels that were given.
        found: usize,
    },
    /// The maps of the poses differ in size, as maps of one run never do.
    #[error(
        "pose `{pose}`: its map of key {key} has {found} texels a side, others have {expected}"
    )]
    MapSize {
        /// The pose.
        pose: String,
        /// The key.
        key: f64,
        /// Texels per side of its map.
        found: u32,
        /// Texels per side of the first map.
        expected: u32,
    },
    /// A map could not be made a picture.
    #[error("a map cannot be encoded: {0}")]
    Encoding(String),
}
