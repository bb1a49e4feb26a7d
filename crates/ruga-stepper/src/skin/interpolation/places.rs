//! Places on one mesh of the skin at which the vertices of another lie.

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{FaceId, Id, MaterialPoint, PerVertex, SparseRows, SurfaceLookup, TriMesh};

use super::line_shift::LineShift;
use super::parts::{FACES_AT_A_TIME, LimitPart, for_each_part};
use super::{PLACES_AT_A_TIME, through_vertices};
use crate::skin::mirror::Mirrored;
use crate::skin::skin_mesh::SkinMesh;

/// Corrections of places towards those of the limit surface; the first takes most of the way.
const PLACING_STEPS: usize = 2;

/// Rings of faces around a part of the mesh up to which places may leave it; steps are some hundredths of an edge long.
const RINGS: usize = 2;

/// Distance of the limit surface from where it is wanted, in the shortest edge there, from which on a place is
/// corrected.
const NEAR: f64 = 1e-3;

/// Parts of a region whose first place is looked for on all faces of the layer; for more a tree is built.
const FEW_PARTS: usize = 8;

/// Places that a thread looks for at least.
const PLACES_AT_ONCE: usize = 64;

/// The place of `layer` under every vertex of `region`, both at rest; on the layer with its mirror image, where it is
/// given.
///
/// Found from neighbour to neighbour along the region, so that parts that touch are not confused, and on the
/// same side of creases; `None` as soon as `goes_on` says no.
pub(crate) fn places_on(
    layer: &SkinMesh,
    mirrored: Option<&Mirrored>,
    region: &SkinMesh,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<MaterialPoint>> {
    let lookup = match mirrored {
        None => SurfaceLookup::new(&layer.mesh, &layer.rest.positions),
        Some(mirrored) => SurfaceLookup::new(&mirrored.mesh, &mirrored.positions),
    };
    let mesh = &region.mesh;
    let LineShift { shifts, on_line } = LineShift::new(layer, region);
    let positions = region.rest.positions.iter().zip(&shifts);
    let targets: PerVertex<Vector3<f64>> = positions.map(|(x, shift)| x + shift).collect();
    let mut places: PerVertex<Option<MaterialPoint>> = PerVertex::filled(mesh.vertex_count(), None);
    let mut is_reached = PerVertex::filled(mesh.vertex_count(), false);
    let (mut parts, mut visited) = (0, 0);
    for seed in places.ids().collect::<Vec<_>>() {
        if std::mem::replace(&mut is_reached[seed], true) {
            continue;
        }
        let found = match parts < FEW_PARTS {
            true => lookup.closest_of_all(&targets[seed]),
            false => lookup.closest(&targets[seed]),
        };
        places[seed] = found.map(|found| found.point);
        parts += 1;
        let mut reached = vec![seed];
        // Ring by ring, each by all threads. Which neighbour a vertex is looked for from follows from the mesh alone.
        while !reached.is_empty() {
            visited += reached.len();
            if visited >= PLACES_AT_A_TIME {
                visited = 0;
                if !goes_on() {
                    return None;
                }
            }
            let mut ring = Vec::new();
            for (from, near) in reached.iter().filter_map(|&v| Some((v, places[v]?))) {
                for to in mesh
                    .vertex_faces(from)
                    .iter()
                    .flat_map(|&f| mesh.faces()[f])
                {
                    if !std::mem::replace(&mut is_reached[to], true) {
                        ring.push((near.face, [from, to]));
                    }
                }
            }
            let looked_for = ring.par_iter().with_min_len(PLACES_AT_ONCE);
            let found = looked_for
                .map(|&(start, ends)| place_near(&lookup, start, ends.map(|v| targets[v])));
            let found: Vec<_> = found.collect();
            reached = ring.into_iter().map(|(_, [_, to])| to).collect();
            for (&vertex, place) in reached.iter().zip(found) {
                places[vertex] = place;
            }
        }
    }
    // Rounding alone would decide on which side of the line they are.
    for (v, place) in on_line {
        places[v] = Some(place);
    }
    let anywhere = MaterialPoint::at_corner(FaceId(0), 0);
    let found = places.into_vec().into_iter();
    Some(found.map(|place| place.unwrap_or(anywhere)).collect())
}

fn place_near(
    lookup: &SurfaceLookup<'_>,
    start: FaceId,
    [from, to]: [Vector3<f64>; 2],
) -> Option<MaterialPoint> {
    // The reach is twice the edge: on another mesh, whose facets cut corners elsewhere, two
    // neighbours' places may be farther apart than they are.
    let reach = 2.0 * (to - from).norm();
    lookup
        .closest_near(start, &to, reach)
        .or_else(|| lookup.closest(&to))
        .map(|found| found.point)
}

/// The places at which the limit surface through a mesh at rest passes `wanted` positions closely, from those at which
/// its faces do: up to [`NEAR`], as far as [`PLACING_STEPS`] corrections lead. Those that are `held` stay. `None` as
/// soon as `goes_on` says no.
///
/// Where edges differ in length the limit surface lies beside the place of the faces that it belongs to, by some
/// hundredths of an edge. Read there, the flank of a wrinkle would be as rough as edges are irregular.
pub(crate) fn places_of_limit(
    on: (&TriMesh, &[Vector3<f64>], &SparseRows),
    places: Vec<MaterialPoint>,
    wanted: (&[Vector3<f64>], &[bool]),
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<MaterialPoint>> {
    placed_in_parts(on, places, wanted, FACES_AT_A_TIME, goes_on)
}

/// Does what [`places_of_limit`] does, for `most` faces at a time.
fn placed_in_parts(
    (mesh, rest, at_vertices): (&TriMesh, &[Vector3<f64>], &SparseRows),
    mut places: Vec<MaterialPoint>,
    (wanted, held): (&[Vector3<f64>], &[bool]),
    most: usize,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<MaterialPoint>> {
    let control = through_vertices(at_vertices, rest);
    let lookup = SurfaceLookup::new(mesh, rest);
    let start = places.clone();
    let of_part = |part: &LimitPart, own: &[u32]| {
        let control = part.control(&control);
        let free = own.iter().map(|&i| i as usize).filter(|&i| !held[i]);
        let trial = |vertex: usize| Trial {
            vertex,
            place: start[vertex],
            before: f64::INFINITY,
        };
        let mut trials: Vec<Trial> = free.map(trial).collect();
        let mut better = Vec::new();
        for step in 0..=PLACING_STEPS {
            let on_part = |trial: &Trial| part.place(&trial.place).expect("a place of the part");
            let tried: Vec<_> = trials.iter().map(on_part).collect();
            let [reached] = part.surface.positions(&tried, [&control]);
            let found = trials.into_par_iter().zip(reached);
            let found = found.with_min_len(PLACES_AT_ONCE).map(|(trial, reached)| {
                let (way, place) = (wanted[trial.vertex] - reached, trial.place);
                let distance = way.norm();
                let is_near = distance <= NEAR * shortest_edge(mesh, rest, place.face);
                // Around vertices with many edges a step may lead away.
                let is_better = distance < trial.before;
                let next = (is_better && !is_near && step < PLACING_STEPS).then(|| {
                    let target = place.interpolate(mesh, rest) + way;
                    lookup.closest_near(place.face, &target, 2.0 * distance)
                });
                let next = next.flatten().map(|next| next.point);
                let next = next.filter(|next| part.place(next).is_some());
                let next = next.map(|place| Trial {
                    place,
                    before: distance,
                    ..trial
                });
                (is_better.then_some((trial.vertex, place)), next)
            });
            let mut following = Vec::new();
            for (found, next) in found.collect::<Vec<_>>() {
                better.extend(found);
                following.extend(next);
            }
            trials = following;
        }
        better
    };
    let mut goes_on_still = true;
    for_each_part(mesh, &start, (most, RINGS), of_part, |_, better| {
        for (vertex, place) in better {
            places[vertex] = place;
        }
        goes_on_still = goes_on();
        goes_on_still
    });
    goes_on_still.then_some(places)
}

/// A place that is tried for a vertex.
struct Trial {
    vertex: usize,
    place: MaterialPoint,
    /// Distance of the limit surface from where it is wanted (m), at the place before.
    before: f64,
}

fn shortest_edge(mesh: &TriMesh, rest: &[Vector3<f64>], face: FaceId) -> f64 {
    let [a, b, c] = mesh.faces()[face].map(|v| rest[v.index()]);
    let edges = [b - a, c - b, a - c].map(|edge| edge.norm());
    edges.into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use ruga_mesh::limit_rows;

    use super::*;
    use crate::skin::interpolation::no_corners;
    use crate::test_drivers::{skin, square};

    /// Places on every part of a wavy mesh, many of which leave the part that they begin in.
    #[test]
    fn places_cross_parts_as_they_do_in_the_whole() {
        let bumps = |p: nalgebra::Vector2<f64>| {
            Vector3::new(p.x, p.y, 2e-3 * (400.0 * p.x).sin() * (300.0 * p.y).cos())
        };
        let driver = square(&bumps, &bumps);
        let [mesh, fine] = [1, 2].map(|levels| skin(&driver, levels, 0.0));
        let rows = limit_rows(&mesh.mesh, &no_corners(&mesh.mesh)).position;
        let rest = mesh.rest.positions.as_slice();
        let start = places_on(&mesh, None, &fine, &mut || true).expect("nothing ends it");
        let held = vec![false; start.len()];
        let wanted = (fine.rest.positions.as_slice(), held.as_slice());
        let placed = |most: usize| {
            let on = (&mesh.mesh, rest, &rows);
            placed_in_parts(on, start.clone(), wanted, most, &mut || true).expect("nothing ends it")
        };
        let whole = placed(mesh.mesh.face_count());
        let moved = whole.iter().zip(&start);
        let moved = moved.filter(|(new, old)| new.face != old.face).count();
        assert!(moved > start.len() / 50, "{moved} of {}", start.len());
        assert!(placed(50) == whole);
        let on = (&mesh.mesh, rest, &rows);
        assert!(placed_in_parts(on, start, wanted, 50, &mut || false).is_none());
    }
}
