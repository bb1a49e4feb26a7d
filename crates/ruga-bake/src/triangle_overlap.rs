//! Area that two UV triangles share.

use nalgebra::Vector2;

/// Shared area, relative to the smaller face, above which two faces overlap.
const OVERLAP_TOLERANCE: f64 = 1e-6;

/// Signed area, positive from U towards V.
pub(crate) fn area([a, b, c]: &[Vector2<f64>; 3]) -> f64 {
    (b - a).perp(&(c - a)) / 2.0
}

/// Whether two triangles share more than [`OVERLAP_TOLERANCE`] of the smaller one's area.
pub(crate) fn overlap(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> bool {
    // Of two convex shapes that are apart one has an edge line between them, so only overlaps, and
    // contacts blurred by rounding, are clipped.
    if separated(a, b) || separated(b, a) {
        return false;
    }
    // Relative to the smaller face: one that lies within a large face shares little of that.
    let smaller = area(a).abs().min(area(b).abs());
    shared_area(a, b) > OVERLAP_TOLERANCE * smaller
}

/// Says whether an edge line of `a` has `a` on one side and `b` on the other.
fn separated(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> bool {
    // The sign turns the edges of mirrored faces, so that the inside is to the left of each.
    let sign = area(a).signum();
    (0..3).any(|i| {
        let edge = (a[(i + 1) % 3] - a[i]) * sign;
        // Faces that touch in an edge or corner count as apart.
        b.iter().all(|p| edge.perp(&(p - a[i])) <= 0.0)
    })
}

/// Area of the intersection: `a` clipped by the three edges of `b` (Sutherland & Hodgman 1974).
pub(crate) fn shared_area(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> f64 {
    // Relative to a corner, so that small triangles far from the origin keep their digits.
    let origin = b[0];
    let sign = area(b).signum();
    let mut polygon: Vec<Vector2<f64>> = a.iter().map(|p| p - origin).collect();
    for i in 0..3 {
        let start = b[i] - origin;
        let edge = (b[(i + 1) % 3] - b[i]) * sign;
        let inside: Vec<f64> = polygon.iter().map(|p| edge.perp(&(p - start))).collect();
        let mut clipped = Vec::with_capacity(polygon.len() + 1);
        for at in 0..polygon.len() {
            let next = (at + 1) % polygon.len();
            if inside[at] >= 0.0 {
                clipped.push(polygon[at]);
            }
            if (inside[at] >= 0.0) != (inside[next] >= 0.0) {
                let t = inside[at] / (inside[at] - inside[next]);
                clipped.push(polygon[at] + (polygon[next] - polygon[at]) * t);
            }
        }
        polygon = clipped;
    }
    let fan = |i: usize| (polygon[i] - polygon[0]).perp(&(polygon[i + 1] - polygon[0]));
    (1..polygon.len().saturating_sub(1))
        .map(fan)
        .sum::<f64>()
        .abs()
        / 2.0
}
