//! The frame that normals are relative to.

/// The tangent frame of normal maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Frame {
    /// The smooth posed driver's: only the wrinkles show.
    ///
    /// Such a map is neutral elsewhere, to be laid over the shading that is already there.
    #[default]
    Driver,
    /// The artist's own posed mesh's: what a high-to-low bake gives.
    ///
    /// Its normals are those of the file, interpolated.
    Mesh,
}
