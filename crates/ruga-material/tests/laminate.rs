//! Natural shape and stiffness of bonded plies against Timoshenko's formula and sums by hand.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use ruga_material::{Laminate, MaterialError, Ply, linear_profile_curvature};

fn ply(modulus: f64, natural_strain: f64, thickness: f64) -> Ply {
    Ply {
        modulus,
        natural_strain,
        thickness,
    }
}

/// Timoshenko 1925, eq. 4: `m` ratio of thickness and `n` of modulus, each lower over upper.
fn timoshenko(m: f64, n: f64, strain: f64, thickness: f64) -> f64 {
    let square = (1.0 + m) * (1.0 + m);
    6.0 * strain * square / (thickness * (3.0 * square + (1.0 + m * n) * (m * m + 1.0 / (m * n))))
}

#[test]
fn two_plies_are_timoshenkos_bimetal() {
    let (upper, strain, modulus) = (3e-5, 0.013, 2e9);
    for (m, n) in [(1.0, 1.0), (0.25, 4.0), (3.0, 0.1), (0.5, 20.0)] {
        let plies = [
            ply(n * modulus, -0.004, m * upper),
            ply(modulus, strain - 0.004, upper),
        ];
        let found = Laminate::new(&plies).unwrap();
        let expected = timoshenko(m, n, strain, (1.0 + m) * upper);
        let error = found.natural_curvature / expected - 1.0;
        assert!(error.abs() < 1e-12, "{m} {n}: {error:e}");
    }
}

#[test]
fn stiffness_of_a_sandwich_is_that_of_its_parts() {
    // Faces of 1 mm on a core of 8 mm that is a hundred times as soft, in mm and MPa.
    let plies = [
        ply(100.0, 0.0, 1.0),
        ply(1.0, 0.0, 8.0),
        ply(100.0, 0.0, 1.0),
    ];
    let found = Laminate::new(&plies).unwrap();
    assert!((found.stretching_stiffness - 208.0).abs() < 1e-10);
    let bending = 2.0 * 100.0 * (1.0 / 12.0 + 4.5 * 4.5) + 512.0 / 12.0;
    assert!((found.bending_stiffness / bending - 1.0).abs() < 1e-14);
    assert!((found.neutral_height - 5.0).abs() < 1e-14);
    assert_eq!(found.natural_curvature, 0.0);
}

#[test]
fn equal_strains_bend_nothing_whatever_the_plies() {
    let strain = 0.037;
    let plies = [
        ply(3e9, strain, 1e-5),
        ply(7e8, strain, 3e-5),
        ply(1e8, strain, 2e-5),
    ];
    let found = Laminate::new(&plies).unwrap();
    assert!((found.natural_strain - strain).abs() < 1e-16);
    // As a share of the curvature that this strain between plies would make.
    assert!(found.natural_curvature.abs() * 6e-5 < 1e-14 * strain);
}

#[test]
fn turned_over_it_bends_the_other_way() {
    let mut plies = vec![
        ply(3e9, 0.01, 1e-5),
        ply(7e8, -0.02, 3e-5),
        ply(1e8, 0.03, 2e-5),
    ];
    let found = Laminate::new(&plies).unwrap();
    plies.reverse();
    let turned = Laminate::new(&plies).unwrap();
    assert!((found.natural_curvature / turned.natural_curvature + 1.0).abs() < 1e-12);
    assert!((found.bending_stiffness / turned.bending_stiffness - 1.0).abs() < 1e-12);
    assert!((found.neutral_height + turned.neutral_height - 6e-5).abs() < 1e-17);
}

/// `n` plies with the mean strains of a linear profile have `1 - 1/n^2` of its curvature.
#[test]
fn many_plies_approach_a_linear_profile() {
    let (thickness, [lower, upper]) = (1e-4, [-0.004, 0.006]);
    let expected = linear_profile_curvature([lower, upper], thickness);
    for count in [2, 5, 100] {
        let n = f64::from(count);
        let strain = |i: i32| lower + (upper - lower) * (f64::from(i) + 0.5) / n;
        let plies: Vec<_> = (0..count)
            .map(|i| ply(1e9, strain(i), thickness / n))
            .collect();
        let found = Laminate::new(&plies).unwrap().natural_curvature / expected;
        assert!(
            (found - (1.0 - 1.0 / (n * n))).abs() < 1e-10,
            "{count}: {found}"
        );
    }
    // Two halves read as a profile again.
    let halves = [-0.0015, 0.0035];
    let profile = 2.0 * linear_profile_curvature(halves, thickness);
    assert!((profile / expected - 1.0).abs() < 1e-12);
}

#[test]
fn bad_plies_are_named() {
    assert_eq!(Laminate::new(&[]), Err(MaterialError::NoPlies));
    let good = ply(1e9, 0.0, 1e-4);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for bad in [
            Ply {
                modulus: value,
                ..good
            },
            Ply {
                thickness: value,
                ..good
            },
        ] {
            let error = Laminate::new(&[good, bad]).unwrap_err();
            assert!(
                matches!(error, MaterialError::NotPositive { .. }),
                "{error}"
            );
        }
    }
    for natural_strain in [-1.0, f64::NAN, f64::INFINITY] {
        let bad = Ply {
            natural_strain,
            ..good
        };
        let error = Laminate::new(&[bad]).unwrap_err();
        assert!(matches!(error, MaterialError::OutOfRange { .. }), "{error}");
        assert!(error.to_string().contains(&natural_strain.to_string()));
    }
    for thickness in [1e-200, 1e200] {
        let extreme = Ply { thickness, ..good };
        let error = Laminate::new(&[extreme]).unwrap_err();
        assert!(matches!(error, MaterialError::Overflow { .. }), "{error}");
    }
}
