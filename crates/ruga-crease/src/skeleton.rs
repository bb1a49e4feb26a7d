//! Crease lines from the strokes of a grey image.

use nalgebra::Vector2;

use crate::CreaseError;
use crate::junctions::gathered;
use crate::pixel_graph::{Branch, branches, pruned};
use crate::thinning::Bitmap;

/// Share of an image that may be line.
const MOST_LINE: f64 = 0.5;

/// Rounds of averaging with both neighbours: together they smooth over one texel.
const SMOOTHINGS: usize = 4;

/// Texels between the points of a line: fewer would keep the staircase that is left.
const STRIDE: usize = 3;

/// A grey image, given as an array.
#[derive(Clone, Copy, Debug)]
pub struct GreyImage<'a> {
    /// Texels per row.
    pub width: usize,
    /// Rows; the first is on top, at `v = 0`.
    pub height: usize,
    /// Brightness, 0 to 1, row by row.
    pub values: &'a [f32],
}

/// Choices for lines that are drawn from an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkeletonSettings {
    /// Least brightness of a line, default 0.5.
    pub threshold: f64,
    /// Twigs shorter than this (texels) are left out, default 4; so are lines.
    pub least_branch: f64,
    /// Most lines that are accepted, default 128.
    pub most_lines: usize,
}

impl Default for SkeletonSettings {
    fn default() -> Self {
        Self {
            threshold: 0.5,
            least_branch: 4.0,
            most_lines: 128,
        }
    }
}

/// A line in an image.
#[derive(Clone, Debug, PartialEq)]
pub struct SkeletonLine {
    /// Texture coordinates.
    pub points: Vec<Vector2<f64>>,
    /// Half the width of the stroke at every point (texels).
    pub half_width: Vec<f64>,
    /// Whether the last point is joined to the first.
    pub is_closed: bool,
}

/// The middle lines of the bright strokes of an image, in reading order of where they begin. Where strokes meet,
/// lines end on each other: those of two strokes that cross, on one place in the middle.
///
/// # Errors
/// Every [`CreaseError`] about images.
pub fn skeleton_lines(
    image: &GreyImage<'_>,
    settings: &SkeletonSettings,
) -> Result<Vec<SkeletonLine>, CreaseError> {
    let GreyImage {
        width,
        height,
        values,
    } = *image;
    if width == 0 || height == 0 || width.checked_mul(height) != Some(values.len()) {
        return Err(CreaseError::ImageSize {
            width,
            height,
            values: values.len(),
        });
    }
    let is_bright = |value: &f32| f64::from(*value) >= settings.threshold;
    let is_set: Vec<bool> = values.iter().map(is_bright).collect();
    let bright = is_set.iter().filter(|set| **set).count();
    let none = CreaseError::NoLineInImage {
        bright,
        threshold: settings.threshold,
    };
    let share = bright as f64 / values.len() as f64;
    match bright {
        0 | 1 => return Err(none),
        _ if share > MOST_LINE => return Err(CreaseError::AllLineInImage { share }),
        _ => {}
    }
    let mut skeleton = Bitmap {
        width,
        height,
        is_set,
    };
    skeleton.fill_pinholes();
    let depths = skeleton.depths();
    skeleton.thin(&depths);
    let all = branches(&skeleton);
    // Judged before twigs go: noise is twigs.
    refuse_noise(all.len(), settings.most_lines.saturating_mul(4))?;
    let radius = |p: &Vector2<f64>| {
        let texel = p.map(|c| c.round() as usize);
        f64::from(depths[texel.y * width + texel.x]).sqrt()
    };
    let mut kept = gathered(pruned(all, settings.least_branch, radius), radius);
    kept.retain(|branch| branch.length() >= settings.least_branch);
    refuse_noise(kept.len(), settings.most_lines)?;
    if kept.is_empty() {
        return Err(none);
    }
    let start = |branch: &Branch| branch.points.first().map_or((0.0, 0.0), |p| (p.y, p.x));
    kept.sort_by(|a, b| {
        start(a)
            .partial_cmp(&start(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let lines = kept.into_iter().map(|branch| line(branch, image, &radius));
    let is_line = |line: &SkeletonLine| line.points.len() >= if line.is_closed { 3 } else { 2 };
    Ok(lines.filter(is_line).collect())
}

fn refuse_noise(branches: usize, limit: usize) -> Result<(), CreaseError> {
    match branches > limit {
        true => Err(CreaseError::TooManyBranches { branches, limit }),
        false => Ok(()),
    }
}

fn line(
    mut branch: Branch,
    image: &GreyImage<'_>,
    radius: &impl Fn(&Vector2<f64>) -> f64,
) -> SkeletonLine {
    let is_loop = branch.nodes.is_some_and(|[from, to]| from == to);
    if is_loop {
        branch.points.pop();
    }
    let is_closed = is_loop || branch.nodes.is_none();
    let last = branch.points.len() - 1;
    // Other lines end on nodes: there a line that begins and ends on one must stay.
    let is_fixed = |i: usize| i == 0 && branch.nodes.is_some() || i == last && !is_closed;
    let smooth = smoothed(&branch.points, is_fixed);
    // A small ring keeps three points, or it would be a way there and back.
    let stride = if is_closed {
        STRIDE.min(branch.points.len() / 3).max(1)
    } else {
        STRIDE
    };
    // The last point always stays, and none right before it.
    let is_kept = |i: usize| {
        i == last && !is_closed || i.is_multiple_of(stride) && (is_closed || i + stride / 2 < last)
    };
    let kept: Vec<_> = (0..=last).filter(|&i| is_kept(i)).collect();
    let size = Vector2::new(image.width as f64, image.height as f64);
    SkeletonLine {
        points: kept
            .iter()
            .map(|&i| (smooth[i] + Vector2::repeat(0.5)).component_div(&size))
            .collect(),
        // Radii reach to the centre of the first dark texel.
        half_width: kept
            .iter()
            .map(|&i| (radius(&branch.points[i]) - 0.5).max(0.5))
            .collect(),
        is_closed,
    }
}

/// Points averaged with their neighbours, round and round, but for fixed ones.
fn smoothed(points: &[Vector2<f64>], is_fixed: impl Fn(usize) -> bool) -> Vec<Vector2<f64>> {
    let mut points = points.to_vec();
    let count = points.len();
    for _ in 0..SMOOTHINGS {
        let average = |i: usize| {
            if is_fixed(i) {
                return points[i];
            }
            let (before, after) = (points[(i + count - 1) % count], points[(i + 1) % count]);
            points[i] * 0.5 + (before + after) * 0.25
        };
        points = (0..count).map(average).collect();
    }
    points
}
