//! A film on a half-space against the exact continuum: onset, wavelength, amplitude, energy. On other
//! meshes, from cold starts and on curved bases: `cargo xtask validate tests`.

use ruga_validation::{Anchor, SOFTER, STIFFER, check_film};

fn check(anchor: Anchor) {
    let waves = check_film(anchor, None);
    assert!((waves - 8.0).abs() < 0.1, "{waves} waves");
}

#[test]
fn hybrid_equilateral_150() {
    check(SOFTER);
}

#[test]
fn hybrid_equilateral_1000() {
    check(STIFFER);
}
