//! Relief that fades where skin is strained too little to wrinkle, or bent too sharply.

use std::f64::consts::PI;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_material::Wrinkling;
use ruga_mesh::{Id, TriMesh, VertexId, edge_distances_with_starts, vertex_areas};

use crate::skin::fading::{distances_from, faded};
use crate::skin::relief::FADE;

/// Strain ratio below which skin is quiet: it shows no relief. The layer is not quite flat there, because
/// waves next to it die out slowly and the painted thickness changes, but in a map that is dirt.
const QUIET: f64 = 0.5;

/// Radius (wavelengths) of the smallest patch of quiet skin. Less of it would be a hole in the relief around it. What
/// is a quarter of a wavelength away from other skin is to be quiet even where paths along edges are longer than that.
const SMALLEST_QUIET: f64 = 0.2;

/// Radius (wavelengths) of the smallest patch of wrinkled skin. Less has no room for a wave, and what it shows is
/// speckle.
const SMALLEST_WRINKLED: f64 = 0.25;

/// Waves shorter than this, in critical wavelengths, are none of the layer's own.
const SHORTEST: f64 = 0.4;

/// Length of paths along edges over that of straight ones, at most, on regular meshes: discs reach back so far, not to
/// leave a seam.
const LONGER_PATHS: f64 = 1.15;

/// Vertices around which a thread looks at least: every part of the work fills a mark for each of all vertices.
const CENTRES_AT_ONCE: usize = 4096;

/// Radius (wavelengths) within which the surface may turn only so far.
const TURN_RADIUS: f64 = 0.25;

/// Radius (wavelengths) of the discs over which distances from flat skin are averaged, at most. Halfway between two
/// borders that are less than a wavelength apart, as on lids, distances have a ridge, and along edges they are uneven:
/// both would be short waves in the relief that they fade.
const ROUNDED: f64 = 0.2;

/// Length (wavelengths) that an edge from flat skin to other skin counts as at most: on a mesh with longer ones half of
/// the fade would be the slope of one face.
const LONG: f64 = 1.0 / 8.0;

/// Demand of the surface below on a layer at a vertex, and the bend that the layer can follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VertexDemand {
    /// Effective strain in critical strains.
    pub(crate) strain_ratio: f64,
    /// Critical wavelength, m.
    pub(crate) wavelength: f64,
    /// Largest angle by which the normal may turn within [`TURN_RADIUS`], rad.
    pub(crate) turn: f64,
}

impl VertexDemand {
    /// Demand at a strain ratio on a layer that wrinkles like this.
    ///
    /// A cylinder of radius `R` adds `C/R²` to the springs against waves along its axis, which shortens
    /// them to `(1 + C/(R² K0))^(-1/4)` of the critical wavelength. Where that is less than 40 %, as on
    /// the rims of lids and lips, the surface is bent about as sharply as the layer is thick, and the
    /// layer cannot wrinkle as a thin sheet does.
    pub(crate) fn new(strain_ratio: f64, wrinkling: &Wrinkling) -> Self {
        let springs = wrinkling.normal_stiffness / wrinkling.membrane_stiffness;
        let sharpest = ((SHORTEST.powi(-4) - 1.0) * springs).sqrt();
        Self {
            strain_ratio,
            wavelength: wrinkling.wavelength,
            turn: sharpest * TURN_RADIUS * wrinkling.wavelength,
        }
    }
}

/// Share of the relief at every vertex of a mesh with these places at rest (m) and normals below it: 0 in
/// quiet skin, at vertices that are `held` and where the surface is bent too sharply; 1 from half a
/// wavelength beyond all of them on.
pub(crate) fn wrinkled_shares(
    mesh: &TriMesh,
    (rest, normals): (&[Vector3<f64>], &[Vector3<f64>]),
    demands: &[VertexDemand],
    held: &[bool],
) -> Vec<f64> {
    let longest = demands.iter().map(|d| d.wavelength).fold(0.0, f64::max);
    // Distances in wavelengths.
    let reaches = |set: &[bool], reach: f64| -> Vec<f64> {
        let distances = distances_from(mesh, rest, set, reach * longest).into_iter();
        let pairs = distances.zip(demands);
        pairs.map(|(to, own)| to / own.wavelength).collect()
    };
    // The part of a set in which a disc of this radius finds room beside the others.
    let opened = |others: &[bool], radius: f64| -> Vec<bool> {
        let away = reaches(others, radius);
        let centres = disc_centres((mesh, rest), demands, (&away, radius));
        let reach = radius * LONGER_PATHS;
        let from_centres = edge_distances_with_starts(mesh, rest, centres, reach * longest);
        let pairs = from_centres.as_slice().iter().zip(demands).zip(others);
        pairs
            .map(|((to, own), other)| to / own.wavelength <= reach && !other)
            .collect()
    };
    let mut is_flat = held.to_vec();
    for vertex in sharply_bent(mesh, (rest, normals), demands) {
        is_flat[vertex.index()] = true;
    }
    let states = demands.iter().zip(&is_flat);
    let is_loud = states.map(|(own, flat)| !*flat && own.strain_ratio >= QUIET);
    let is_quiet = opened(&is_loud.collect::<Vec<_>>(), SMALLEST_QUIET);
    for (flat, quiet) in is_flat.iter_mut().zip(is_quiet) {
        // What is held may be a line, which has no room for a disc.
        *flat |= quiet;
    }
    let has_room = opened(&is_flat, SMALLEST_WRINKLED);
    let is_flat: Vec<bool> = has_room.into_iter().map(|room| !room).collect();
    let from_flat = distances_from_flat((mesh, rest), demands, &is_flat);
    let from_flat = rounded((mesh, rest), demands, &from_flat).into_iter();
    from_flat.map(|distance| faded(distance, FADE)).collect()
}

/// Distances from flat skin (wavelengths), up to where relief is whole; a long edge that leads out of flat skin counts
/// as a shorter one.
fn distances_from_flat(
    (mesh, rest): (&TriMesh, &[Vector3<f64>]),
    demands: &[VertexDemand],
    is_flat: &[bool],
) -> Vec<f64> {
    let mut starts = vec![f64::INFINITY; is_flat.len()];
    for (_, edge) in mesh.edges().iter() {
        let [a, b] = edge.vertices.map(|v| v.index());
        if is_flat[a] != is_flat[b] {
            let outer = if is_flat[a] { b } else { a };
            let length = (rest[b] - rest[a]).norm();
            starts[outer] = starts[outer].min(length.min(LONG * demands[outer].wavelength));
        }
    }
    let sources = starts
        .iter()
        .enumerate()
        .filter(|(_, start)| start.is_finite());
    let sources = sources.map(|(v, start)| (VertexId::from_index(v), *start));
    let longest = demands.iter().map(|d| d.wavelength).fold(0.0, f64::max);
    let distances = edge_distances_with_starts(mesh, rest, sources, (FADE + ROUNDED) * longest);
    let places = distances.as_slice().iter().zip(demands).zip(is_flat);
    let distance = |((to, own), flat): ((&f64, &VertexDemand), &bool)| match flat {
        true => 0.0,
        false => to / own.wavelength,
    };
    places.map(distance).collect()
}

/// Means of distances from flat skin (wavelengths) over discs that hold none of it; beyond the fade they are others that
/// are beyond it.
fn rounded(
    (mesh, rest): (&TriMesh, &[Vector3<f64>]),
    demands: &[VertexDemand],
    distances: &[f64],
) -> Vec<f64> {
    let areas = vertex_areas(mesh, rest);
    let beyond = FADE + ROUNDED;
    let mean = |seen_from: &mut Vec<usize>, centre: usize| {
        let own = distances[centre];
        if own == 0.0 || own >= beyond {
            return own.min(beyond);
        }
        // A wider disc would let relief begin at a slope.
        let radius = own.min(ROUNDED) * demands[centre].wavelength;
        let (mut sum, mut weights) = (0.0, 0.0);
        any_in_disc((mesh, rest), (centre, radius), seen_from, |vertex| {
            // Nothing at the rim: a mean would jump where a vertex comes in.
            let away = (rest[vertex] - rest[centre]).norm() / radius;
            let weight = areas[vertex] * (1.0 - away * away);
            sum += weight * distances[vertex].min(beyond);
            weights += weight;
            false
        });
        // Collapsed triangles alone have no area.
        if weights > 0.0 { sum / weights } else { own }
    };
    at_all_vertices(demands.len(), mean)
}

/// Centres of discs of a `radius` beside the others: vertices that are so far `away` from them (both in wavelengths),
/// and places on edges between such and nearer vertices. Each is a vertex and the distance of the centre from it (m).
///
/// Smooth skin has edges as long as a disc is wide. From vertices alone such a disc would not reach back to the
/// others, and leave a seam of relief in quiet skin.
fn disc_centres(
    (mesh, rest): (&TriMesh, &[Vector3<f64>]),
    demands: &[VertexDemand],
    (away, radius): (&[f64], f64),
) -> Vec<(VertexId, f64)> {
    let mut centres = Vec::new();
    for (vertex, own) in away.iter().enumerate() {
        if *own > radius {
            centres.push((VertexId::from_index(vertex), 0.0));
        }
    }
    for (_, edge) in mesh.edges().iter() {
        let [a, b] = edge.vertices.map(|v| v.index());
        let (near, far) = if away[a] < away[b] { (a, b) } else { (b, a) };
        if away[near] > radius || away[far] <= radius {
            continue;
        }
        let length = (rest[far] - rest[near]).norm();
        // Beyond where distances were asked for they grow as they do straight away from the others.
        let rise = (away[far] - away[near]).min(length / demands[near].wavelength);
        let share = ((radius - away[near]) / rise).min(1.0);
        centres.push((VertexId::from_index(near), share * length));
    }
    centres
}

/// Vertices from which the normal turns, within the allowed radius, by more than it may.
fn sharply_bent(
    mesh: &TriMesh,
    (rest, normals): (&[Vector3<f64>], &[Vector3<f64>]),
    demands: &[VertexDemand],
) -> Vec<VertexId> {
    let is_bent = |seen_from: &mut Vec<usize>, centre: usize| {
        let demand = &demands[centre];
        let least_cosine = demand.turn.min(PI).cos();
        let radius = TURN_RADIUS * demand.wavelength;
        any_in_disc((mesh, rest), (centre, radius), seen_from, |vertex| {
            normals[vertex].dot(&normals[centre]) < least_cosine
        })
    };
    let states = at_all_vertices(demands.len(), is_bent);
    let centres = states.iter().enumerate().filter(|(_, bent)| **bent);
    centres
        .map(|(centre, _)| VertexId::from_index(centre))
        .collect()
}

/// Values of a function of a vertex that keeps marks for [`any_in_disc`].
fn at_all_vertices<T: Send>(
    vertices: usize,
    value: impl Fn(&mut Vec<usize>, usize) -> T + Send + Sync,
) -> Vec<T> {
    let none_seen = || vec![usize::MAX; vertices];
    let centres = (0..vertices).into_par_iter();
    let values = centres
        .with_min_len(CENTRES_AT_ONCE)
        .map_init(none_seen, value);
    values.collect()
}

/// Whether something holds at a vertex of those that edges join to a centre within a radius (m), itself included; ends
/// at the first. `seen_from` has the centre from which every vertex was seen last.
fn any_in_disc(
    (mesh, rest): (&TriMesh, &[Vector3<f64>]),
    (centre, radius): (usize, f64),
    seen_from: &mut [usize],
    mut holds: impl FnMut(usize) -> bool,
) -> bool {
    let mut near = vec![VertexId::from_index(centre)];
    seen_from[centre] = centre;
    while let Some(vertex) = near.pop() {
        if holds(vertex.index()) {
            return true;
        }
        let faces = mesh.vertex_faces(vertex).iter();
        for other in faces.flat_map(|&face| mesh.faces()[face]) {
            let i = other.index();
            if seen_from[i] != centre && (rest[i] - rest[centre]).norm() <= radius {
                seen_from[i] = centre;
                near.push(other);
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares 1 mm wide along x.
    fn strip() -> (TriMesh, Vec<Vector3<f64>>) {
        let squares = (0..100).map(|i| 2 * i);
        let faces = squares.flat_map(|a| [[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
        let mesh = TriMesh::new(202, faces.collect()).expect("a strip");
        let place = |i: usize| Vector3::new((i / 2) as f64, (i % 2) as f64, 0.0) * 1e-3;
        (mesh, (0..202).map(place).collect())
    }

    /// Shares along the lower side of a strip on which waves are 10 mm long.
    fn shares(ratio_at: impl Fn(f64) -> f64, turned_at: impl Fn(f64) -> f64) -> Vec<f64> {
        let (mesh, rest) = strip();
        let demand = |p: &Vector3<f64>| VertexDemand {
            strain_ratio: ratio_at(p.x),
            wavelength: 0.01,
            turn: 1.0,
        };
        let normal = |p: &Vector3<f64>| {
            let angle = turned_at(p.x);
            Vector3::new(angle.sin(), 0.0, angle.cos())
        };
        let demands: Vec<_> = rest.iter().map(demand).collect();
        let normals: Vec<_> = rest.iter().map(normal).collect();
        let shares = wrinkled_shares(&mesh, (&rest, &normals), &demands, &[false; 202]);
        shares.into_iter().step_by(2).collect()
    }

    /// Shares at all vertices of a flat strip with these places, under a ratio by the place along it.
    fn shares_on(
        (mesh, rest): (&TriMesh, &[Vector3<f64>]),
        wavelength: f64,
        ratio_at: impl Fn(f64) -> f64,
    ) -> Vec<f64> {
        let demand = |p: &Vector3<f64>| VertexDemand {
            strain_ratio: ratio_at(p.x),
            wavelength,
            turn: 1.0,
        };
        let demands: Vec<_> = rest.iter().map(demand).collect();
        let normals = vec![Vector3::z(); rest.len()];
        wrinkled_shares(mesh, (rest, &normals), &demands, &vec![false; rest.len()])
    }

    fn on_flat(ratio_at: impl Fn(f64) -> f64) -> Vec<f64> {
        shares(ratio_at, |_| 0.0)
    }

    #[test]
    fn relief_fades_over_half_a_wavelength_from_quiet_skin() {
        let found = on_flat(|x| if x < 0.0505 { 0.4 } else { 1.2 });
        assert!(found[..=50].iter().all(|share| *share == 0.0), "{found:?}");
        assert!(found[50..56].is_sorted(), "{found:?}");
        assert!(found[51] > 0.0 && found[54] < 1.0, "{found:?}");
        assert!(found[56..].iter().all(|share| *share == 1.0), "{found:?}");
    }

    /// Smooth skin beside wrinkled one on a mesh whose edges are longer there than the smallest patch of it is wide.
    #[test]
    fn long_edges_of_quiet_skin_hide_no_relief() {
        let (mesh, mut rest) = strip();
        let stretched = |x: f64| {
            if x < 0.0515 {
                x
            } else {
                0.051 + 3.5 * (x - 0.051)
            }
        };
        for place in &mut rest {
            place.x = stretched(place.x);
        }
        let ratio = |x: f64| if x < 0.0505 { 1.2 } else { 0.4 };
        let shares = shares_on((&mesh, &rest), 0.01, ratio);
        let quiet = shares.iter().zip(&rest).filter(|(_, p)| p.x > 0.0505);
        assert!(quiet.clone().all(|(share, _)| *share == 0.0), "{shares:?}");
        assert_eq!(shares[0], 1.0);
    }

    /// Edges a third of a wavelength long: the first face of other skin shows a quarter of the relief at its far side,
    /// not three quarters.
    #[test]
    fn relief_begins_later_along_long_edges() {
        let (mesh, mut rest) = strip();
        for place in &mut rest {
            place.x *= 10.0 / 3.0;
        }
        let ratio = |x: f64| if x < 0.15 { 0.4 } else { 1.2 };
        let shares = shares_on((&mesh, &rest), 0.01, ratio);
        let along: Vec<_> = rest.iter().zip(&shares).step_by(2).collect();
        let first = along.iter().position(|(_, share)| **share > 0.0);
        let first = first.expect("relief");
        assert!((along[first].0.x - 0.15).abs() < 0.0035, "{along:?}");
        assert!((0.1..0.35).contains(along[first].1), "{along:?}");
        assert_eq!(*along[first + 2].1, 1.0, "{along:?}");
    }

    #[test]
    fn all_quiet_is_flat_and_all_loud_is_whole() {
        assert!(on_flat(|_| 0.4).iter().all(|share| *share == 0.0));
        assert!(on_flat(|_| 0.6).iter().all(|share| *share == 1.0));
        // Stretched skin has a negative ratio.
        assert!(on_flat(|_| -3.0).iter().all(|share| *share == 0.0));
    }

    #[test]
    fn less_than_a_wave_is_neither_a_hole_nor_an_island() {
        let patch = |half: f64, [inside, outside]: [f64; 2]| {
            on_flat(move |x| [outside, inside][usize::from((x - 0.05).abs() < half)])
        };
        assert!(patch(0.0007, [0.0, 1.0]).iter().all(|share| *share == 1.0));
        assert!(patch(0.0062, [0.0, 1.0])[50] == 0.0);
        assert!(patch(0.0017, [1.0, 0.0]).iter().all(|share| *share == 0.0));
        assert!(patch(0.0062, [1.0, 0.0])[50] > 0.9);
    }

    /// Wrinkled skin between borders three quarters of a wavelength apart: distances from them have a ridge halfway.
    #[test]
    fn relief_between_two_borders_has_no_ridge() {
        let (mesh, rest) = strip();
        let ratio = |x: f64| f64::from((x - 0.05).abs() < 0.0152);
        let found = shares_on((&mesh, &rest), 0.04, ratio);
        let found: Vec<f64> = found.into_iter().step_by(2).collect();
        assert!(found[50] > 0.7, "{found:?}");
        // The fade itself bends by 6/20² at most where it begins, a ridge of straight distances by 0.1.
        let bends = found
            .windows(3)
            .map(|at| (at[0] - 2.0 * at[1] + at[2]).abs());
        assert!(bends.fold(0.0, f64::max) < 0.025, "{found:?}");
        assert!(found[..=34].iter().all(|share| *share == 0.0), "{found:?}");
    }

    /// A bend by a right angle over a length that is short, or long, beside a wavelength.
    #[test]
    fn sharp_bends_stay_as_they_are() {
        let bend = |length: f64| {
            let turned = move |x: f64| 0.5 * PI * ((x - 0.05) / length).clamp(0.0, 1.0);
            shares(|_| 1.5, turned)
        };
        let sharp = bend(0.002);
        assert!(sharp[51] == 0.0, "{sharp:?}");
        assert!(sharp[40] == 1.0 && sharp[62] == 1.0, "{sharp:?}");
        assert!(bend(0.02).iter().all(|share| *share == 1.0));
    }
}
