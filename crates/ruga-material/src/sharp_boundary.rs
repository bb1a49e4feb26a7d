//! Sharp boundaries in a painted map, as feature edges of a mesh.
//!
//! Li 2014, 6.2, assumes smooth maps: across a boundary that no edge follows, a stiffness is smeared
//! over a triangle, and wrinkles with it. The remedy takes two steps, both told from here:
//! [`PropertyMap::crossings`] says where a mesh edge passes a boundary, so that a remesher can split
//! it there; once no edge passes one, [`sharp_edges`] marks the edges that lie on it.
//!
//! What is sharp: where the paint changes by at least a given ratio within a square of 4 x 4 texels,
//! and hardly more than that within 8 x 8, which tells a step from a ramp however steep. Where the
//! boundary is: where the value, bilinear between texels, passes the mean of the smaller square's
//! extremes. So an antialiased boundary, with up to two texels in between, is found once, and one that
//! was blurred over four or more is a ramp. Left open are corners of a boundary inside a face (no edge
//! passes them), the lesser of two boundaries within four texels, and noise in the paint, which comes
//! out as many small boundaries; the ratio should be well above it.

use nalgebra::Vector2;

use crate::property_map::{PlacedImage, PropertyImage};
use crate::{MaterialError, PropertyMap, RelativeProperties};

/// Crossing of a straight line in UV with a sharp boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryCrossing {
    /// Share of the way along the line, from 0 to 1. Near 0 or 1 the end itself lies on the
    /// boundary, as it does after a split.
    pub parameter: f64,
    /// The larger value at the boundary over the smaller one.
    pub ratio: f64,
}

/// The jump that counts as sharp unless the caller knows better: far above what an 8-bit image
/// resolves, and below any step that changes the wavelength visibly.
pub const SHARP_RATIO: f64 = 1.2;

/// Samples along one line at most: twice the sides of the largest image, however far UVs repeat.
const MOST_STEPS: f64 = 65_536.0;

impl PropertyMap {
    /// Crossings of the line from `from` to `to` in UV with boundaries at which a property changes
    /// by `jump_ratio` or more, in order along the line.
    ///
    /// On a UV seam the two sides of an edge are two lines, and may disagree; then the one with the
    /// larger ratio counts. Steps of half a texel; positions to about 1e-9 of the line. Crossings of
    /// several properties within half a texel are one. Of UDIM tiles only the one is looked at in which
    /// the middle of the line lies: an edge of a mesh lies in one.
    ///
    /// # Errors
    /// [`MaterialError::JumpRatio`] unless `jump_ratio` is finite and above 1.
    pub fn crossings(
        &self,
        from: &Vector2<f64>,
        to: &Vector2<f64>,
        jump_ratio: f64,
    ) -> Result<Vec<BoundaryCrossing>, MaterialError> {
        require_jump_ratio(jump_ratio)?;
        let line = |parameter: f64| from + (to - from) * parameter;
        let mut found = Vec::new();
        let mut texels: f64 = 0.0;
        for placed in self.images_at(&line(0.5)) {
            let length = length_in_texels(placed.image, from, to);
            texels = texels.max(length);
            // Half a texel at most along either side, so that no step jumps over a column or row of
            // texels.
            let steps = (2.0 * length).ceil().clamp(1.0, MOST_STEPS) as u32;
            walk(&placed, &line, steps, jump_ratio, &mut found);
        }
        found.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
        let mut merged: Vec<BoundaryCrossing> = Vec::new();
        for crossing in found {
            match merged.last_mut() {
                // One boundary painted into several properties is to be cut once.
                Some(last) if (crossing.parameter - last.parameter) * texels < 0.5 => {
                    if crossing.ratio > last.ratio {
                        *last = crossing;
                    }
                }
                _ => merged.push(crossing),
            }
        }
        Ok(merged)
    }
}

/// Adds the crossings of a line with the boundaries of one image.
fn walk(
    placed: &PlacedImage<'_>,
    line: &impl Fn(f64) -> Vector2<f64>,
    steps: u32,
    jump_ratio: f64,
    found: &mut Vec<BoundaryCrossing>,
) {
    let value = |parameter: f64| placed.sample(&line(parameter));
    let place = |step: u32| f64::from(step) / f64::from(steps);
    let mut before = value(0.0);
    for step in 0..steps {
        let (start, end) = (place(step), place(step + 1));
        let after = value(end);
        let middle = line(0.5 * (start + end));
        let [low, high] = extremes(placed, &middle, 1);
        // The level comes from the square, not from the ends of the step, so that all steps
        // across one boundary look for the same place.
        let level = 0.5 * (low + high);
        let passes = (before < level) != (after < level);
        if passes && high >= jump_ratio * low && is_step(placed, &middle, high - low) {
            let below = |parameter: f64| value(parameter) < level;
            found.push(BoundaryCrossing {
                parameter: bisect(start, end, before < level, below),
                ratio: high / low,
            });
        }
        before = after;
    }
}

/// Says whether the paint changes within 8 x 8 texels by little more than its `change` within
/// 4 x 4.
fn is_step(placed: &PlacedImage<'_>, uv: &Vector2<f64>, change: f64) -> bool {
    // A ramp over 3 texels has all of its change in the smaller square, one over 4 three quarters.
    const SHARE: f64 = 0.8;
    let [low, high] = extremes(placed, uv, 3);
    change >= SHARE * (high - low)
}

/// Smallest and largest value of the four texels around `uv` and `rings` of texels about them.
fn extremes(placed: &PlacedImage<'_>, uv: &Vector2<f64>, rings: i64) -> [f64; 2] {
    let image = placed.image;
    let cell = image.cell(&(uv - placed.origin));
    let mut extremes = [f64::INFINITY, f64::NEG_INFINITY];
    for row in -rings..=rings + 1 {
        for column in -rings..=rings + 1 {
            let c = image.texel(
                cell.column.saturating_add(column),
                cell.row.saturating_add(row),
                placed.wrap,
            );
            let value = image.relative(c);
            extremes = [extremes[0].min(value), extremes[1].max(value)];
        }
    }
    extremes
}

/// The end of the part of `[start, end]` that is like its start.
fn bisect(start: f64, end: f64, at_start: bool, below: impl Fn(f64) -> bool) -> f64 {
    // Halves a step 30 times: 1e-9 of it.
    const HALVINGS: usize = 30;
    let (mut start, mut end) = (start, end);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (start + end);
        if below(middle) == at_start {
            start = middle;
        } else {
            end = middle;
        }
    }
    0.5 * (start + end)
}

/// Columns or rows that the line passes, whichever is more.
fn length_in_texels(image: &PropertyImage, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
    let way = to - from;
    (way.x * image.width as f64)
        .abs()
        .max((way.y * image.height as f64).abs())
}

/// Marks the edges between whose two faces a property jumps by `jump_ratio` or more.
///
/// `edge_faces`: per edge the indices of its two faces in `faces`, `None` beyond a border, which is
/// never marked: it is a feature anyway. `faces`: the values of [`PropertyMap::sample_face`].
///
/// # Errors
/// [`MaterialError::JumpRatio`] unless `jump_ratio` is finite and above 1.
///
/// # Panics
/// When an index is not one of a face.
pub fn sharp_edges(
    edge_faces: &[[Option<usize>; 2]],
    faces: &[RelativeProperties],
    jump_ratio: f64,
) -> Result<Vec<bool>, MaterialError> {
    require_jump_ratio(jump_ratio)?;
    let sharp = |pair: &[Option<usize>; 2]| match *pair {
        [Some(one), Some(other)] => faces[one].jump_to(&faces[other]) >= jump_ratio,
        _ => false,
    };
    Ok(edge_faces.iter().map(sharp).collect())
}

fn require_jump_ratio(value: f64) -> Result<(), MaterialError> {
    if value > 1.0 && value.is_finite() {
        Ok(())
    } else {
        Err(MaterialError::JumpRatio { value })
    }
}
