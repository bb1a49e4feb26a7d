//! Rasterises a layer into a wrinkle map.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::raster::{GridTriangle, Placed, SampleGrid};
use crate::relief_normals::VertexRelief;
use crate::shading::TriangleShader;
use crate::{BakeError, Coverage, Frame, Relief, TangentFrame, WrinkleMap, bake_detailed};

/// Largest side of a map, texels.
pub const MAX_SIZE: u32 = 16384;

/// Rows of texels that one task works on. Small enough to balance, large enough that few
/// triangles are visited by two tasks.
const BAND_ROWS: usize = 16;

/// Size, sampling and tangent frame of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BakeSettings {
    /// Texels per side, `1..=`[`MAX_SIZE`]; default 2048.
    pub size: u32,
    /// Samples per texel along each side: 1, 2 or 4; default 1.
    pub supersample: u32,
    /// Frame that the normals are relative to.
    pub frame: Frame,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            size: 2048,
            supersample: 1,
            frame: Frame::Driver,
        }
    }
}

/// Bakes the normal and height map of one pose.
///
/// `frames` are those of the artist's *posed* mesh, indexed by [`Relief::artist`]. A sample at a
/// texel's centre (or `supersample`² of them) belongs to exactly one of the triangles that meet
/// there; where UVs overlap, to the first in face order. Vectors of several samples are added and
/// normalised, covered ones only. What lies outside `[0, 1]²` is cut off; [`bake_squares`](crate::bake_squares) bakes UDIM
/// tiles. The map is not padded: compose the maps of several layers first, then call
/// [`WrinkleMap::pad`].
///
/// # Errors
/// [`BakeError::Size`], [`BakeError::Supersample`], and the errors of inconsistent or non-finite
/// input, with the element.
pub fn bake(
    relief: &Relief,
    frames: &[[TangentFrame; 3]],
    settings: &BakeSettings,
) -> Result<WrinkleMap, BakeError> {
    bake_detailed(relief, frames, settings, &[])
}

impl BakeSettings {
    pub(crate) fn validate(&self) -> Result<(), BakeError> {
        if self.size == 0 || self.size > MAX_SIZE {
            return Err(BakeError::Size(self.size));
        }
        if !matches!(self.supersample, 1 | 2 | 4) {
            return Err(BakeError::Supersample(self.supersample));
        }
        Ok(())
    }
}

/// Normals and heights over the unit square with this lowest U and V, from valid input and the reliefs of
/// the layer's vertices in the frame of the settings.
pub(crate) fn painted(
    relief: &Relief,
    vertices: &[VertexRelief],
    frames: &[[TangentFrame; 3]],
    settings: &BakeSettings,
    square: [i32; 2],
) -> WrinkleMap {
    let mut map = WrinkleMap::neutral(settings.size, square);
    let painter = Painter {
        relief,
        vertices,
        frames,
        settings,
        grid: SampleGrid::new(settings.size * settings.supersample, square),
    };
    painter.paint(&mut map);
    map
}

/// Inputs and sample grid, which stay fixed while texels are filled.
struct Painter<'a> {
    relief: &'a Relief<'a>,
    vertices: &'a [VertexRelief],
    frames: &'a [[TangentFrame; 3]],
    settings: &'a BakeSettings,
    grid: SampleGrid,
}

/// The samples of one texel so far.
#[derive(Debug, Clone, Copy)]
struct Texel {
    normal: Vector3<f64>,
    height: f64,
    /// One bit per sample that has found its triangle.
    owned: u16,
}

impl Painter<'_> {
    fn paint(&self, map: &mut WrinkleMap) {
        let placed: Vec<Placed> = self
            .relief
            .uvs
            .par_iter()
            .map(|uvs| self.grid.place(uvs))
            .collect();
        map.skipped_faces = placed
            .iter()
            .filter(|p| matches!(p, Placed::Unusable))
            .count();
        let band_rows = BAND_ROWS as u32 * self.settings.supersample;
        // Every texel belongs to one band, and a band takes its faces in ascending order: no number
        // of threads changes which face a sample goes to.
        let bands = self.grid.bands(&placed, band_rows);
        let texels = BAND_ROWS * self.settings.size as usize;
        map.folded_samples = map
            .normals
            .par_chunks_mut(texels)
            .zip(map.heights.par_chunks_mut(texels))
            .zip(map.coverage.par_chunks_mut(texels))
            .zip(bands.par_iter())
            .enumerate()
            .map(|(band, (((normals, heights), coverage), faces))| {
                let (texels, folded) = self.paint_band(band, normals.len(), faces, &placed);
                for (index, texel) in texels.iter().enumerate() {
                    // The mean is over covered samples alone. Mixed with the neutral ones outside
                    // the island its border would come out flatter than the skin is.
                    let count = texel.owned.count_ones();
                    if count > 0 {
                        normals[index] = unit_f32(&texel.normal);
                        heights[index] = (texel.height / f64::from(count)) as f32;
                        coverage[index] = Coverage::Covered;
                    }
                }
                folded
            })
            .sum();
    }

    /// Fills one band; returns its texels and the number of folded samples.
    fn paint_band(
        &self,
        band: usize,
        texels: usize,
        faces: &[u32],
        placed: &[Placed],
    ) -> (Vec<Texel>, usize) {
        let empty = Texel {
            normal: Vector3::zeros(),
            height: 0.0,
            owned: 0,
        };
        // Sums of one band at a time: at 40 bytes per texel those of the largest map would take 11
        // GB.
        let mut buffer = vec![empty; texels];
        let mut folded = 0;
        for &face in faces {
            if let Placed::Inside(triangle) = &placed[face as usize] {
                folded += self.paint_face(band, face as usize, triangle, &mut buffer);
            }
        }
        (buffer, folded)
    }

    /// Adds one face to the texels of a band; returns the number of folded samples.
    fn paint_face(
        &self,
        band: usize,
        face: usize,
        triangle: &GridTriangle,
        buffer: &mut [Texel],
    ) -> usize {
        let size = self.settings.size as usize;
        let supersample = self.settings.supersample;
        let first_row = (band * BAND_ROWS) as u32 * supersample;
        let end_row = first_row + (buffer.len() / size) as u32 * supersample;
        let rows = self.grid.rows(triangle);
        let mut shader = None;
        let mut folded = 0;
        for row in rows.start.max(first_row)..rows.end.min(end_row) {
            let Some(run) = self.grid.run(triangle, row) else {
                continue;
            };
            // Most of the smallest triangles hold no sample and need no shader.
            let shader = shader.get_or_insert_with(|| {
                TriangleShader::new(
                    self.relief,
                    self.vertices,
                    self.frames,
                    self.settings.frame,
                    face,
                )
            });
            let texel_row = ((row - first_row) / supersample) as usize * size;
            for (step, column) in run.columns.clone().enumerate() {
                let texel = &mut buffer[texel_row + (column / supersample) as usize];
                // Up to 4 x 4 samples, which the 16 bits of `owned` hold.
                let bit = 1 << (row % supersample * supersample + column % supersample);
                if texel.owned & bit != 0 {
                    continue;
                }
                // A product instead of a running sum, which would collect rounding over long runs.
                let [u, v] = [0, 1].map(|c| run.start[c] + step as f64 * run.step[c]);
                let shaded = shader.shade([u, v, 1.0 - u - v]);
                texel.owned |= bit;
                texel.normal += shaded.normal;
                texel.height += shaded.height;
                folded += usize::from(shaded.folded);
            }
        }
        folded
    }
}

fn unit_f32(sum: &Vector3<f64>) -> [f32; 3] {
    // Every sample has a positive Z, so the sum cannot vanish.
    let unit = sum / sum.norm();
    [unit.x as f32, unit.y as f32, unit.z as f32]
}
