//! Texture coordinates of the head: the face laid flat as a disc, the back of the head as a smaller one
//! below it, an eyeball in each lower corner. Left and right are mirror images about `u = 0.5`.

use nalgebra::Vector2;

use super::lattice::{Lattice, Part, Site, Slit};
use super::openings::Openings;
use super::solid::Point;
use super::surface::disc;

/// Centre and radius of the face and of the back of the head in the texture, V down.
const FACE: ([f64; 2], f64) = ([0.5, 0.425], 0.405);
const BACK: ([f64; 2], f64) = ([0.5, 0.908], 0.07);

/// Sweeps after which no texture coordinate moves by a tenth of a texel any more.
const SWEEPS: usize = 2500;

/// Texture coordinates of the lattice's vertices, as the face's disc and as the back's.
pub(super) struct Unfolded {
    pub(super) face: Vec<Vector2<f64>>,
    pub(super) back: Vec<Vector2<f64>>,
}

/// Lays the face flat: each vertex a weighted mean of its neighbours, the rim a circle.
///
/// Weights are mean value coordinates (Floater 2003), which are positive, so that no triangle folds
/// over; threads across eyes and mouth make these part of the net.
pub(super) fn unfold(lattice: &Lattice, openings: &Openings, positions: &[Point]) -> Unfolded {
    let mirror = lattice.mirror();
    let mut weights = mean_value_weights(lattice, positions);
    span_openings(lattice, openings, positions, &mut weights);
    let mut flat: Vec<Vector2<f64>> = lattice.sites.iter().map(|site| disc(*site)).collect();
    for _ in 0..SWEEPS {
        for (id, site) in lattice.sites.iter().enumerate() {
            let moves = site.part != Part::Back && !is_rim(*site) && site.twice_column >= 0;
            if !moves {
                continue;
            }
            let sum: f64 = weights[id].iter().map(|(_, w)| w).sum();
            let mean: Vector2<f64> = weights[id].iter().map(|(n, w)| flat[*n] * (w / sum)).sum();
            flat[id] = mean;
            if site.twice_column == 0 {
                flat[id].x = 0.0;
            }
            flat[mirror[id]] = Vector2::new(-flat[id].x, flat[id].y);
        }
    }
    let into = |(centre, radius): ([f64; 2], f64), place: Vector2<f64>| {
        Vector2::new(centre[0] + radius * place.x, centre[1] - radius * place.y)
    };
    let face = flat
        .iter()
        .map(|place| into(FACE, enlarged(*place)))
        .collect();
    // The band around the back's hexagon is as wide as the lattice's edges there.
    let back = |site: &Site| {
        let share = if site.part == Part::Back { 0.92 } else { 1.0 };
        let place = disc(*site) * share;
        into(BACK, Vector2::new(-place.x, place.y))
    };
    let back = lattice.sites.iter().map(back).collect();
    Unfolded { face, back }
}

/// The disc with its middle enlarged at the cost of its rim: the face gets the texels that the sides of
/// the head do not need.
fn enlarged(place: Vector2<f64>) -> Vector2<f64> {
    /// Square of the enlargement in the middle, less one.
    const MORE: f64 = 1.6;
    place * ((1.0 + MORE) / (1.0 + MORE * place.norm_squared())).sqrt()
}

fn is_rim(site: Site) -> bool {
    site.part == Part::Front && site.ring() == super::lattice::RINGS
}

/// Ties each vertex at the inner edge of an upper lid or lip to the one below it, as by an edge between
/// equilateral triangles.
fn span_openings(
    lattice: &Lattice,
    openings: &Openings,
    positions: &[Point],
    weights: &mut [Vec<(usize, f64)>],
) {
    /// Length of a thread at least, m: the lips nearly touch.
    const SHORTEST: f64 = 2e-3;
    let inner = openings.slits().into_iter().flat_map(Slit::turns);
    for below in inner.map(|[_, inner]| inner) {
        if below.part != Part::InnerBelow {
            continue;
        }
        let above = Site {
            part: Part::InnerAbove,
            ..below
        };
        let [a, b] = [above, below].map(|site| lattice.id(site));
        let length = (positions[a] - positions[b]).norm().max(SHORTEST);
        let weight = 2.0 / 3.0_f64.sqrt() / length;
        weights[a].push((b, weight));
        weights[b].push((a, weight));
    }
}

/// Neighbours of each vertex in the face with their weights: `(tan(a/2) + tan(b/2)) / distance`, `a`
/// and `b` the angles beside the edge.
fn mean_value_weights(lattice: &Lattice, positions: &[Point]) -> Vec<Vec<(usize, f64)>> {
    let mut weights = vec![Vec::new(); lattice.sites.len()];
    let face = &lattice.triangles[..lattice.first_behind];
    for triangle in face {
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[(i + k) % 3]);
            let [ab, ac] = [b, c].map(|other| positions[other] - positions[a]);
            let (near, far) = (ab.norm(), ac.norm());
            // tan(angle / 2) = sin / (1 + cos), times both lengths.
            let half_tangent = ab.cross(&ac).norm() / (near * far + ab.dot(&ac));
            weights[a].push((b, half_tangent / near));
            weights[a].push((c, half_tangent / far));
        }
    }
    weights
}
