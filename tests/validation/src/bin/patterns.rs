//! Labyrinths, herringbone and pulled sheet at length: prints what was measured, panics where it is
//! not what was found before. Takes many minutes: `cargo xtask validate patterns`.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what this is for"
)]

#[path = "../../tests/pattern_checks/mod.rs"]
mod pattern_checks;

use pattern_checks::*;
use ruga_validation::FlatFilm;
use ruga_validation::reference::{Carrier, PatchRows};

fn main() {
    equal_compression_makes_labyrinths_unless_rows_hold_the_slides();
    a_larger_labyrinth_of_the_plate_is_one_of_the_shell();
    a_hybrid_film_does_not_keep_the_labyrinth_of_the_plate();
    herringbone_of_eight_waves_is_the_plates();
    a_pulled_sheet_keeps_to_its_power_over_a_range();
}

/// Three patches of 64 square waves, against sixteen of the plate: with rows on the heights alone
/// they are labyrinths, with rows on the slides as well, today, they are not.
fn equal_compression_makes_labyrinths_unless_rows_hold_the_slides() {
    let size = Size {
        waves: 8,
        points: 10,
    };
    let [free, plates] = labyrinths(PatchRows::Heights, size, 3, 16);
    let [held, _] = labyrinths(PatchRows::All, size, 3, 0);
    let [free, held] = [free, held].map(|shells| check_labyrinths(&shells, &plates));
    println!("crossing {free:.2} with rows on the heights, {held:.2} with rows on all");
    assert!(free < 0.3);
    assert!(held > 1.5 * free);
}

fn a_larger_labyrinth_of_the_plate_is_one_of_the_shell() {
    let size = Size {
        waves: 8,
        points: 12,
    };
    check_given_labyrinth(size, 0.02);
}

/// Today's wrong result: rows on the slides turn the plate's labyrinth into a herringbone.
fn a_hybrid_film_does_not_keep_the_labyrinth_of_the_plate() {
    let size = Size {
        waves: 6,
        points: 8,
    };
    let [given, found] = given_labyrinth(PatchRows::All, size, 2);
    assert!(found.orientation.distance(&given.orientation) > 0.15);
    assert!(found.orientation.crossing() > 0.5);
}

/// Eight waves at 12 points, against the plate on springs; the plate on the half-space itself is
/// printed beside it.
fn herringbone_of_eight_waves_is_the_plates() {
    let spec = FlatFilm::new(MODULUS_RATIO);
    let size = Size {
        waves: 8,
        points: 12,
    };
    let plate = plate_path(&spec, Carrier::Pasternak, size, &HERRINGBONE, 1);
    plate_path(&spec, Carrier::HalfSpace, size, &HERRINGBONE, 1);
    let shell = shell_path(&spec, PatchRows::All, size, &HERRINGBONE, 1);
    check_herringbone(&shell, &plate, [0.03, 0.03]);
}

/// The same at twice the resolution, over three octaves of pull.
fn a_pulled_sheet_keeps_to_its_power_over_a_range() {
    check_stretched(4000.0, 128, &[0.005, 0.01, 0.02, 0.04], [0.01, 0.02]);
}
