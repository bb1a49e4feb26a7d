//! Rasterises fields over triangles in UV, sample by sample as a bake does.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::raster::{Placed, SampleGrid};

/// Rows of texels that one task works on.
const BAND_ROWS: usize = 16;

/// Size and sampling of a raster.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Raster {
    /// Texels per side.
    pub size: u32,
    /// Samples per texel along each side: 1, 2 or 4.
    pub supersample: u32,
    /// Lowest U and V of the unit square that is filled.
    pub square: [i32; 2],
}

impl Raster {
    /// The mean of `shade(face, barycentric)` over the covered samples of every texel; `None` where
    /// none is.
    ///
    /// Samples go to the first face that has them, so that a texel is covered exactly where
    /// [`bake`](crate::bake) covers it with the same triangles.
    pub(crate) fn fill<const N: usize>(
        self,
        uvs: &[[Vector2<f64>; 3]],
        shade: impl Fn(usize, [f64; 3]) -> [f64; N] + Sync,
    ) -> Vec<Option<[f64; N]>> {
        let grid = SampleGrid::new(self.size * self.supersample, self.square);
        let placed: Vec<Placed> = uvs.par_iter().map(|uvs| grid.place(uvs)).collect();
        let bands = grid.bands(&placed, BAND_ROWS as u32 * self.supersample);
        let side = self.size as usize;
        let mut texels = vec![None; side * side];
        texels
            .par_chunks_mut(BAND_ROWS * side)
            .zip(&bands)
            .enumerate()
            .for_each(|(band, (texels, faces))| {
                let mut sums = vec![([0.0; N], 0_u16); texels.len()];
                for &face in faces {
                    self.add_face(&grid, &placed, (band, face), &shade, &mut sums);
                }
                for (texel, (sum, owned)) in texels.iter_mut().zip(sums) {
                    let count = owned.count_ones();
                    *texel = (count > 0).then(|| sum.map(|c| c / f64::from(count)));
                }
            });
        texels
    }

    /// Adds the samples of one face that lie in a band and are free to the sums of its texels.
    fn add_face<const N: usize>(
        self,
        grid: &SampleGrid,
        placed: &[Placed],
        (band, face): (usize, u32),
        shade: &impl Fn(usize, [f64; 3]) -> [f64; N],
        sums: &mut [([f64; N], u16)],
    ) {
        let Placed::Inside(triangle) = &placed[face as usize] else {
            return;
        };
        let (side, supersample) = (self.size as usize, self.supersample);
        let first_row = (band * BAND_ROWS) as u32 * supersample;
        let end_row = first_row + (sums.len() / side) as u32 * supersample;
        let rows = grid.rows(triangle);
        for row in rows.start.max(first_row)..rows.end.min(end_row) {
            let Some(run) = grid.run(triangle, row) else {
                continue;
            };
            let texel_row = ((row - first_row) / supersample) as usize * side;
            for (step, column) in run.columns.clone().enumerate() {
                let (sum, owned) = &mut sums[texel_row + (column / supersample) as usize];
                let bit = 1 << (row % supersample * supersample + column % supersample);
                if *owned & bit != 0 {
                    continue;
                }
                *owned |= bit;
                let [u, v] = [0, 1].map(|c| run.start[c] + step as f64 * run.step[c]);
                let values = shade(face as usize, [u, v, 1.0 - u - v]);
                for (sum, value) in sum.iter_mut().zip(values) {
                    *sum += value;
                }
            }
        }
    }
}
