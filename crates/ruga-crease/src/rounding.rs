//! Smooth curves through the points of a polyline.

use nalgebra::SVector;

use crate::Corners;

/// Turn (rad) beyond which a corner is kept: 60 degrees.
const CORNER: f64 = std::f64::consts::FRAC_PI_3;

/// Turn of a segment (rad) that sampling aims at: half of ten degrees, because the curvature of a span is not
/// even.
const SEGMENT_TURN: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// Most segments of one span, for spans that turn over and over.
const MOST_SEGMENTS: f64 = 72.0;

/// A polyline of short segments along a curve through some points, in order; each with the number of the point
/// that it is or follows.
///
/// Successive points that coincide count once. A closed curve comes back to its first point.
pub(crate) fn rounded<const D: usize>(
    points: &[SVector<f64, D>],
    is_closed: bool,
    corners: Corners,
) -> Vec<(SVector<f64, D>, usize)> {
    let mut kept: Vec<(SVector<f64, D>, usize)> = Vec::new();
    for (number, point) in points.iter().enumerate() {
        if kept.last().is_none_or(|last| last.0 != *point) {
            kept.push((*point, number));
        }
    }
    if is_closed && kept.len() > 1 && kept.first().map(|p| p.0) == kept.last().map(|p| p.0) {
        kept.pop();
    }
    let count = kept.len();
    if count < 2 {
        return kept;
    }
    let spans = if is_closed { count } else { count - 1 };
    let tangents = tangents(&kept, is_closed);
    let mut curve = vec![kept[0]];
    for span in 0..spans {
        let (from, to) = (&kept[span], &kept[(span + 1) % count]);
        let ends = [tangents[span].1, tangents[(span + 1) % count].0];
        if corners == Corners::Round {
            sample_span([from.0, to.0], ends, |point| curve.push((point, from.1)));
        }
        curve.push(*to);
    }
    curve
}

/// Unit tangents on arriving at and on leaving every point; they differ at corners.
fn tangents<const D: usize>(
    points: &[(SVector<f64, D>, usize)],
    is_closed: bool,
) -> Vec<(SVector<f64, D>, SVector<f64, D>)> {
    let count = points.len();
    let chord = |i: usize| (points[(i + 1) % count].0 - points[i].0).normalize();
    let smooth = |i: usize| {
        let is_end = !is_closed && (i == 0 || i + 1 == count);
        if is_end {
            return None;
        }
        let before = (i + count - 1) % count;
        let [arriving, leaving] = [chord(before), chord(i)];
        if angle(&arriving, &leaving) > CORNER {
            return None;
        }
        let around = points[(i + 1) % count].0 - points[before].0;
        around.try_normalize(0.0)
    };
    let smooth: Vec<_> = (0..count).map(smooth).collect();
    // A span that ends at a corner bends like a parabola: its tangent there mirrors the other end's.
    let open = |span: usize, far: usize| {
        let along = chord(span);
        let other = smooth[far].unwrap_or(along);
        2.0 * along * along.dot(&other) - other
    };
    let both = |i: usize| match smooth[i] {
        Some(tangent) => (tangent, tangent),
        None => {
            let before = (i + count - 1) % count;
            (open(before, before), open(i, (i + 1) % count))
        }
    };
    (0..count).map(both).collect()
}

/// Samples inside the Hermite span between two points with these unit tangents.
fn sample_span<const D: usize>(
    [from, to]: [SVector<f64, D>; 2],
    [leaving, arriving]: [SVector<f64, D>; 2],
    mut push: impl FnMut(SVector<f64, D>),
) {
    let chord = to - from;
    let length = chord.norm();
    let along = chord / length;
    let turn = angle(&leaving, &along) + angle(&along, &arriving);
    let count = (turn / SEGMENT_TURN).ceil().clamp(1.0, MOST_SEGMENTS);
    for step in 1..count as u32 {
        let t = f64::from(step) / count;
        let s = 1.0 - t;
        // Tangents as long as the chord: a quarter circle is met to 3 %.
        let ends = from * (s * s * (1.0 + 2.0 * t)) + to * (t * t * (3.0 - 2.0 * t));
        push(ends + (leaving * (s * s * t) - arriving * (s * t * t)) * length);
    }
}

/// Angle between two unit vectors, rad.
fn angle<const D: usize>(a: &SVector<f64, D>, b: &SVector<f64, D>) -> f64 {
    // From the chord, which keeps its digits where the cosine has none left.
    2.0 * (0.5 * (a - b).norm()).min(1.0).asin()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    fn turns(curve: &[(Vector2<f64>, usize)]) -> Vec<f64> {
        let chords = curve
            .windows(2)
            .map(|pair| (pair[1].0 - pair[0].0).normalize());
        let chords: Vec<_> = chords.collect();
        chords
            .windows(2)
            .map(|pair| angle(&pair[0], &pair[1]))
            .collect()
    }

    #[test]
    fn segments_of_a_rounded_ring_turn_by_less_than_ten_degrees() {
        for count in [7, 8, 12, 40] {
            let corner = |i: usize| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
                Vector2::new(cos, sin)
            };
            let ring: Vec<_> = (0..count).map(corner).collect();
            let curve = rounded(&ring, true, Corners::Round);
            assert_eq!(curve.first().map(|p| p.0), curve.last().map(|p| p.0));
            assert!(turns(&curve).iter().all(|turn| turn.to_degrees() < 10.0));
            assert!(curve.iter().all(|(p, _)| (p.norm() - 1.0).abs() < 0.02));
        }
    }

    #[test]
    fn sharp_corners_stay_and_flat_ones_are_rounded() {
        let points =
            [[0.0, 0.0], [1.0, 0.0], [1.8, 0.5], [1.8, 2.0], [0.5, 2.0]].map(Vector2::from);
        let curve = rounded(&points, false, Corners::Round);
        let sharp = turns(&curve)
            .into_iter()
            .filter(|turn| turn.to_degrees() > 10.0);
        assert_eq!(sharp.count(), 1);
        for point in points {
            assert!(curve.iter().any(|(p, _)| *p == point));
        }
        assert_eq!(rounded(&points, false, Corners::Keep).len(), 5);
        assert_eq!(rounded(&[points[0]; 3], false, Corners::Round).len(), 1);
    }
}
