//! Packing: poses that overlap are kept apart, and every pose comes back.

use proptest::prelude::*;
use ruga_bake::{KeyStrength, POSES_PER_MASK, PoseRegion, mask_image, pack, share_maps, unpack};

const SIZE: usize = 32;
const NEUTRAL: [f32; 3] = [32768.0 / 65535.0, 32768.0 / 65535.0, 1.0];

/// A pose whose map is not neutral in a square.
fn pose([column, row, side]: [usize; 3]) -> Vec<f32> {
    let texel = |texel: usize| {
        let (x, y) = (texel % SIZE, texel / SIZE);
        let is_inside = (column..column + side).contains(&x) && (row..row + side).contains(&y);
        match is_inside {
            true => [0.3 + 0.01 * (x % 7) as f32, 0.7, 0.9],
            false => NEUTRAL,
        }
    };
    (0..SIZE * SIZE).flat_map(texel).collect()
}

fn region(values: &[f32]) -> PoseRegion {
    let mut region = PoseRegion::new(SIZE as u32);
    region.add(values, &NEUTRAL, 0.5);
    region.with_margin()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn every_pose_comes_back_within_a_step(
        squares in prop::collection::vec([0..28_usize, 0..28_usize, 1..5_usize], 1..12)
    ) {
        let poses: Vec<_> = squares.into_iter().map(pose).collect();
        let regions: Vec<_> = poses.iter().map(|values| vec![region(values)]).collect();
        let map_of = share_maps(&regions, poses.len()).expect("a map for each");
        for map in 0..poses.len() {
            let members: Vec<_> = (0..poses.len()).filter(|&p| map_of[p] == map).collect();
            let mut packed = NEUTRAL.repeat(SIZE * SIZE);
            for &member in &members {
                pack(&mut packed, &poses[member], 3, &regions[member][0]);
            }
            for four in members.chunks(POSES_PER_MASK) {
                let images: Vec<_> = four.iter().map(|&member| &regions[member][0]).collect();
                let mask = mask_image(&images, SIZE as u32);
                for (channel, &member) in four.iter().enumerate() {
                    let channel = mask.iter().skip(channel).step_by(POSES_PER_MASK).copied();
                    let found = unpack(&packed, &NEUTRAL, channel);
                    for (found, own) in found.iter().zip(&poses[member]) {
                        prop_assert!((found - own).abs() < 1.0 / 255.0, "{found} {own}");
                    }
                }
            }
        }
    }
}

#[test]
fn poses_that_are_apart_share_a_map() {
    let poses = [[0, 0, 8], [20, 0, 8], [4, 4, 20]].map(pose);
    let regions: Vec<_> = poses.iter().map(|values| vec![region(values)]).collect();
    let map_of = share_maps(&regions, 2).expect("two are enough");
    assert_eq!(map_of[0], map_of[1]);
    assert_ne!(map_of[0], map_of[2]);
}

#[test]
fn poses_in_different_tiles_share_a_map() {
    let empty = || PoseRegion::new(SIZE as u32);
    let square = || region(&pose([4, 4, 8]));
    let regions = [
        vec![square(), empty()],
        vec![empty(), square()],
        vec![empty(), square()],
    ];
    let map_of = share_maps(&regions, 2).expect("two are enough");
    assert_ne!(map_of[1], map_of[2]);
    assert!(map_of[0] == map_of[1] || map_of[0] == map_of[2]);
}

#[test]
fn too_few_maps_names_the_poses_that_overlap() {
    let poses = [[0, 0, 8], [4, 4, 8], [6, 6, 8], [25, 25, 4]].map(pose);
    let regions: Vec<_> = poses.iter().map(|values| vec![region(values)]).collect();
    let error = share_maps(&regions, 2).expect_err("three overlap");
    assert_eq!((error.maps, error.needed), (2, 3));
    assert_eq!(error.poses, [0, 1, 2]);
    assert!(share_maps(&[], 1).expect("nothing").is_empty());
}

#[test]
fn what_rounds_to_neutral_is_no_region() {
    let mut values = NEUTRAL.repeat(SIZE * SIZE);
    values[3 * 100] += 0.4 / 255.0;
    let mut region = PoseRegion::new(SIZE as u32);
    region.add(&values, &NEUTRAL, 0.5);
    assert!(!(0..SIZE * SIZE).any(|texel| region.contains(texel)));
    values[3 * 100] += 0.2 / 255.0;
    region.add(&values, &NEUTRAL, 0.5);
    assert!(region.contains(100));
    // Its margin is clipped at the border of the image and nowhere else.
    let grown = region.with_margin();
    let count = (0..SIZE * SIZE).filter(|&texel| grown.contains(texel));
    assert_eq!(count.count(), 25);
}

#[test]
fn a_key_half_as_strong_has_half_the_strength() {
    let whole = pose([4, 4, 20]);
    let neutral = NEUTRAL.iter().cycle();
    let pairs = whole.iter().zip(neutral);
    let half: Vec<f32> = pairs.map(|(v, n)| n + 0.5 * (v - n)).collect();
    let mut strength = KeyStrength::default();
    strength.add(&whole, &half, &NEUTRAL);
    assert!((strength.value() - 0.5).abs() < 1e-6);
    let none = NEUTRAL.repeat(SIZE * SIZE);
    let mut strength = KeyStrength::default();
    strength.add(&none, &whole, &NEUTRAL);
    assert_eq!(strength.value(), 0.0);
}
