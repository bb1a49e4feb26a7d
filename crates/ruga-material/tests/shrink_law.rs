//! Rest shape and stiffness that follow the fuel left in a sheet.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use nalgebra::{Matrix2, Vector2};
use ruga_material::{FreshSheet, Laminate, MaterialError, Ply, ShrinkLaw};

const LAW: ShrinkLaw = ShrinkLaw {
    along: 0.25,
    across: 0.4,
    asymmetry: 0.3,
    char_young: 0.1,
    char_thickness: 0.8,
};

const PAPER: FreshSheet = FreshSheet {
    young: 3e9,
    thickness: 1e-4,
};

#[test]
fn a_fresh_sheet_is_as_it_was_and_a_burnt_one_is_char() {
    let fresh = LAW.shrunk(&PAPER, 1.0).unwrap();
    assert_eq!((fresh.lengths, fresh.curvatures), ([1.0; 2], [0.0; 2]));
    assert_eq!((fresh.young, fresh.thickness), (3e9, 1e-4));
    let char = LAW.shrunk(&PAPER, 0.0).unwrap();
    assert!((char.young / 3e8 - 1.0).abs() < 1e-14);
    assert!((char.thickness / 8e-5 - 1.0).abs() < 1e-14);
    assert!((char.lengths[0] - 0.75).abs() < 1e-15);
    assert!((char.lengths[1] - 0.6).abs() < 1e-15);
    let half = LAW.shrunk(&PAPER, 0.5).unwrap();
    assert!((half.young / 1.65e9 - 1.0).abs() < 1e-14);
    assert!((half.lengths[1] - 0.8).abs() < 1e-15);
}

/// At its natural curvature every fibre between the faces has its own length: `lambda (1 + k z)`.
#[test]
fn a_shrunk_strip_is_free_of_stress_at_its_curvature() {
    for fuel in [0.0, 0.3, 0.99] {
        let sheet = LAW.shrunk(&PAPER, fuel).unwrap();
        for (axis, shrink) in [LAW.along, LAW.across].into_iter().enumerate() {
            for side in [1.0, -1.0] {
                let bent = sheet.curvatures[axis] * side * 0.5 * sheet.thickness;
                let found = sheet.lengths[axis] * (1.0 + bent);
                let own = 1.0 - shrink * (1.0 + side * 0.5 * LAW.asymmetry) * (1.0 - fuel);
                assert!((found - own).abs() < 1e-14, "{fuel} {axis} {side}");
            }
        }
    }
}

/// Many plies with lengths between those of the faces bend by the same curvature.
#[test]
fn the_curvature_is_that_of_the_plies() {
    let sheet = LAW.shrunk(&PAPER, 0.4).unwrap();
    let faces = [-0.5, 0.5].map(|side| 1.0 - LAW.along * (1.0 + side * LAW.asymmetry) * 0.6);
    let plies: Vec<_> = (0..200)
        .map(|i| {
            let length = faces[0] + (faces[1] - faces[0]) * (f64::from(i) + 0.5) / 200.0;
            Ply {
                modulus: sheet.young,
                natural_strain: length / sheet.lengths[0] - 1.0,
                thickness: sheet.thickness / 200.0,
            }
        })
        .collect();
    let found = Laminate::new(&plies).unwrap();
    assert!((found.natural_curvature / sheet.curvatures[0] - 1.0).abs() < 1e-4);
    assert!(found.natural_strain.abs() < 1e-12);
}

#[test]
fn tensors_turn_with_the_grain() {
    let sheet = LAW.shrunk(&PAPER, 0.2).unwrap();
    let [along, across] = sheet.lengths;
    let straight = sheet.stretch(Vector2::x());
    assert_eq!(straight, Matrix2::new(along, 0.0, 0.0, across));
    let grain = Vector2::new(0.6, 0.8);
    let aside = Vector2::new(-0.8, 0.6);
    for (tensor, values) in [
        (sheet.stretch(grain), sheet.lengths),
        (sheet.curvature(grain), sheet.curvatures),
    ] {
        assert!((tensor * grain - values[0] * grain).norm() < 1e-12 * values[0].abs());
        assert!((tensor * aside - values[1] * aside).norm() < 1e-12 * values[1].abs());
    }
}

#[test]
fn the_sheet_curls_towards_the_face_that_shrinks_more() {
    assert!(LAW.shrunk(&PAPER, 0.5).unwrap().curvatures[0] < 0.0);
    let turned = ShrinkLaw {
        asymmetry: -LAW.asymmetry,
        ..LAW
    };
    let [found, mirrored] = [LAW, turned].map(|law| law.shrunk(&PAPER, 0.5).unwrap().curvatures);
    assert_eq!(found, mirrored.map(|k| -k));
}

type Set = fn(&mut ShrinkLaw, f64);

#[test]
fn bad_laws_are_named() {
    let cases: [(Set, [f64; 3], &str); 5] = [
        (|law, v| law.along = v, [-0.01, 0.61, f64::NAN], "along"),
        (|law, v| law.across = v, [-0.01, 0.61, f64::NAN], "across"),
        (
            |law, v| law.asymmetry = v,
            [-2.1, 2.1, f64::NAN],
            "asymmetry",
        ),
        (
            |law, v| law.char_young = v,
            [0.0, f64::NAN, f64::INFINITY],
            "char Young",
        ),
        (
            |law, v| law.char_thickness = v,
            [0.0, f64::NAN, -1.0],
            "char thickness",
        ),
    ];
    for (set, values, name) in cases {
        for value in values {
            let mut law = LAW;
            set(&mut law, value);
            let message = law.shrunk(&PAPER, 0.5).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
            assert!(message.contains(&value.to_string()), "{message}");
        }
    }
    for fuel in [-0.1, 1.1, f64::NAN] {
        let error = LAW.shrunk(&PAPER, fuel).unwrap_err();
        assert!(matches!(error, MaterialError::OutOfRange { .. }), "{error}");
    }
    // Each in its range, and together more than there is.
    let law = ShrinkLaw {
        across: 0.6,
        asymmetry: 2.0,
        ..LAW
    };
    let error = law.validate().unwrap_err();
    assert!(error.to_string().contains("1.2"), "{error}");
}
