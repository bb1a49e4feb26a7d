//! The artist's mesh and its blend shapes, as the file holds them.

use nalgebra::{Vector2, Vector3};

/// A triangle mesh with UVs and blend shapes; vertices are split where UVs or normals are.
///
/// All per-vertex arrays have the length of `positions`.
#[derive(Clone, Debug, Default)]
pub struct ArtistMesh {
    /// Name of the mesh in its file.
    pub name: String,
    /// Rest positions, m.
    pub positions: Vec<Vector3<f64>>,
    /// Rest normals, where the file has them.
    pub normals: Option<Vec<Vector3<f64>>>,
    /// Texture coordinates the maps are baked in, V pointing down as in glTF.
    pub uvs: Option<Vec<Vector2<f64>>>,
    /// Vertices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Blend shapes (glTF: morph targets) in file order.
    pub shapes: Vec<BlendShape>,
}

/// One blend shape: what weight 1 adds to the rest shape.
#[derive(Clone, Debug, Default)]
pub struct BlendShape {
    /// Its name; `shape_0`, `shape_1`, … where the file gives none.
    pub name: String,
    /// Displacement of each vertex, m.
    pub position_deltas: Vec<Vector3<f64>>,
    /// Change of each normal; `None` where missing or all zero, which asks for recomputed normals.
    pub normal_deltas: Option<Vec<Vector3<f64>>>,
}
