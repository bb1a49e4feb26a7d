//! Extends the islands of a map by their nearest texels.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::error::all_finite;
use crate::islands::texels_inside;
use crate::{BakeError, Coverage, WrinkleMap};

/// No texel of an island within reach in this column.
const FAR: i32 = i32::MAX;

impl WrinkleMap {
    /// Extends every UV island by `padding` texels, so that filtering at its border meets no
    /// foreign value. The last step, after all layers are composed.
    ///
    /// `islands` are the UVs of *all* triangles of the artist's mesh, V down, not only those whose
    /// skin was simulated. Texels inside them that nothing covers are [`Coverage::Skin`]: they stay
    /// neutral, whatever wrinkles beside them. Texels outside within `padding` (Euclidean, centre to
    /// centre) of an island take the value of its nearest texel.
    ///
    /// # Errors
    /// [`BakeError::NotFinite`] naming the triangle.
    pub fn pad(&mut self, islands: &[[Vector2<f64>; 3]], padding: u32) -> Result<(), BakeError> {
        all_finite("islands", islands, |corners| {
            corners.iter().flatten().all(|c| c.is_finite())
        })?;
        for texel in bare_skin(
            &self.coverage,
            &texels_inside(islands, self.size, self.square),
            self.size,
        ) {
            self.coverage[texel] = Coverage::Skin;
        }
        extend(self, padding);
        Ok(())
    }
}

/// Copies to every texel outside the islands within `padding` (Euclidean, centre to centre) of one
/// inside the value of the nearest texel inside.
///
/// Exact: the nearest texel of each column first, then the best of the columns. Of equally near
/// texels the one in the nearer column is taken, left before right and above before below.
fn extend(map: &mut WrinkleMap, padding: u32) {
    let size = map.size as usize;
    // No two texels are farther apart than the diagonal, less than two sides.
    let reach = padding.min(2 * map.size) as i32;
    if reach == 0 {
        return;
    }
    let vertical = vertical_distances(&map.coverage, size, reach);
    // All sources are found before the first is copied: rows then only read the map, and can be
    // searched in parallel.
    let sources: Vec<(usize, usize)> = (0..size)
        .into_par_iter()
        .flat_map_iter(|row| row_sources(row, size, reach, &map.coverage, &vertical))
        .collect();
    for (target, source) in sources {
        map.normals[target] = map.normals[source];
        map.heights[target] = map.heights[source];
        map.coverage[target] = Coverage::Padded;
        for detail in &mut map.details {
            detail.copy(source, target);
        }
    }
}

/// Says whether padding copies from such a texel.
///
/// Bare skin counts, so that an island's neutral side does not get the wrinkles of the next island.
fn is_source(coverage: Coverage) -> bool {
    matches!(coverage, Coverage::Covered | Coverage::Skin)
}

/// Signed number of rows to the nearest texel of an island in the same column, or [`FAR`].
fn vertical_distances(coverage: &[Coverage], size: usize, reach: i32) -> Vec<i32> {
    let mut distances = vec![FAR; coverage.len()];
    let rows = distances.chunks_mut(size).zip(coverage.chunks(size));
    // Two sweeps, down and up: negative distances lead to the texel above, positive to the one
    // below.
    let mut last = vec![FAR; size];
    for (distances, coverage) in rows {
        for ((distance, above), here) in distances.iter_mut().zip(&mut last).zip(coverage) {
            *above = match here {
                here if is_source(*here) => 0,
                _ if *above == FAR || *above <= -reach => FAR,
                _ => *above - 1,
            };
            *distance = *above;
        }
    }
    last.fill(FAR);
    let rows = distances.chunks_mut(size).zip(coverage.chunks(size));
    for (distances, coverage) in rows.rev() {
        for ((distance, below), here) in distances.iter_mut().zip(&mut last).zip(coverage) {
            *below = match here {
                here if is_source(*here) => 0,
                _ if *below == FAR || *below >= reach => FAR,
                _ => *below + 1,
            };
            // A texel above wins a tie.
            if *below != FAR && (*distance == FAR || *below < -*distance) {
                *distance = *below;
            }
        }
    }
    distances
}

/// Pairs (texel outside the islands, nearest texel inside) of one row.
fn row_sources(
    row: usize,
    size: usize,
    reach: i32,
    coverage: &[Coverage],
    vertical: &[i32],
) -> Vec<(usize, usize)> {
    let distances = &vertical[row * size..(row + 1) * size];
    if distances.iter().all(|&d| d == FAR) {
        return Vec::new();
    }
    (0..size)
        .filter(|column| !is_source(coverage[row * size + column]))
        .filter_map(|column| {
            let (source, rows) = nearest(column, distances, reach)?;
            let source_row = (row as i32 + rows) as usize;
            Some((row * size + column, source_row * size + source))
        })
        .collect()
}

/// Column and row offset of the texel of an island nearest to `column`, within `reach`.
fn nearest(column: usize, distances: &[i32], reach: i32) -> Option<(usize, i32)> {
    let mut best = None;
    // One more than the reach squared, so that a texel just at the reach is taken.
    let mut best_squared = i64::from(reach) * i64::from(reach) + 1;
    for step in 0..=reach as usize {
        let across = (step * step) as i64;
        // Columns from here on are further away than the best texel is.
        if across >= best_squared {
            break;
        }
        let sides = [column.checked_sub(step), Some(column + step)];
        for side in sides.into_iter().flatten().filter(|&s| s < distances.len()) {
            let rows = distances[side];
            if rows == FAR {
                continue;
            }
            let squared = across + i64::from(rows) * i64::from(rows);
            if squared < best_squared {
                best_squared = squared;
                best = Some((side, rows));
            }
        }
    }
    best
}

/// The texels inside islands that nothing covers.
///
/// A layer's border runs along the border of an island, but its vertices on the middle of the
/// artist's edges are rounded: a texel whose center lies on such an edge may be inside the island and
/// beside the layer. So a texel between what is covered and the outside is left to padding.
fn bare_skin(coverage: &[Coverage], inside: &[bool], size: u32) -> Vec<usize> {
    let is_covered = |texel: usize| coverage[texel] == Coverage::Covered;
    let is_outside = |texel: usize| !inside[texel] && !is_covered(texel);
    let beside = |texel: usize, is_it: &(dyn Fn(usize) -> bool + Sync)| {
        let side = size as usize;
        let [row, column] = [texel / side, texel % side];
        let around = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
        around(row).any(|row| around(column).any(|column| is_it(row * side + column)))
    };
    (0..coverage.len().min(inside.len()))
        .into_par_iter()
        .filter(|&texel| inside[texel] && !is_covered(texel))
        .filter(|&texel| !beside(texel, &is_covered) || !beside(texel, &is_outside))
        .collect()
}
