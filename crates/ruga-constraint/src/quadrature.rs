//! The kernel integrated over the faces of a chart, and its transfer to vertices.

use nalgebra::Vector2;

use crate::Kernel;
use crate::chart::Chart;
use crate::moments::Moments;

/// Faces are cut until their edges are no longer than this share of the support radius: a rule of
/// degree two then misses the moments of the Gaussian by 1e-4 of the radius, mostly at its rim.
const LONGEST_EDGE: f64 = 1.0 / 12.0;

/// Cuts of one face after which its pieces are taken as they are: a face that is 1e15 times as long
/// as the support holds no more digits of its place.
const MAX_CUTS: u32 = 110;

/// A point of the surface with the part of the kernel that it stands for.
pub(crate) struct Point {
    corners: [u32; 3],
    barycentric: [f64; 3],
    /// Place in the chart, m.
    pub(crate) place: Vector2<f64>,
    /// Kernel times area; not negative.
    pub(crate) weight: f64,
}

/// Points over what the centre sees of the support, with the kernel's weights.
pub(crate) fn quadrature_points(chart: &Chart, kernel: &Kernel) -> Vec<Point> {
    let mut points = Vec::new();
    for &corners in &chart.faces {
        let places = corners.map(|s| chart.places[s as usize]);
        let area = cross(places[1] - places[0], places[2] - places[0]);
        for piece in small_pieces(places, kernel.radius()) {
            let spread = piece.inner_points().map(|barycentric| {
                let place = at(places, barycentric);
                Point {
                    corners,
                    barycentric,
                    place,
                    weight: area * piece.share / 3.0 * kernel.weight(place.norm()),
                }
            });
            points.extend(spread.into_iter().filter(|point| point.weight > 0.0));
        }
    }
    points
}

/// A triangle in pieces that are small compared to the support, without those outside of it.
fn small_pieces(triangle: [Vector2<f64>; 3], radius: f64) -> Vec<Piece> {
    let mut small = Vec::new();
    let mut pieces = vec![Piece::WHOLE];
    while let Some(piece) = pieces.pop() {
        let spots = piece.corners.map(|b| at(triangle, b));
        let middle = (spots[0] + spots[1] + spots[2]) / 3.0;
        let distances = spots.iter().map(|spot| (spot - middle).norm());
        // By the piece's own disc, which is cheaper than its distance; what is kept in vain gets no
        // weight.
        if middle.norm() - distances.fold(0.0, f64::max) >= radius {
            continue;
        }
        // Cut across the longest edge: slivers become rounder, and every length ends below the
        // bound.
        let (side, length) = longest_edge(spots);
        if length > LONGEST_EDGE * radius && piece.cuts < MAX_CUTS {
            pieces.extend(piece.halves(side));
        } else {
            small.push(piece);
        }
    }
    small
}

/// Moments of the kernel over what its centre sees.
///
/// Those of a full support are known; those of a clipped one depend on the triangulation only
/// through the error of the quadrature, of which `points` are asked for then only.
pub(crate) fn kernel_moments(
    chart: &Chart,
    kernel: &Kernel,
    points: impl FnOnce() -> Vec<Point>,
) -> Moments {
    let clipped = chart.is_clipped.then(|| {
        let points = points();
        Moments::of(points.iter().map(|point| (point.place, point.weight)))
    });
    let round = || Moments::round(kernel.second_moment());
    clipped.flatten().unwrap_or_else(round)
}

/// Weights of the chart's vertices: `w_i = Σ_q g_q φ_i(u_q)` with φ the hat functions.
pub(crate) fn gather(chart: &Chart, points: &[Point], weights: &[f64]) -> Vec<f64> {
    let mut gathered = vec![0.0; chart.vertices.len()];
    for (point, weight) in points.iter().zip(weights) {
        for (slot, b) in point.corners.iter().zip(point.barycentric) {
            gathered[*slot as usize] += b * weight;
        }
    }
    gathered
}

/// Part of a face.
struct Piece {
    /// Barycentric coordinates in the face.
    corners: [[f64; 3]; 3],
    /// Share of the face's area.
    share: f64,
    cuts: u32,
}

impl Piece {
    const WHOLE: Self = Self {
        corners: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        share: 1.0,
        cuts: 0,
    };

    /// Cut from the middle of the edge that begins at corner `side`.
    fn halves(&self, side: usize) -> [Self; 2] {
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[(side + i) % 3]);
        let middle = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
        [[a, middle, c], [middle, b, c]].map(|corners| Self {
            corners,
            // A half is exact, where areas computed of tiny pieces would not sum to that of the
            // face.
            share: 0.5 * self.share,
            cuts: self.cuts + 1,
        })
    }

    /// The three points of equal weight that integrate quadratic functions exactly.
    fn inner_points(&self) -> [[f64; 3]; 3] {
        let [a, b, c] = self.corners;
        [[a, b, c], [b, c, a], [c, a, b]]
            .map(|[a, b, c]| [0, 1, 2].map(|i| (4.0 * a[i] + b[i] + c[i]) / 6.0))
    }
}

fn at(places: [Vector2<f64>; 3], barycentric: [f64; 3]) -> Vector2<f64> {
    places[0] * barycentric[0] + places[1] * barycentric[1] + places[2] * barycentric[2]
}

/// The corner that the longest edge begins at, and its length.
fn longest_edge(spots: [Vector2<f64>; 3]) -> (usize, f64) {
    let length = |i: usize| (spots[(i + 1) % 3] - spots[i]).norm();
    [0, 1, 2]
        .map(|i| (i, length(i)))
        .into_iter()
        .fold(
            (0, 0.0),
            |longest, edge| {
                if edge.1 > longest.1 { edge } else { longest }
            },
        )
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}
