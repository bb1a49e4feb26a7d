//! A film on a half-space against the exact continuum: onset, wavelength, amplitude. A softer film, other meshes,
//! cylinders, films held by rows alone, and films that grow: `cargo xtask validate tests`.

use ruga_validation::{STIFFER, check_film};

#[test]
fn film_1000_times_as_stiff_as_its_base() {
    check_film(STIFFER, None);
}
