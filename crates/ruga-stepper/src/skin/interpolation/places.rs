//! Places on one mesh of the skin at which the vertices of another lie.

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{FaceId, MaterialPoint, PerVertex, SparseRows, SurfaceLookup, TriMesh};

use super::line_shift::LineShift;
use super::{FACES_AT_A_TIME, PLACES_AT_A_TIME, limit_in_parts, through_vertices};
use crate::skin::mirror::Mirrored;
use crate::skin::skin_mesh::SkinMesh;

/// Corrections of places towards those of the limit surface; the first takes most of the way.
const PLACING_STEPS: usize = 2;

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

/// The places at which the limit surface through a mesh at rest passes `wanted` positions most closely, from those at
/// which its faces do; those that are `held` stay. `None` as soon as `goes_on` says no.
///
/// Where edges differ in length the limit surface lies beside the place of the faces that it belongs to, by some
/// hundredths of an edge. Read there, the flank of a wrinkle would be as rough as edges are irregular.
pub(crate) fn places_of_limit(
    (mesh, rest, at_vertices): (&TriMesh, &[Vector3<f64>], &SparseRows),
    mut places: Vec<MaterialPoint>,
    (wanted, held): (&[Vector3<f64>], &[bool]),
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<MaterialPoint>> {
    let control = through_vertices(at_vertices, rest);
    let lookup = SurfaceLookup::new(mesh, rest);
    // The best places so far, and how far from the wanted ones the surface passes there.
    let mut best: Vec<(MaterialPoint, f64)> = places.iter().map(|p| (*p, f64::INFINITY)).collect();
    for step in 0..=PLACING_STEPS {
        if !goes_on() {
            return None;
        }
        let [reached] = limit_in_parts(mesh, &places, [&control], FACES_AT_A_TIME);
        let found = places.par_iter_mut().zip(&mut best);
        let found = found.zip(reached.par_iter().zip(wanted)).zip(held);
        found.with_min_len(PLACES_AT_ONCE).for_each(
            |(((place, best), (reached, wanted)), held)| {
                let way = wanted - reached;
                if way.norm() >= best.1 {
                    // Around vertices with many edges a step may lead away.
                    *place = best.0;
                    return;
                }
                *best = (*place, way.norm());
                if step < PLACING_STEPS && !held {
                    let target = place.interpolate(mesh, rest) + way;
                    let near = lookup.closest_near(place.face, &target, 2.0 * way.norm());
                    *place = near.map_or(*place, |near| near.point);
                }
            },
        );
    }
    Some(best.into_iter().map(|(place, _)| place).collect())
}
