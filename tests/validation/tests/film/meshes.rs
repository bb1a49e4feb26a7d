//! Films on squares and on uneven meshes against the exact continuum.

use ruga_validation::{SOFTER, STIFFER, check_film};

#[test]
fn squares_150() {
    check_film(SOFTER, None);
}

#[test]
fn uneven_meshes_150() {
    for seed in [7, 8, 9] {
        check_film(SOFTER, Some(seed));
    }
}

#[test]
fn uneven_meshes_1000() {
    for seed in [7, 8, 9] {
        check_film(STIFFER, Some(seed));
    }
}
