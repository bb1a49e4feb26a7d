//! Padding: outside the islands the nearest texel of one, exactly; bare skin stays neutral.

mod patch;

use nalgebra::Vector2;
use patch::{Driver, Patch, waves};
use proptest::prelude::*;
use ruga_bake::{BakeError, BakeSettings, Coverage, WrinkleMap, bake};

/// Faces of the patch.
const FACES: usize = 2 * 48 * 48;

/// A wrinkled patch shrunk and turned inside the tile, so that it leaves room around it.
fn shrunk(turn: f64) -> Patch {
    let mut patch = Patch::new(Driver::Flat, [48, 1], 0.0, waves);
    let rotation = nalgebra::Rotation2::new(turn);
    let center = Vector2::repeat(0.5);
    for uv in patch.uvs.iter_mut().flatten() {
        *uv = center + rotation * (*uv - center) * 0.4;
    }
    patch
}

/// The map of such a patch of which only the first `baked` faces were simulated.
fn island(size: u32, padding: u32, turn: f64, baked: usize) -> WrinkleMap {
    let whole = shrunk(turn);
    let mut part = shrunk(turn);
    part.faces.truncate(baked);
    part.uvs.truncate(baked);
    part.artist.truncate(baked);
    let settings = BakeSettings {
        size,
        ..BakeSettings::default()
    };
    let mut map = bake(&part.relief(), &part.frames, &settings).expect("a valid patch");
    map.pad(&whole.uvs, padding).expect("finite UVs");
    map
}

fn is_inside(coverage: Coverage) -> bool {
    matches!(coverage, Coverage::Covered | Coverage::Skin)
}

/// Squared distance to the nearest texel of an island by brute force.
fn nearest_squared(map: &WrinkleMap, texel: usize) -> usize {
    let size = map.size as usize;
    (0..map.coverage.len())
        .filter(|&other| is_inside(map.coverage[other]))
        .map(|other| {
            let across = (other % size).abs_diff(texel % size);
            let down = (other / size).abs_diff(texel / size);
            across * across + down * down
        })
        .min()
        .expect("an island")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn every_texel_within_reach_is_a_copy_of_a_nearest_one_inside(
        size in 20_u32..60,
        padding in 0_u32..30,
        turn in 0.0..6.3,
        baked in 1000..=FACES,
    ) {
        let map = island(size, padding, turn, baked);
        let side = size as usize;
        for texel in 0..map.coverage.len() {
            if map.coverage[texel] == Coverage::Covered {
                continue;
            }
            if map.coverage[texel] == Coverage::Skin {
                prop_assert_eq!(map.normals[texel], [0.0, 0.0, 1.0]);
                prop_assert_eq!(map.heights[texel], 0.0);
                continue;
            }
            let squared = nearest_squared(&map, texel);
            if squared > (padding * padding) as usize {
                prop_assert_eq!(map.coverage[texel], Coverage::Neutral);
                prop_assert_eq!(map.normals[texel], [0.0, 0.0, 1.0]);
                prop_assert_eq!(map.heights[texel], 0.0);
                continue;
            }
            prop_assert_eq!(map.coverage[texel], Coverage::Padded);
            let copied = (0..map.coverage.len()).any(|other| {
                let across = (other % side).abs_diff(texel % side);
                let down = (other / side).abs_diff(texel / side);
                is_inside(map.coverage[other])
                    && across * across + down * down == squared
                    && map.normals[other] == map.normals[texel]
                    && map.heights[other] == map.heights[texel]
            });
            prop_assert!(copied, "texel {} is no copy", texel);
        }
    }
}

#[test]
fn padding_does_not_change_what_is_covered() {
    let [plain, padded] = [0, 16].map(|padding| island(128, padding, 0.3, FACES));
    for texel in 0..plain.coverage.len() {
        if plain.coverage[texel] == Coverage::Covered {
            assert_eq!(padded.coverage[texel], Coverage::Covered);
            assert_eq!(padded.normals[texel], plain.normals[texel]);
        }
    }
    assert!(!plain.coverage.contains(&Coverage::Padded));
    assert!(padded.coverage.contains(&Coverage::Padded));
    assert!(padded.coverage.contains(&Coverage::Neutral));
}

#[test]
fn padding_larger_than_the_map_fills_it() {
    let map = island(64, u32::MAX, 0.3, FACES);
    assert!(!map.coverage.contains(&Coverage::Neutral));
    for [x, y, z] in map.normals {
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-6);
    }
}

/// A texel that is only partly covered holds the mean over its covered samples: no mixing with the
/// neutral surroundings.
#[test]
fn supersampling_never_averages_with_the_background() {
    let slope = |s: f64, _: f64| 0.3 * s;
    let mut patch = Patch::new(Driver::Flat, [16, 1], 0.0, slope);
    for uv in patch.uvs.iter_mut().flatten() {
        *uv = Vector2::repeat(0.2037) + 0.5 * *uv;
    }
    let expected = nalgebra::Vector3::new(-0.3, 0.0, 1.0).normalize();
    for supersample in [1, 2, 4] {
        let settings = BakeSettings {
            size: 64,
            supersample,
            ..BakeSettings::default()
        };
        let mut map = bake(&patch.relief(), &patch.frames, &settings).unwrap();
        map.pad(&patch.uvs, 4).unwrap();
        for texel in 0..map.coverage.len() {
            if map.coverage[texel] != Coverage::Neutral {
                assert!((patch::baked(&map, texel) - expected).norm() < 1e-6);
            }
        }
    }
}

/// Where the simulated region ends inside an island there is skin, not room for padding.
#[test]
fn skin_that_was_not_simulated_stays_neutral() {
    let map = island(128, 16, 0.3, FACES / 2);
    let plain = island(128, 0, 0.3, FACES / 2);
    let whole = island(128, 16, 0.3, FACES);
    let [mut skin, mut between] = [0, 0];
    for texel in 0..map.coverage.len() {
        match whole.coverage[texel] {
            Coverage::Covered if map.coverage[texel] == Coverage::Covered => {
                assert_eq!(map.normals[texel], plain.normals[texel]);
            }
            Coverage::Covered if map.coverage[texel] == Coverage::Padded => between += 1,
            Coverage::Covered => {
                assert_eq!(map.coverage[texel], Coverage::Skin);
                assert_eq!(map.normals[texel], [0.0, 0.0, 1.0]);
                skin += 1;
            }
            _ => assert!(!is_inside(map.coverage[texel])),
        }
    }
    assert!(skin > 1000, "{skin}");
    // Where the simulated region's border meets that of the island, at two places.
    assert!(between <= 6, "{between}");
}

/// The border of an island through texel centers, with the layer's rounded vertices on the middle of
/// the artist's edges: no neutral speck.
#[test]
fn a_layer_that_covers_its_island_leaves_no_skin() {
    let size = 256;
    let center = |[column, row]: [i32; 2]| {
        Vector2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / f64::from(size)
    };
    // Edges along rows, columns and diagonals, and through every third and seventh center.
    for [right, down] in [[0, 0], [60, 60], [60, 20], [21, -3], [-49, 7]] {
        let corners = [
            [60, 60],
            [180, 60 + right],
            [180 + down, 180 + right],
            [60 + down, 180],
        ];
        let [a, b, c, d] = corners.map(center);
        let mut patch = Patch::new(Driver::Flat, [47, 1], 0.0, waves);
        for uv in patch.uvs.iter_mut().flatten() {
            let [s, t] = [uv.x, 1.0 - uv.y];
            // Linear on both triangles of the quad.
            *uv = match t <= s {
                true => a + (b - a) * s + (c - b) * t,
                false => a + (c - d) * s + (d - a) * t,
            };
        }
        let settings = BakeSettings {
            size: size as u32,
            ..BakeSettings::default()
        };
        let mut map = bake(&patch.relief(), &patch.frames, &settings).unwrap();
        map.pad(&[[a, b, c], [a, c, d]], 2).unwrap();
        let specks = map
            .coverage
            .iter()
            .filter(|&&c| c == Coverage::Skin)
            .count();
        assert_eq!(specks, 0, "{corners:?}");
        let covered = map
            .coverage
            .iter()
            .filter(|&&c| c == Coverage::Covered)
            .count();
        assert!(covered > 10_000, "{covered}");
    }
}

#[test]
fn islands_that_are_not_numbers_are_refused() {
    let mut map = island(32, 0, 0.0, FACES);
    let wrong = [[Vector2::zeros(); 3], [Vector2::repeat(f64::NAN); 3]];
    assert_eq!(
        map.pad(&wrong, 4),
        Err(BakeError::NotFinite {
            array: "islands",
            index: 1
        })
    );
}

#[test]
fn padding_is_the_same_on_any_number_of_threads() {
    let maps = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| island(200, 9, 0.7, FACES / 3))
    });
    assert_eq!(maps[0], maps[1]);
}

/// An island in a corner, and a padding that is wider than the map.
#[test]
fn a_wide_padding_reaches_the_opposite_corner() {
    let side = 32_usize;
    let mut map = WrinkleMap {
        size: side as u32,
        square: [0, 0],
        normals: vec![[0.0, 0.0, 1.0]; side * side],
        heights: vec![0.0; side * side],
        coverage: vec![Coverage::Neutral; side * side],
        details: Vec::new(),
        skipped_faces: 0,
        folded_samples: 0,
    };
    map.coverage[0] = Coverage::Covered;
    map.heights[0] = 1e-3;
    map.pad(&[], 100).unwrap();
    assert!(map.heights.iter().all(|&height| height == 1e-3));
}
