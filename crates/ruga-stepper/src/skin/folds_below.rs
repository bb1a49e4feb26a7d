//! The places of a layer that lie close to a fold of the layer below it.

use nalgebra::Vector3;
use ruga_mesh::{Id, MaterialPoint};

use crate::skin::fading::faded;
use crate::skin::skin_mesh::SkinMesh;

/// The nearest place on a crease line of the layer below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FoldBelow {
    /// Ends of the edge of the lower mesh that it lies on.
    pub(crate) ends: [usize; 2],
    /// Share of the way from the first to the second.
    pub(crate) fraction: f64,
    /// How much the place is beside the fold: 0 on it, 1 at the reach and beyond.
    pub(crate) beside: f64,
}

/// The fold of `lower` beside each of `places` on it, where there is one closer than `reach` (m, > 0); empty where it
/// has no creases.
pub(crate) fn folds_below(
    lower: &SkinMesh,
    places: &[MaterialPoint],
    reach: f64,
) -> Vec<Option<FoldBelow>> {
    if lower.creases.is_empty() {
        return Vec::new();
    }
    let rest = &lower.rest.positions;
    let edges = lower.creases.iter();
    let edges = edges.map(|crease| lower.mesh.edges()[crease.edge].vertices.map(Id::index));
    // Sorted by where they begin on an axis, those within reach are a window of them.
    let span = |ends: &[usize; 2]| {
        let [a, b] = ends.map(|v| rest[v].x);
        (a.min(b), a.max(b))
    };
    let mut edges: Vec<[usize; 2]> = edges.collect();
    edges.sort_by(|a, b| span(a).0.total_cmp(&span(b).0).then(a.cmp(b)));
    let widths = edges.iter().map(|ends| span(ends).1 - span(ends).0);
    let widest = widths.fold(0.0, f64::max);
    let fold = |place: &MaterialPoint| {
        let x = place.interpolate(&lower.mesh, rest);
        let first = edges.partition_point(|ends| span(ends).0 < x.x - reach - widest);
        let near = edges[first..].iter();
        let near = near.take_while(|ends| span(ends).0 <= x.x + reach);
        let nearest = near.map(|&ends| {
            let (fraction, distance) = closest(ends.map(|v| rest[v]), &x);
            (distance, ends, fraction)
        });
        let (distance, ends, fraction) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (distance < reach).then(|| FoldBelow {
            ends,
            fraction,
            beside: faded(distance, reach),
        })
    };
    places.iter().map(fold).collect()
}

/// Share of the way along a segment to its point closest to `x`, and the distance (m).
fn closest([a, b]: [Vector3<f64>; 2], x: &Vector3<f64>) -> (f64, f64) {
    let way = b - a;
    let fraction = ((x - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    (fraction, (a + way * fraction - x).norm())
}
