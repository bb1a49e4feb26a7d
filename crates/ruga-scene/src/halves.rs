//! A layer made of one simulated half and its mirror image.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_stepper::{ComputedMesh, LayerSurface};

use crate::Mirror;
use crate::mirror::{flipped, reflected};

/// Distance from the plane (m) up to which a vertex counts as on it; rounding leaves some 1e-17.
const EXACT: f64 = 1e-9;

/// Distance from the plane within which vertices move with it, in the largest distance that a vertex on it is put
/// right by: triangles are then strained by about a tenth.
const REACH: f64 = 15.0;

/// A layer and its mirror image in one, joined where the `half` ends at the plane `x = 0`.
pub(crate) fn both_halves(mirror: &Mirror, half: LayerSurface) -> LayerSurface {
    let mut both = in_plane(half);
    // It shows one side alone, and sheets that burn are simulated whole.
    (both.computed, both.burnt) = (ComputedMesh::default(), None);
    let count = both.positions.len();
    let is_on_plane = |v: usize| both.on_plane.get(v).copied().unwrap_or(false);
    let beside: Vec<usize> = (0..count).filter(|&v| !is_on_plane(v)).collect();
    // Images of the vertices on the plane are these themselves.
    let mut numbers: Vec<u32> = (0..count as u32).collect();
    for (number, &v) in (count as u32..).zip(&beside) {
        numbers[v] = number;
    }
    let faces = both.faces.iter().map(|&face| flipped(face));
    let faces = faces.map(|face| face.map(|v| numbers[v as usize]));
    both.faces = both.faces.iter().copied().chain(faces).collect();
    let uvs = both.artist.iter().map(|face| mirror.opposite_uvs(face));
    both.uvs = both.uvs.iter().copied().chain(uvs).collect();
    let artist = both.artist.iter().map(|face| mirror.opposite_place(face));
    both.artist = both.artist.iter().copied().chain(artist).collect();
    both.on_plane = Arc::default();
    let points = [
        &mut both.positions,
        &mut both.relief,
        &mut both.driver_positions,
        &mut both.driver_normals,
    ];
    for points in points {
        points.reserve_exact(beside.len());
        for &v in &beside {
            points.push(reflected(&points[v]));
        }
    }
    if let Some(states) = &mut both.face_states {
        states.extend_from_within(..);
    }
    both
}

/// The half with the vertices on the plane put there exactly, and those around them moved as much less as they are
/// farther away: where edges of the artist's mesh lean to one side, its smooth surface ends a little beside the plane.
fn in_plane(half: LayerSurface) -> LayerSurface {
    let mut moved = half;
    let on_plane: Vec<usize> = (0..moved.on_plane.len())
        .filter(|&v| moved.on_plane[v])
        .collect();
    let farthest = on_plane.iter().fold(0.0, |most: f64, &v| {
        most.max(moved.driver_positions[v].x.abs())
    });
    if farthest > EXACT {
        let places = moved.driver_positions.clone();
        let reach = REACH * farthest;
        let cell = |x: &Vector3<f64>| [x.y, x.z].map(|c| (c / reach).floor() as i64);
        let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
        for &v in &on_plane {
            cells.entry(cell(&places[v])).or_default().push(v);
        }
        let nearest = |x: &Vector3<f64>| {
            let [y, z] = cell(x);
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dz| [y + dy, z + dz]));
            let found = around.filter_map(|at| cells.get(&at)).flatten();
            let distance = |v: usize| (places[v].yz() - x.yz()).norm_squared();
            found
                .copied()
                .min_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)))
        };
        for (v, x) in places.iter().enumerate().filter(|(_, x)| x.x < reach) {
            let Some(on) = nearest(x) else { continue };
            let left = match moved.on_plane[v] {
                true => 1.0,
                false => (1.0 - (x - places[on]).norm() / reach).max(0.0),
            };
            let way = left * places[on].x;
            for x in at_vertex(&mut moved, v) {
                x.x -= way;
            }
        }
    }
    for v in on_plane {
        for x in at_vertex(&mut moved, v) {
            x.x = 0.0;
        }
        let normal = &mut moved.driver_normals[v];
        let flat = Vector3::new(0.0, normal.y, normal.z);
        *normal = flat.try_normalize(0.0).unwrap_or(*normal);
    }
    moved
}

/// The places of a vertex: computed, as maps show it, and on the driver.
fn at_vertex(surface: &mut LayerSurface, vertex: usize) -> [&mut Vector3<f64>; 3] {
    [
        &mut surface.positions[vertex],
        &mut surface.relief[vertex],
        &mut surface.driver_positions[vertex],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip beside the plane, whose vertices on it are to the right of it in one place.
    #[test]
    fn what_ends_beside_the_plane_is_drawn_onto_it() {
        let place = |i: usize| {
            let [x, y] = [i % 21, i / 21].map(|k| k as f64);
            let beside = 0.5 * (-0.05 * (y - 20.0).powi(2)).exp();
            Vector3::new(x + beside * (1.0 - x / 21.0), y, 0.0)
        };
        let places: Vec<_> = (0..21 * 41).map(place).collect();
        let half = LayerSurface {
            positions: places.iter().map(|x| x + Vector3::z()).collect(),
            relief: places.clone(),
            driver_normals: vec![Vector3::new(0.1, 0.0, 1.0).normalize(); places.len()],
            on_plane: (0..places.len()).map(|i| i % 21 == 0).collect(),
            driver_positions: places.clone(),
            ..LayerSurface::default()
        };
        let found = in_plane(half);
        for (i, (x, before)) in found.driver_positions.iter().zip(&places).enumerate() {
            if i % 21 == 0 {
                assert_eq!((x.x, found.driver_normals[i].x), (0.0, 0.0));
            } else {
                // Neighbours keep their distance.
                let [new, old] =
                    [&found.driver_positions, &places].map(|all| all[i].x - all[i - 1].x);
                assert!((new / old - 1.0).abs() < 0.12, "{i}: {new} for {old}");
            }
            assert_eq!(found.positions[i] - x, Vector3::z());
            assert_eq!(x.yz(), before.yz());
        }
    }
}
