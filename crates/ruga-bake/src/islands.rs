//! Texels inside the UV islands of a mesh.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::raster::{Placed, SampleGrid};

/// Rows of texels that one task works on.
const BAND_ROWS: u32 = 16;

/// Whether each texel's center lies in one of the triangles, row by row from the top, over the unit square
/// with this lowest U and V.
///
/// Decided on the integers of a bake without supersampling, so that the border of an island is the
/// border of the triangles baked there. Time grows with the rows that triangles reach over, not with
/// their area: a texture that repeats lays whole meshes over the same texels.
pub(crate) fn texels_inside(
    triangles: &[[Vector2<f64>; 3]],
    size: u32,
    square: [i32; 2],
) -> Vec<bool> {
    let grid = SampleGrid::new(size, square);
    let placed: Vec<Placed> = triangles.par_iter().map(|t| grid.place(t)).collect();
    let bands = grid.bands(&placed, BAND_ROWS);
    let side = size as usize;
    let mut inside = vec![false; side * side];
    inside
        .par_chunks_mut(side * BAND_ROWS as usize)
        .zip(&bands)
        .enumerate()
        .for_each(|(band, (texels, faces))| {
            for (row, texels) in (band as u32 * BAND_ROWS..).zip(texels.chunks_mut(side)) {
                fill_row(&grid, &placed, faces, row, texels);
            }
        });
    inside
}

fn fill_row(grid: &SampleGrid, placed: &[Placed], faces: &[u32], row: u32, texels: &mut [bool]) {
    // Runs begun less runs ended: their number at a texel is the sum up to there.
    let mut changes = vec![0_i32; texels.len() + 1];
    for &face in faces {
        if let Placed::Inside(triangle) = &placed[face as usize]
            // A band lists every face that reaches one of its rows; most miss this one.
            && grid.rows(triangle).contains(&row)
            && let Some(run) = grid.run(triangle, row)
        {
            changes[run.columns.start as usize] += 1;
            changes[run.columns.end as usize] -= 1;
        }
    }
    let mut count = 0;
    for (texel, change) in texels.iter_mut().zip(changes) {
        count += change;
        *texel = count > 0;
    }
}
