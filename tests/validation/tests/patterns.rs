//! Labyrinth, herringbone and pulled sheet against their references.
//!
//! Larger patches, finer meshes and more seeds: `cargo xtask validate patterns`.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

mod pattern_checks;

use std::sync::Arc;

use pattern_checks::*;
use ruga_material::WavelengthModel;
use ruga_stepper::{LayerSpec, Modelling, PoseSpec, Region, Silent, plan};
use ruga_validation::reference::{Carrier, PatchRows, shrinking_square};
use ruga_validation::{FlatFilm, findings, skin_layer};

/// With the hybrid coupling wave number, amplitude and energy are the plate's, but two directions
/// prevail (a crossing of 0.4 to 0.8, against 0.05 to 0.3): rows on the slides hold the film where
/// the domains of a labyrinth make it slide, over two to four waves.
#[test]
fn equal_compression_of_a_hybrid_film_has_the_wave_of_the_plate() {
    let size = Size {
        waves: 6,
        points: 8,
    };
    let [shells, plates] = labyrinths(PatchRows::All, size, 1, 6);
    check_labyrinths(&shells, &plates);
}

#[test]
fn a_labyrinth_of_the_plate_is_one_of_the_shell() {
    let size = Size {
        waves: 6,
        points: 8,
    };
    check_given_labyrinth(size, 0.03);
}

/// The same through planner, blend shape, load path and adaptive mesh, on a square whose border is
/// pinned: what an artist gets.
#[test]
fn a_blend_shape_that_shrinks_a_square_makes_a_labyrinth() {
    let spec = FlatFilm::new(MODULUS_RATIO);
    let film = spec.theory();
    let side = 6.0 * film.wavelength;
    let strain = 2.0 * film.critical_strain / (1.0 + spec.layer.material.poisson);
    let driver = shrinking_square(side, strain);
    let layers = [LayerSpec {
        material: spec.layer.material,
        substrate: spec.layer.substrate,
        model: WavelengthModel::HalfSpace,
        ..skin_layer("film", "forehead-furrow")
    }];
    let poses = [PoseSpec {
        name: "shrink".to_owned(),
        weights: driver.weights([("shrink", 1.0)]).expect("its only shape"),
        keys: vec![1.0],
        steps: 4,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }];
    let modelling = Modelling {
        points_per_wavelength: 10.0,
        region: Region::All,
        ..Modelling::default()
    };
    let plan = plan(&Arc::new(driver), &layers, &poses, &modelling, 256).expect("a plan");
    let result = plan.simulate(0, &mut Silent).expect("a film");
    println!("{}", findings(&result.layers[0]));
    assert!(result.converged, "{:?}", result.warnings);
    // The border is left out by a wave.
    let inner = (0.5 * side - film.wavelength) * (1.0 - strain);
    let [wave_number, alignment] = measured(&result.keys[0].layers[0], inner, 1.0 - strain);
    let size = Size {
        waves: 6,
        points: 8,
    };
    let path = [[strain / film.critical_strain; 2]];
    let plates: Vec<_> = (1..=4)
        .flat_map(|seed| plate_path(&spec, Carrier::Pasternak, size, &path, seed))
        .collect();
    let wanted = mean(&plates, |f| f.slope_wave);
    println!(
        "wave number {:.4}, plate {wanted:.4}; alignment {alignment:.3}",
        wave_number / film.wave_number
    );
    assert_near("wave number", wave_number / film.wave_number, wanted, 0.05);
    assert!(alignment < 0.25, "{alignment}");
}

#[test]
fn compression_across_straight_wrinkles_makes_a_herringbone() {
    let spec = FlatFilm::new(MODULUS_RATIO);
    let size = Size {
        waves: 6,
        points: 8,
    };
    let shell = shell_path(&spec, PatchRows::All, size, &HERRINGBONE, 1);
    let plate = plate_path(&spec, Carrier::Pasternak, size, &HERRINGBONE, 1);
    check_herringbone(&shell, &plate, [0.05, 0.05]);
}

#[test]
fn a_pulled_sheet_wrinkles_with_the_power_of_a_quarter() {
    check_stretched(4000.0, 64, &[0.005, 0.01], [0.015, 0.03]);
}
