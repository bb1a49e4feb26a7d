//! Every sample belongs to exactly one of the triangles around it.

mod patch;

use nalgebra::{Vector2, Vector3};
use patch::{grid_faces, scatter};
use proptest::prelude::*;
use ruga_bake::{BakeSettings, Coverage, Relief, TangentFrame, WrinkleMap, bake};

/// Bakes some flat faces with the given UVs.
fn cover(uvs: &[[Vector2<f64>; 3]], size: u32) -> WrinkleMap {
    let vertices = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    let normals = [Vector3::z(); 3];
    let frame = TangentFrame {
        normal: Vector3::z(),
        tangent: Vector3::x(),
        sign: 1.0,
    };
    let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let relief = Relief {
        positions: &vertices,
        driver_positions: &vertices,
        driver_normals: &normals,
        offset: 0.0,
        faces: &vec![[0, 1, 2]; uvs.len()],
        uvs,
        artist: &vec![(0, corners); uvs.len()],
    };
    let settings = BakeSettings {
        size,
        ..BakeSettings::default()
    };
    bake(&relief, &[[frame; 3]], &settings).expect("a valid patch")
}

fn covered(map: &WrinkleMap) -> usize {
    let is_covered = |c: &&Coverage| **c == Coverage::Covered;
    map.coverage.iter().filter(is_covered).count()
}

/// A triangulation of the unit square: a grid whose inner vertices are moved, and moved to places
/// exactly on texel centres (`snap`), some faces mirrored by their vertex order. No face turns over:
/// three vertices that move by less than a quarter of a cell, half a texel to a centre included,
/// cannot pass each other.
fn triangulation(cells: usize, seed: usize, snap: Option<f64>) -> Vec<[Vector2<f64>; 3]> {
    let most = if snap.is_some() { 0.1 } else { 0.24 };
    let place = |vertex: usize| {
        let [column, row] = [vertex % (cells + 1), vertex / (cells + 1)];
        let inner = |i: usize| i > 0 && i < cells;
        let [x, y] = [(column, 2 * vertex), (row, 2 * vertex + 1)].map(|(index, which)| {
            let moved = if inner(column) && inner(row) {
                most * scatter(seed + which)
            } else {
                0.0
            };
            (index as f64 + moved) / cells as f64
        });
        match snap {
            Some(size) if inner(column) && inner(row) => {
                Vector2::new((x * size).floor() + 0.5, (y * size).floor() + 0.5) / size
            }
            _ => Vector2::new(x, y),
        }
    };
    grid_faces(cells)
        .into_iter()
        .enumerate()
        .map(|(face, [a, b, c])| {
            let corners = if face % 3 == 0 { [a, c, b] } else { [b, c, a] };
            corners.map(|v| place(v as usize))
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn every_texel_of_a_triangulation_is_covered_exactly_once(
        cells in 1_usize..7,
        seed in 0_usize..1_000_000,
        size in 1_u32..40,
        snap in any::<bool>(),
    ) {
        // In smaller cells half a texel is too far.
        let snap = (snap && size as usize >= 4 * cells).then_some(f64::from(size));
        let faces = triangulation(cells, seed, snap);
        let alone: usize = faces.iter().map(|face| covered(&cover(&[*face], size))).sum();
        let texels = (size * size) as usize;
        prop_assert_eq!(covered(&cover(&faces, size)), texels);
        prop_assert_eq!(alone, texels);
    }

    #[test]
    fn coverage_follows_the_sides_of_the_centre(
        corners in prop::array::uniform6(-0.5..1.5_f64),
        size in 1_u32..40,
    ) {
        let [a, b, c] = [0, 2, 4].map(|i| Vector2::new(corners[i], corners[i + 1]));
        let map = cover(&[[a, b, c]], size);
        let sign = (b - a).perp(&(c - a)).signum();
        for texel in 0..map.coverage.len() {
            let at = [texel % size as usize, texel / size as usize];
            let p = Vector2::from(at.map(|i| (i as f64 + 0.5) / f64::from(size)));
            let depth = [[a, b], [b, c], [c, a]]
                .iter()
                .map(|[s, e]| sign * (e - s).perp(&(p - s)))
                .fold(f64::INFINITY, f64::min);
            // Near an edge the rounding to the grid of 2^-27 decides.
            if depth.abs() > 1e-7 {
                prop_assert_eq!(map.coverage[texel] == Coverage::Covered, depth > 0.0);
            }
        }
    }
}

#[test]
fn texels_on_a_common_diagonal_belong_to_one_face() {
    // The diagonal of the tile passes through the centre of every texel on it.
    let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from);
    for size in [1, 2, 7, 64] {
        let halves = [[a, b, c], [a, c, d]];
        let [lower, upper] = halves.map(|half| covered(&cover(&[half], size)));
        assert_eq!(lower + upper, (size * size) as usize);
        assert_eq!(covered(&cover(&halves, size)), (size * size) as usize);
    }
}

#[test]
fn what_lies_outside_the_tile_is_cut_off_not_wrapped() {
    let shifted = [[1.25, 0.0], [2.0, 0.0], [2.0, 1.0]].map(Vector2::from);
    assert_eq!(covered(&cover(&[shifted], 32)), 0);
    let large = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(Vector2::from);
    assert_eq!(covered(&cover(&[large], 32)), 32 * 32);
}

#[test]
fn degenerate_and_endless_faces_are_skipped_and_counted() {
    let line = [[0.1, 0.1], [0.5, 0.5], [0.9, 0.9]].map(Vector2::from);
    let point = [[0.3, 0.3]; 3].map(Vector2::from);
    let endless = [[0.0, 0.0], [1e300, 0.0], [0.0, 1.0]].map(Vector2::from);
    let far = [[1e300, 0.0], [1e300, 1.0], [2e300, 1.0]].map(Vector2::from);
    let map = cover(&[line, point, endless, far], 16);
    assert_eq!(map.skipped_faces, 3);
    assert_eq!(covered(&map), 0);
}
