//! Closed forms of a crease in a film: limits, and equilibrium of what they say.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use ruga_material::{
    CreaseLoad, WavelengthModel, anchor_pull, crease_depth, crease_fold, crease_onset,
    crease_profile, preset, wrinkling,
};

#[test]
fn onset_between_that_of_a_hinge_and_that_of_the_film() {
    for (kappa, onset) in [(0.0, 0.5), (0.02, 0.5196), (0.162, 0.6379), (0.884, 0.8984)] {
        assert!((crease_onset(kappa) - onset).abs() < 1e-4, "{kappa}");
    }
    assert_eq!(crease_onset(f64::INFINITY), 1.0);
    assert_eq!(crease_onset(1e200), 1.0);
    let mut last = 0.0;
    for i in 0..200 {
        let onset = crease_onset(1e-3 * 1.1_f64.powi(i));
        assert!(onset >= last);
        last = onset;
    }
}

#[test]
fn a_free_hinge_in_a_forehead_folds_at_two_thirds_of_its_critical_strain() {
    let forehead = preset("forehead-furrow").unwrap();
    let theory = wrinkling(&forehead.layer, &forehead.substrate, WavelengthModel::Layer).unwrap();
    assert!((theory.critical_strain - 0.045).abs() < 1e-3);
    assert!((theory.crease_strain(0.0) - 0.0295).abs() < 5e-4);
    assert!((theory.reduced_load(theory.critical_strain) - 1.0).abs() < 1e-12);
    // A tenth of the stiffness over one thickness.
    let kappa = theory.crease_stiffness(9.0 * forehead.layer.thickness);
    assert!((kappa - 0.26).abs() < 0.01, "{kappa}");
    assert_eq!(theory.crease_stiffness(0.0), f64::INFINITY);
}

fn free(load: f64) -> CreaseLoad {
    CreaseLoad {
        load,
        stiffness: 0.5,
        rest_angle: 30_f64.to_radians(),
        anchor: 0.0,
        anchor_depth: 0.0,
    }
}

#[test]
fn depth_grows_with_the_load_and_ends_at_the_onset() {
    let onset = crease_onset(0.5);
    let mut last = 0.0;
    for i in 0..100 {
        let depth = crease_depth(&free(-2.0 + (2.0 + onset) * f64::from(i) / 100.0)).unwrap();
        assert!(depth > last);
        last = depth;
    }
    assert!(last > 2.0, "{last}");
    assert_eq!(crease_depth(&free(onset + 1e-9)), None);
    assert_eq!(crease_depth(&free(1.5)), None);
    // A stiff anchor takes the line to its depth.
    let anchored = CreaseLoad {
        anchor: 1e9,
        anchor_depth: 0.2,
        ..free(0.3)
    };
    assert!((crease_depth(&anchored).unwrap() - 0.2).abs() < 1e-6);
    let usual = CreaseLoad {
        anchor: 20.0,
        rest_angle: 0.0,
        ..CreaseLoad {
            load: 0.0,
            ..anchored
        }
    };
    let share = crease_depth(&usual).unwrap() / 0.2;
    assert!((share - 0.91).abs() < 0.005, "{share}");
}

/// `D w'''' + N w'' + K0 w = 0` beside the line, and at the line no shear force:
/// `w'''(0) + 2 η w'(0) = 0`; moment `w''(0) = κ (4 α - θ0)`.
#[test]
fn the_profile_is_in_equilibrium() {
    for load in [-2.0, -1.0, -1.0 + 1e-9, -0.3, 0.0, 0.6, 0.85] {
        let w = |x: f64| crease_profile(load, x).unwrap();
        assert!((w(0.0) + 1.0).abs() < 1e-12);
        let h = 0.02;
        let second = |x: f64| (w(x + h) - 2.0 * w(x) + w(x - h)) / (h * h);
        for x in [0.3, 1.0, 2.5, 7.0] {
            let fourth = (second(x + h) - 2.0 * second(x) + second(x - h)) / (h * h);
            let rest = fourth + 2.0 * load * second(x) + w(x);
            assert!(rest.abs() < 5e-3, "{load} {x}: {rest}");
        }
        let alpha = (0.5 * (1.0_f64 - load)).sqrt();
        let slope = (4.0 * w(1e-4) - w(2e-4) - 3.0 * w(0.0)) / 2e-4;
        assert!((slope - 2.0 * alpha).abs() < 1e-5 * (1.0 + alpha));
        // What sinks at the line rises beside it; the swing is still large at ten bending lengths under a
        // load near 1.
        let steps = 400_000;
        let sum: f64 = (0..steps).map(|i| w((f64::from(i) + 0.5) * 1e-3)).sum();
        assert!((sum * 1e-3).abs() < 1e-5, "{load}: {sum}");
        assert!(w(1e4).abs() < 1e-12);
    }
    assert_eq!(crease_profile(1.0, 0.0), None);
}

/// Springs pull as far as the line is above their depth, and not where it lies deeper by itself.
#[test]
fn an_anchor_pulls_by_what_the_line_lacks() {
    let held = CreaseLoad {
        anchor: 2.0,
        anchor_depth: 0.5,
        rest_angle: 0.1,
        ..free(0.3)
    };
    let depth = crease_depth(&held).unwrap();
    assert!((anchor_pull(&held) - 2.0 * (0.5 - depth)).abs() < 1e-12);
    assert_eq!(
        anchor_pull(&CreaseLoad {
            anchor: 0.0,
            ..held
        }),
        0.0
    );
    // A ridge is a valley upside down; one that is to be a valley is harder to pull down.
    let turned = |rest_angle: f64, anchor_depth: f64| {
        anchor_pull(&CreaseLoad {
            rest_angle,
            anchor_depth,
            ..held
        })
    };
    assert_eq!(turned(-0.1, -0.5), -turned(0.1, 0.5));
    assert!(turned(-0.1, 0.5) > turned(0.1, 0.5));
    // Its angle alone takes the line deeper, and an anchor of no depth takes nothing down.
    assert_eq!(turned(0.8, 0.05), 0.0);
    assert_eq!(turned(0.1, 0.0), 0.0);
    let flat = CreaseLoad {
        rest_angle: 0.0,
        ..held
    };
    // Without a rest angle the line has come to its depth at the onset, and the springs pull no more.
    let onset = crease_onset(held.stiffness);
    for load in [onset, 3.0] {
        assert!(anchor_pull(&CreaseLoad { load, ..flat }).abs() < 1e-9);
    }
    for stiffness in [0.0, 1e9, f64::INFINITY] {
        for load in [-1e6, 0.0, 1.0] {
            let pull = anchor_pull(&CreaseLoad {
                stiffness,
                load,
                ..held
            });
            assert!(pull.is_finite(), "{stiffness} {load}: {pull}");
        }
    }
}

/// At the line the moment of the crease is that of the film beside it, `(1 - 2 η) δ - α a (d - δ)`.
#[test]
fn a_line_folds_until_its_moment_is_that_of_the_film() {
    for load in [-2.0, -0.3, 0.0, 0.4] {
        for anchor in [0.0, 2.0, 20.0] {
            let crease = CreaseLoad {
                load,
                stiffness: 1.4,
                rest_angle: 0.1,
                anchor,
                anchor_depth: 0.15,
            };
            let depth = crease_depth(&crease).expect("a film that does not fold");
            let pull = anchor_pull(&crease);
            let decay = (0.5 * (1.0 - load)).sqrt();
            let moment = crease.stiffness * (crease.rest_angle - crease_fold(&crease));
            let of_film = (1.0 - 2.0 * load) * depth - decay * pull;
            assert!(
                (moment - of_film).abs() < 1e-12,
                "{crease:?}: {moment} {of_film}"
            );
        }
    }
    // By itself a line folds without end at its onset: the film beside it sinks by three tenths of its bending length.
    let most = 1.2 * (0.5 * (1.0 - crease_onset(0.2))).sqrt();
    for (rest_angle, fold) in [(0.1, most), (-0.1, -most), (0.0, 0.0)] {
        let crease = CreaseLoad {
            load: 0.99,
            stiffness: 0.2,
            rest_angle,
            anchor: 0.0,
            anchor_depth: 0.0,
        };
        assert!((crease_fold(&crease) - fold).abs() < 1e-12);
    }
}
