//! A burning sheet as maps show it.

use nalgebra::Vector2;

/// Temperature and fuel of a sheet that burns, over all of it as it was when fresh.
///
/// They live on a mesh of their own that is as fine as the front needs, and finer than the sheet's. Everything is
/// linear in its triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BurntSurface {
    /// Triangles.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinates of the corners of every triangle, V down.
    pub uvs: Vec<[Vector2<f64>; 3]>,
    /// Temperature of every vertex, K.
    pub temperature: Vec<f64>,
    /// Fuel share of every vertex, from 1, fresh, to 0, burnt out.
    pub fuel: Vec<f64>,
    /// Fuel share above that at which the sheet falls off, per vertex: it is still there where this is positive.
    pub level: Vec<f64>,
    /// Thickness of what has burnt out, over that of the fresh sheet.
    pub char_thickness: f64,
}
