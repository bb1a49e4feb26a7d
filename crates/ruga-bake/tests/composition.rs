//! Maps of several layers: what lies on top covers, what lies side by side adds.

mod patch;

use nalgebra::Vector3;
use patch::{Driver, Patch, SIDE, baked, degrees, largest_tilt, waves};
use ruga_bake::{BakeError, BakeSettings, Coverage, WrinkleMap, bake};

fn map(height: impl Fn(f64, f64) -> f64, faces: std::ops::Range<usize>, size: u32) -> WrinkleMap {
    let mut patch = Patch::new(Driver::Flat, [96, 1], 0.0, height);
    patch.faces = patch.faces[faces.clone()].to_vec();
    patch.uvs = patch.uvs[faces.clone()].to_vec();
    patch.artist = patch.artist[faces].to_vec();
    let settings = BakeSettings {
        size,
        ..BakeSettings::default()
    };
    bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch")
}

const FACES: usize = 2 * 96 * 96;

/// 0 on the left, 1 on the right, smooth between.
fn ramp(s: f64) -> f64 {
    let t = ((s / SIDE - 0.3) / 0.4).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[test]
fn reliefs_that_fade_into_each_other_add_to_the_whole() {
    let whole = map(waves, 0..FACES, 128);
    let mut sum = map(|s, t| waves(s, t) * ramp(s), 0..FACES, 128);
    let rest = map(|s, t| waves(s, t) * (1.0 - ramp(s)), 0..FACES, 128);
    sum.add(&rest).unwrap();
    for texel in 0..whole.heights.len() {
        assert!((sum.heights[texel] - whole.heights[texel]).abs() < 1e-9);
        let angle = degrees(&baked(&sum, texel), &baked(&whole, texel));
        // Each relief is fitted for itself on the mesh, and fits of slopes up to 25 degrees are not
        // quite linear: 0.22 degrees at most here.
        assert!(angle < 0.5, "{angle} degrees at texel {texel}");
        assert!((baked(&sum, texel).norm() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn slopes_add_exactly() {
    let mut sum = map(|s, _| 0.3 * s, 0..FACES, 16);
    sum.add(&map(|s, t| 0.5 * t - 0.1 * s, 0..FACES, 16))
        .unwrap();
    let expected = Vector3::new(-0.2, -0.5, 1.0).normalize();
    for texel in 0..sum.normals.len() {
        assert!((baked(&sum, texel) - expected).norm() < 1e-6);
    }
}

#[test]
fn what_nothing_covers_changes_nothing() {
    let left = map(waves, 0..FACES / 2, 64);
    let right = map(waves, FACES / 2..FACES, 64);
    let whole = map(waves, 0..FACES, 64);
    let [mut a, mut b] = [left.clone(), right.clone()];
    a.add(&right).unwrap();
    b.add(&left).unwrap();
    assert_eq!(a, b);
    assert!(a.coverage.iter().all(|&c| c == Coverage::Covered));
    let kept = (0..a.normals.len()).filter(|&texel| left.coverage[texel] == Coverage::Covered);
    for texel in kept {
        assert_eq!(a.normals[texel], left.normals[texel]);
        assert_eq!(a.heights[texel], left.heights[texel]);
    }
    assert_eq!(a.coverage, whole.coverage);
}

#[test]
fn the_steepest_slopes_stay_finite_and_upright() {
    let mut map = map(|s, _| s, 0..FACES, 8);
    for normal in &mut map.normals {
        *normal = [0.9998, 0.0, 0.02];
    }
    map.folded_samples = 3;
    map.skipped_faces = 1;
    let other = map.clone();
    map.add(&other).unwrap();
    assert!(map.normals.iter().flatten().all(|c| c.is_finite()));
    assert!(map.normals.iter().all(|n| n[2] > 0.0));
    assert_eq!([map.folded_samples, map.skipped_faces], [6, 2]);
}

#[test]
fn an_upper_layer_replaces_what_it_covers() {
    let mut lower = map(waves, 0..FACES, 64);
    let upper = map(|s, _| 0.1 * s, 0..FACES / 2, 64);
    let before = lower.clone();
    lower.cover_with(&upper).unwrap();
    for texel in 0..lower.normals.len() {
        let source = match upper.coverage[texel] {
            Coverage::Covered => &upper,
            _ => &before,
        };
        assert_eq!(lower.normals[texel], source.normals[texel]);
        assert_eq!(lower.heights[texel], source.heights[texel]);
    }
    assert!(largest_tilt(&lower) > largest_tilt(&upper));
}

#[test]
fn maps_of_other_sizes_are_refused() {
    let mut small = map(waves, 0..FACES, 16);
    let large = map(waves, 0..FACES, 32);
    let wrong = BakeError::LengthMismatch {
        array: "normals",
        found: 1024,
        expected: 256,
    };
    assert_eq!(small.add(&large), Err(wrong.clone()));
    assert_eq!(small.cover_with(&large), Err(wrong));
}
