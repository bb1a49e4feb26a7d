//! Padding: the nearest covered texel, exactly; unit normals; neutral beyond.

mod patch;

use nalgebra::Vector2;
use patch::{Driver, Patch, waves};
use proptest::prelude::*;
use ruga_bake::{BakeSettings, Coverage, WrinkleMap, bake};

/// A wrinkled patch shrunk and turned inside the tile, so that it leaves room around it.
fn island(size: u32, padding: u32, turn: f64) -> WrinkleMap {
    let mut patch = Patch::new(Driver::Flat, [48, 1], 0.0, waves);
    let rotation = nalgebra::Rotation2::new(turn);
    let center = Vector2::repeat(0.5);
    for uv in patch.uvs.iter_mut().flatten() {
        *uv = center + rotation * (*uv - center) * 0.4;
    }
    let settings = BakeSettings {
        size,
        padding,
        ..BakeSettings::default()
    };
    bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch")
}

/// Squared distance to the nearest covered texel by brute force.
fn nearest_squared(map: &WrinkleMap, texel: usize) -> usize {
    let size = map.size as usize;
    (0..map.coverage.len())
        .filter(|&other| map.coverage[other] == Coverage::Covered)
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
    fn every_texel_within_reach_is_a_copy_of_a_nearest_covered_one(
        size in 20_u32..60,
        padding in 0_u32..30,
        turn in 0.0..6.3,
    ) {
        let map = island(size, padding, turn);
        let side = size as usize;
        for texel in 0..map.coverage.len() {
            if map.coverage[texel] == Coverage::Covered {
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
                map.coverage[other] == Coverage::Covered
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
    let [plain, padded] = [0, 16].map(|padding| island(128, padding, 0.3));
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
    let map = island(64, u32::MAX, 0.3);
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
            padding: 4,
            supersample,
            ..BakeSettings::default()
        };
        let map = bake(&patch.relief(), &patch.frames, &settings).unwrap();
        for texel in 0..map.coverage.len() {
            if map.coverage[texel] != Coverage::Neutral {
                assert!((patch::baked(&map, texel) - expected).norm() < 1e-6);
            }
        }
    }
}
