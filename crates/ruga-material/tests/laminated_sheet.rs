//! Sheets of bonded plies: the even layer that stands for them, and their natural shape as tensors.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use nalgebra::{Matrix2, Rotation2};
use ruga_material::{Laminate, LaminatedSheet, MaterialError, Ply, SheetPly};

const POISSON: f64 = 0.3;

/// Young's modulus (Pa), thickness (m) and density (kg/m³) of three unlike plies.
const PLIES: [[f64; 3]; 3] = [[3e9, 1e-5, 800.0], [7e8, 3e-5, 1500.0], [1e8, 2e-5, 300.0]];

fn plies(numbers: &[[f64; 3]]) -> Vec<SheetPly> {
    let ply = |[young, thickness, density]: &[f64; 3]| SheetPly {
        young: *young,
        thickness: *thickness,
        density: *density,
    };
    numbers.iter().map(ply).collect()
}

fn sheet(numbers: &[[f64; 3]]) -> LaminatedSheet {
    LaminatedSheet::new(&plies(numbers), POISSON).unwrap()
}

/// The laminate of these plies with plane-stress moduli and these strains.
fn laminate(numbers: &[[f64; 3]], strains: &[f64]) -> Laminate {
    let plies = numbers
        .iter()
        .zip(strains)
        .map(|([young, thickness, _], strain)| Ply {
            modulus: young / (1.0 - POISSON * POISSON),
            natural_strain: *strain,
            thickness: *thickness,
        });
    Laminate::new(&plies.collect::<Vec<_>>()).unwrap()
}

fn close(found: f64, expected: f64) {
    let error = found / expected - 1.0;
    assert!(error.abs() < 1e-12, "{found} {expected}: {error:e}");
}

#[test]
fn the_even_layer_is_as_stiff_and_heavy_as_the_plies() {
    let sheet = sheet(&PLIES);
    let expected = laminate(&PLIES, &[0.0; 3]);
    let material = sheet.material();
    close(material.membrane_stiffness(), expected.stretching_stiffness);
    close(material.bending_stiffness(), expected.bending_stiffness);
    let mass = 800.0 * 1e-5 + 1500.0 * 3e-5 + 300.0 * 2e-5;
    close(material.density * material.thickness, mass);
    close(sheet.thickness(), 6e-5);
    assert_eq!((sheet.ply_count(), material.poisson), (3, POISSON));
}

#[test]
fn equal_plies_are_one() {
    let two = sheet(&[[3e9, 4e-5, 800.0], [3e9, 6e-5, 800.0]]);
    let material = two.material();
    close(material.young, 3e9);
    close(material.thickness, 1e-4);
    close(material.density, 800.0);
}

/// Along the axes of the stretches every component is a laminate of its own, with strains over the mean length.
#[test]
fn components_are_laminates_of_their_own() {
    let lengths = [[1.02, 0.97], [1.0, 0.9], [0.95, 1.1]];
    let turn = Rotation2::new(0.7);
    let turned = |[along, across]: [f64; 2]| {
        turn.matrix() * Matrix2::new(along, 0.0, 0.0, across) * turn.matrix().transpose()
    };
    let shape = sheet(&PLIES).natural_shape(&lengths.map(turned)).unwrap();
    let expected = [0, 1].map(|axis| {
        let strains = lengths.map(|length| length[axis] - 1.0);
        let mean = 1.0 + laminate(&PLIES, &strains).natural_strain;
        let left = lengths.map(|length| length[axis] / mean - 1.0);
        let left = laminate(&PLIES, &left);
        assert!(left.natural_strain.abs() < 1e-15);
        (mean, left.natural_curvature)
    });
    let stretch = turned(expected.map(|(stretch, _)| stretch));
    let curvature = turned(expected.map(|(_, curvature)| curvature));
    assert!((shape.stretch - stretch).amax() < 1e-14);
    assert!((shape.curvature - curvature).amax() < 1e-11 * curvature.amax());
    assert_eq!(shape.curvature.m12, shape.curvature.m21);
}

/// Small growths in different directions add up; larger ones have the Green strains of their metrics in the
/// stretched sheet, but for terms of second order in the difference between plies.
#[test]
fn growths_in_different_directions_add_up() {
    let two = [PLIES[0], PLIES[1]];
    let grown = |angle: f64, amount: f64| {
        let turn = Rotation2::new(angle);
        let along = turn.matrix() * Matrix2::new(amount, 0.0, 0.0, 0.0) * turn.matrix().transpose();
        Matrix2::identity() + along
    };
    let curvature = |lower: Matrix2<f64>, upper: Matrix2<f64>| {
        let shape = sheet(&two).natural_shape(&[lower, upper]).unwrap();
        shape.curvature
    };
    let one = Matrix2::identity();
    let [lower, upper] = [grown(0.4, 1e-6), grown(-0.9, 1e-6)];
    let sum = curvature(lower, one) + curvature(one, upper);
    let both = curvature(lower, upper);
    assert!((both - sum).amax() < 1e-5 * sum.amax(), "{both} {sum}");

    // A mean stretch of unequal lengths, and plies that differ from it about other axes.
    let mean = Matrix2::new(1.3, 0.1, 0.1, 0.7);
    let apart = Matrix2::new(1e-4, 2e-4, 2e-4, -3e-4);
    let [lower, upper] = [mean - apart, mean + apart];
    let shape = sheet(&two).natural_shape(&[lower, upper]).unwrap();
    let inverse = shape.stretch.try_inverse().unwrap();
    let strains = [lower, upper].map(|l| 0.5 * (inverse * l * l * inverse - one));
    let component = |pick: fn(&Matrix2<f64>) -> f64| {
        let strains: Vec<f64> = strains.iter().map(pick).collect();
        laminate(&two, &strains).natural_curvature
    };
    let expected = Matrix2::new(
        component(|g| g.m11),
        component(|g| g.m12),
        component(|g| g.m21),
        component(|g| g.m22),
    );
    let error = (shape.curvature - expected).amax() / expected.amax();
    assert!(error < 1e-3, "{error:e}");
}

#[test]
fn plies_that_grow_alike_bend_nothing() {
    let one = Matrix2::new(1.2, 0.1, 0.1, 0.8);
    let shape = sheet(&PLIES).natural_shape(&[one; 3]).unwrap();
    assert!((shape.stretch - one).amax() < 1e-15);
    assert!(shape.curvature.amax() * 6e-5 < 1e-14, "{}", shape.curvature);
}

#[test]
fn what_is_no_sheet_is_refused() {
    let made = |numbers: &[[f64; 3]], poisson: f64| {
        let made = LaminatedSheet::new(&plies(numbers), poisson);
        made.expect_err("no sheet")
    };
    assert_eq!(made(&[], POISSON), MaterialError::NoPlies);
    for (at, parameter) in [
        (0, "ply modulus (Pa)"),
        (1, "ply thickness (m)"),
        (2, "ply density (kg/m³)"),
    ] {
        for value in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            let mut numbers = PLIES;
            numbers[1][at] = value;
            let text = made(&numbers, POISSON).to_string();
            assert!(text.contains(parameter), "{text}");
        }
    }
    assert!(matches!(
        made(&PLIES, 0.5),
        MaterialError::PoissonOutOfRange { .. }
    ));
    assert!(matches!(
        made(&[[1e300, 1e300, 1.0]; 2], POISSON),
        MaterialError::Overflow { .. }
    ));
    let one = Matrix2::identity();
    let shape = |stretches: &[Matrix2<f64>]| sheet(&PLIES).natural_shape(stretches).unwrap_err();
    assert_eq!(
        shape(&[one; 2]),
        MaterialError::StretchCount { plies: 3, found: 2 }
    );
    for stretch in [Matrix2::zeros(), Matrix2::new(1.0, 0.0, 0.0, -1.0)] {
        assert!(matches!(
            shape(&[stretch; 3]),
            MaterialError::OutOfRange { .. }
        ));
    }
}
