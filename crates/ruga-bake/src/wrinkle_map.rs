//! The result of a bake.

/// What a texel's value is based on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coverage {
    /// Nothing near: neutral normal, height zero.
    Neutral,
    /// Copied from the nearest covered texel.
    Padded,
    /// At least one sample lies in a triangle.
    Covered,
}

/// Normal and height map of one pose, row by row from the top of the image (V down).
#[derive(Debug, Clone, PartialEq)]
pub struct WrinkleMap {
    /// Texels per side.
    pub size: u32,
    /// Unit normals in tangent space: X along U, Y *up* (against V), Z outwards and positive.
    pub normals: Vec<[f32; 3]>,
    /// Height of the layer above its rest distance from the driver, m.
    pub heights: Vec<f32>,
    /// Where each texel comes from.
    pub coverage: Vec<Coverage>,
    /// Faces that left no mark because their UV triangle is degenerate, or spans more than eight
    /// tiles.
    pub skipped_faces: usize,
    /// Samples whose normal pointed below the tangent plane, where the layer folds over. They are
    /// tilted back to a Z of 0.02, as a normal map cannot hold them.
    pub folded_samples: usize,
}

impl WrinkleMap {
    /// A map of neutral texels.
    pub(crate) fn neutral(size: u32) -> Self {
        let texels = size as usize * size as usize;
        Self {
            size,
            normals: vec![[0.0, 0.0, 1.0]; texels],
            heights: vec![0.0; texels],
            coverage: vec![Coverage::Neutral; texels],
            skipped_faces: 0,
            folded_samples: 0,
        }
    }
}
