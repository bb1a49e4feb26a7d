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
    /// Replaces what `upper` covers: a layer that lies on this one, over a part of it.
    ///
    /// Padding never hides what is covered.
    pub fn cover_with(&mut self, upper: &Self) {
        for texel in 0..self.coverage.len().min(upper.coverage.len()) {
            let covers = match upper.coverage[texel] {
                Coverage::Neutral => false,
                Coverage::Padded => self.coverage[texel] == Coverage::Neutral,
                Coverage::Covered => true,
            };
            if covers {
                self.normals[texel] = upper.normals[texel];
                self.heights[texel] = upper.heights[texel];
                self.coverage[texel] = upper.coverage[texel];
            }
        }
        self.skipped_faces += upper.skipped_faces;
        self.folded_samples += upper.folded_samples;
    }

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
