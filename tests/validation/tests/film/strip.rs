//! Films on unstructured meshes against the exact continuum.

use ruga_validation::{Anchor, SOFTER, STIFFER, check_film};

/// Checks a film on three meshes: seven and a half waves are chosen now and then, but not mostly.
fn check_unstructured(anchor: Anchor) {
    let mut waves = [7, 8, 9].map(|seed| check_film(anchor, Some(seed)));
    waves.sort_by(f64::total_cmp);
    assert!((waves[1] - 8.0).abs() < 0.1, "{waves:?} waves");
}

#[test]
fn hybrid_unstructured_150() {
    check_unstructured(SOFTER);
}

#[test]
fn hybrid_unstructured_1000() {
    check_unstructured(STIFFER);
}
