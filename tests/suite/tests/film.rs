//! A film on a half-space against the exact continuum: onset, wavelength, amplitude. On other meshes, on
//! cylinders and held by rows alone: `cargo xtask validate tests`.

use ruga_validation::{SOFTER, STIFFER, check_film};

#[test]
fn film_150_times_as_stiff_as_its_base() {
    check_film(SOFTER, None);
}

#[test]
fn film_1000_times_as_stiff_as_its_base() {
    check_film(STIFFER, None);
}
