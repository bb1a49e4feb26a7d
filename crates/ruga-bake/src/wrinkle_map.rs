//! Result of a bake.

use crate::error::same_length;
use crate::{BakeError, DetailMap};

/// Source of a texel's value, the weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coverage {
    /// Nothing near: neutral normal, height zero.
    Neutral,
    /// Outside the UV islands, or on their very border; copied from the nearest texel of one.
    Padded,
    /// Inside a UV island of the artist's mesh, but nothing was baked there: neutral.
    Skin,
    /// At least one sample lies in a triangle.
    Covered,
}

/// Normal and height map of one pose, row by row from the top of the image (V down).
#[derive(Debug, Clone, PartialEq)]
pub struct WrinkleMap {
    /// Texels per side.
    pub size: u32,
    /// Lowest U and V of the unit square of texture space that the map shows, V down: `[0, 0]` but for
    /// UDIM tiles.
    pub square: [i32; 2],
    /// Unit normals in tangent space: X along U, Y *up* (against V), Z outwards and positive.
    pub normals: Vec<[f32; 3]>,
    /// Height of the layer above its rest distance from the driver, m.
    pub heights: Vec<f32>,
    /// Source of each texel's value.
    pub coverage: Vec<Coverage>,
    /// Further quantities of the texels, each at most once.
    pub details: Vec<DetailMap>,
    /// Faces that left no mark because their UV triangle is degenerate, or spans more than eight
    /// sides of the square.
    pub skipped_faces: usize,
    /// Samples whose normal pointed below the tangent plane, where the layer folds over. They are
    /// tilted back to a Z of 0.02, as a normal map cannot hold them.
    pub folded_samples: usize,
}

impl WrinkleMap {
    /// Replaces what `upper` covers: a layer that lies on this one, over a part of it.
    ///
    /// Both maps are as [`bake`](crate::bake) returns them; padding comes last.
    ///
    /// # Errors
    /// [`BakeError::LengthMismatch`] when the maps differ in size.
    pub fn cover_with(&mut self, upper: &Self) -> Result<(), BakeError> {
        self.same_size(upper)?;
        for texel in 0..self.coverage.len() {
            // A neutral texel of the upper map says nothing: the lower layer's relief shows there.
            if upper.coverage[texel] == Coverage::Covered {
                self.normals[texel] = upper.normals[texel];
                self.heights[texel] = upper.heights[texel];
                self.coverage[texel] = Coverage::Covered;
                self.cover_details(upper, texel);
            }
        }
        self.count_in(upper);
        Ok(())
    }

    /// Adds the relief of a layer that lies beside this one and overlaps it by a margin.
    ///
    /// Heights add, and so do slopes (`x / z`, `y / z` of the normals), as those of a sum of two
    /// height fields do; a texel is covered where one of them covers it. This is the blend of reliefs
    /// that were *each faded before* over the margin. Without that, wrinkles of both stand in
    /// it at full height. Both maps are as [`bake`](crate::bake) returns them; padding comes last.
    ///
    /// # Errors
    /// [`BakeError::LengthMismatch`] when the maps differ in size.
    pub fn add(&mut self, other: &Self) -> Result<(), BakeError> {
        self.same_size(other)?;
        for texel in 0..self.coverage.len() {
            self.normals[texel] = sum_of_slopes(self.normals[texel], other.normals[texel]);
            self.heights[texel] += other.heights[texel];
            self.coverage[texel] = self.coverage[texel].max(other.coverage[texel]);
            self.add_details(other, texel);
        }
        self.count_in(other);
        Ok(())
    }

    /// A map of neutral texels, without details, over the unit square with this lowest U and V.
    pub fn neutral(size: u32, square: [i32; 2]) -> Self {
        let texels = size as usize * size as usize;
        Self {
            size,
            square,
            normals: vec![[0.0, 0.0, 1.0]; texels],
            heights: vec![0.0; texels],
            coverage: vec![Coverage::Neutral; texels],
            details: Vec::new(),
            skipped_faces: 0,
            folded_samples: 0,
        }
    }

    pub(crate) fn same_size(&self, other: &Self) -> Result<(), BakeError> {
        let texels = self.coverage.len();
        for map in [self, other] {
            same_length("normals", map.normals.len(), texels)?;
            same_length("heights", map.heights.len(), texels)?;
            same_length("coverage", map.coverage.len(), texels)?;
        }
        Ok(())
    }

    fn count_in(&mut self, other: &Self) {
        self.skipped_faces += other.skipped_faces;
        self.folded_samples += other.folded_samples;
    }
}

fn sum_of_slopes(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    // What is neutral changes nothing, not even the last bit.
    let is_neutral = |n: [f32; 3]| n[0] == 0.0 && n[1] == 0.0;
    if is_neutral(a) || is_neutral(b) {
        return if is_neutral(a) { b } else { a };
    }
    let [a, b] = [a, b].map(|n| n.map(f64::from));
    // Z is positive; times both of them a slope needs no division.
    let [x, y] = [0, 1].map(|c| a[c] * b[2] + b[c] * a[2]);
    let z = a[2] * b[2];
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|c| (c / length) as f32)
}
