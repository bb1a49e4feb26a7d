//! A layer made of one simulated half and its mirror image.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_stepper::{ComputedMesh, LayerSurface};

use crate::Mirror;

/// Distance from the plane (m) up to which a vertex counts as on it; rounding leaves some 1e-17.
const EXACT: f64 = 1e-9;

/// Distance from the plane within which vertices move with it, in the largest distance that a vertex on it is put
/// right by: triangles are then strained by about a tenth.
const REACH: f64 = 15.0;

/// A layer and its mirror image in one, joined where the `half` ends at the plane `x = 0`.
pub(crate) fn both_halves(mirror: &Mirror, half: &LayerSurface) -> LayerSurface {
    let half = &in_plane(half);
    let image = mirror.image(half);
    let count = half.positions.len();
    let is_on_plane = |v: usize| half.on_plane.get(v).copied().unwrap_or(false);
    // Images of the vertices on the plane are these themselves.
    let mut next = count as u32;
    let number = |v: usize| match is_on_plane(v) {
        true => v as u32,
        false => {
            next += 1;
            next - 1
        }
    };
    let numbers: Vec<u32> = (0..count).map(number).collect();
    let joined = |own: &[Vector3<f64>], other: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
        let other = other.iter().enumerate().filter(|(v, _)| !is_on_plane(*v));
        own.iter().chain(other.map(|(_, x)| x)).copied().collect()
    };
    let faces = image
        .faces
        .iter()
        .map(|face| face.map(|v| numbers[v as usize]));
    let faces = half.faces.iter().copied().chain(faces);
    let uvs = half.uvs.iter().chain(image.uvs.iter());
    let artist = half.artist.iter().chain(image.artist.iter());
    LayerSurface {
        name: half.name.clone(),
        positions: joined(&half.positions, &image.positions),
        relief: joined(&half.relief, &image.relief),
        driver_positions: joined(&half.driver_positions, &image.driver_positions),
        driver_normals: joined(&half.driver_normals, &image.driver_normals),
        offset: half.offset,
        faces: faces.collect(),
        uvs: uvs.copied().collect(),
        artist: artist.copied().collect(),
        on_plane: Arc::default(),
        face_states: half.face_states.as_ref().map(|states| states.repeat(2)),
        computed: ComputedMesh::default(),
        burnt: None,
    }
}

/// The half with the vertices on the plane put there exactly, and those around them moved as much less as they are
/// farther away: where edges of the artist's mesh lean to one side, its smooth surface ends a little beside the plane.
fn in_plane(half: &LayerSurface) -> LayerSurface {
    let mut moved = half.clone();
    let on_plane: Vec<usize> = (0..half.on_plane.len())
        .filter(|&v| half.on_plane[v])
        .collect();
    let places = &half.driver_positions;
    let farthest = on_plane
        .iter()
        .fold(0.0, |most: f64, &v| most.max(places[v].x.abs()));
    if farthest > EXACT {
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
            let left = match half.on_plane[v] {
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
        normal.x = 0.0;
        *normal = normal.try_normalize(0.0).unwrap_or(half.driver_normals[v]);
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
        let found = in_plane(&half);
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
