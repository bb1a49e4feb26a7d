//! Check whether a mesh's UVs can carry a map.

use nalgebra::Vector2;

use crate::overlap_sweep::sweep;
use crate::triangle_overlap::{area, overlap};

/// Faces whose UVs stand in the way of a bake.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct UvReport {
    /// Faces with a UV that is not finite; they take no part in the other checks.
    pub missing: Vec<u32>,
    /// Faces that reach out of `[0, 1]²` by more than 1e-6.
    pub outside: Vec<u32>,
    /// Number of faces that must go until no two overlap; each of them overlaps an earlier face.
    pub overlapping: usize,
    /// `(face, earlier face)`: the first of them, at most [`MAX_OVERLAPS`], each with the first face
    /// that it overlaps.
    pub overlaps: Vec<(u32, u32)>,
    /// Faces whose UVs are mirrored: clockwise as seen in the image.
    pub mirrored: Vec<u32>,
    /// Faces whose UV area is below 1e-12.
    pub zero_area: Vec<u32>,
}

/// Overlaps that a report lists.
pub const MAX_OVERLAPS: usize = 16;

/// UV area, in units of the tile, below which a face has none: a millionth of a texel of a 1K map.
pub(crate) const MIN_AREA: f64 = 1e-12;

/// UVs exported as 32-bit floats miss the border of the tile by less than this.
const OUTSIDE_TOLERANCE: f64 = 1e-6;

/// Checks the UVs of every face's corners, V down.
///
/// Faces overlap when they share more than a millionth of the smaller one's area, so common edges
/// and corners are no overlap, whether or not they are the same vertices; a chart folded over an
/// edge is. A stack of n identical faces has n - 1 that overlap. Time grows as n log n and memory as
/// n, wherever the n faces lie.
pub fn check_uvs(uvs: &[[Vector2<f64>; 3]]) -> UvReport {
    let faces_where = |test: &dyn Fn(&[Vector2<f64>; 3]) -> bool| -> Vec<u32> {
        (0..uvs.len() as u32)
            .filter(|&face| test(&uvs[face as usize]))
            .collect()
    };
    let present = |uv: &[Vector2<f64>; 3]| uv.iter().flatten().all(|c| c.is_finite());
    let out = |c: &f64| *c < -OUTSIDE_TOLERANCE || *c > 1.0 + OUTSIDE_TOLERANCE;
    let with_area = faces_where(&|uv| present(uv) && area(uv).abs() > MIN_AREA);
    let overlapping = sweep(uvs, &with_area).taken_out;
    UvReport {
        missing: faces_where(&|uv| !present(uv)),
        outside: faces_where(&|uv| present(uv) && uv.iter().flatten().any(out)),
        overlapping: overlapping.len(),
        overlaps: first_overlaps(uvs, &with_area, &overlapping),
        // V points down, so what is counter-clockwise in the image has a negative area.
        mirrored: faces_where(&|uv| present(uv) && area(uv) > MIN_AREA),
        zero_area: faces_where(&|uv| present(uv) && area(uv).abs() <= MIN_AREA),
    }
}

/// The first of `overlapping`, each with the first of `faces` that it overlaps.
fn first_overlaps(
    uvs: &[[Vector2<f64>; 3]],
    faces: &[u32],
    overlapping: &[u32],
) -> Vec<(u32, u32)> {
    // Only those listed are compared with all earlier faces; to do so for every overlap would take
    // quadratic time.
    let listed = overlapping.iter().take(MAX_OVERLAPS);
    let pair = |&face: &u32| {
        let mut earlier = faces.iter().take_while(|&&other| other < face);
        let overlaps = |other: &&u32| overlap(&uvs[face as usize], &uvs[**other as usize]);
        Some((face, *earlier.find(overlaps)?))
    };
    listed.filter_map(pair).collect()
}
