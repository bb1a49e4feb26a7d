//! Normal maps between keys and over each other.

use ruga_bake::{KeyNormals, between_keys, lay_over};

const NEUTRAL: [f32; 3] = [0.0, 0.0, 1.0];

fn tilted(angle: f64) -> [f32; 3] {
    [angle.sin() as f32, 0.0, angle.cos() as f32]
}

fn assert_close(found: [f32; 3], wanted: [f32; 3]) {
    let apart = (0..3).map(|c| (found[c] - wanted[c]).abs());
    assert!(apart.fold(0.0, f32::max) < 1e-6, "{found:?} {wanted:?}");
}

#[test]
fn neutral_changes_nothing_and_tilts_add() {
    for (base, detail, sum) in [
        (0.0, 0.4, 0.4),
        (0.4, 0.0, 0.4),
        (0.3, 0.5, 0.8),
        (0.3, -0.3, 0.0),
    ] {
        let mut found = [tilted(base)];
        lay_over(&mut found, &[tilted(detail)]).expect("one texel each");
        assert_close(found[0], tilted(sum));
    }
}

#[test]
fn a_pose_goes_from_neutral_through_its_keys() {
    let [half, whole] = [[tilted(0.6)], [tilted(-0.6)]];
    let keys = [(0.5, &half), (1.0, &whole)].map(|(key, normals)| KeyNormals { key, normals });
    for (weight, angle) in [
        (0.0, 0.0),
        (0.25, 0.3),
        (0.5, 0.6),
        (0.75, 0.0),
        (1.0, -0.6),
        (1.5, -0.6),
    ] {
        assert_close(between_keys(&keys, weight)[0], tilted(angle));
    }
    assert_close(between_keys(&keys[1..], 0.0)[0], NEUTRAL);
    assert!(between_keys(&[], 0.5).is_empty());
}

#[test]
fn maps_of_two_sizes_are_an_error() {
    let error = lay_over(&mut [NEUTRAL], &[NEUTRAL; 2]).expect_err("two sizes");
    assert!(error.to_string().contains("detail"), "{error}");
}
