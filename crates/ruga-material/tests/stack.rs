//! Layers on layers: the notes' table, and the limits in which one layer is left.

mod skins;

use proptest::prelude::*;
use ruga_material::{
    FirstScale, LayerMaterial, MaterialError, StackLayer, StackPair, WavelengthModel, preset,
};
use skins::{
    FACE2, LK, MIDDLE, THIN_FILM, WEAK, assert_close, assert_prints, joint, pair, skin, stack,
};

/// Layers 2.1: materials, λ1 and ε1 alone, λ2 and ε2 alone, S2/S1, e_j and λ_j; each number with
/// the worth of its last digit. The λ_j printed as 16.1 and 15.1 are 16.16 and 15.17: the notes'
/// are cut, so their digit counts twice.
#[test]
fn two_shell_table() {
    type Printed = (f64, f64);
    let table: [([f64; 6], [Printed; 7]); 6] = [
        (
            LK,
            [
                (11.3, 0.1),
                (13.0, 1.0),
                (2.46, 0.01),
                (1.95, 0.01),
                (13.9, 0.11),
                (1.17, 0.01),
                (12.2, 0.1),
            ],
        ),
        (
            THIN_FILM,
            [
                (11.3, 0.1),
                (13.0, 1.0),
                (0.64, 0.01),
                (3.8, 0.1),
                (1.5, 0.1),
                (6.5, 0.1),
                (12.4, 0.1),
            ],
        ),
        (
            FACE2,
            [
                (10.0, 0.1),
                (9.7, 0.1),
                (0.78, 0.01),
                (4.0, 0.1),
                (2.3, 0.1),
                (3.9, 0.1),
                (11.3, 0.1),
            ],
        ),
        (
            [40.0, 0.03, 1.0, 0.7, 0.02, 8.0],
            [
                (10.9, 0.1),
                (3.9, 0.1),
                (0.45, 0.01),
                (4.5, 0.11),
                (1.7, 0.1),
                (2.04, 0.01),
                (13.5, 0.1),
            ],
        ),
        (
            MIDDLE,
            [
                (14.4, 0.1),
                (4.5, 0.1),
                (0.40, 0.01),
                (15.8, 0.1),
                (0.30, 0.01),
                (4.2, 0.1),
                (16.1, 0.2),
            ],
        ),
        (
            WEAK,
            [
                (14.4, 0.1),
                (4.5, 0.1),
                (0.19, 0.01),
                (25.0, 1.0),
                (0.09, 0.01),
                (4.5, 0.1),
                (15.1, 0.2),
            ],
        ),
    ];
    for (values, printed) in table {
        let found = pair(values);
        let (lower, upper) = (found.lower.wrinkling, found.upper.wrinkling);
        let numbers = [
            1e3 * lower.wavelength,
            100.0 * lower.critical_strain,
            1e3 * upper.wavelength,
            100.0 * upper.critical_strain,
            found.membrane_ratio,
            100.0 * joint(&found).critical_strain,
            1e3 * joint(&found).wavelength,
        ];
        for (column, (number, (printed, digit))) in numbers.into_iter().zip(printed).enumerate() {
            assert_prints(
                number,
                printed,
                digit,
                &format!("{values:?}, column {column}"),
            );
        }
        assert!(joint(&found).wavelength > 0.6 * lower.wavelength);
    }
}

/// Layers 2.1 and 2.2: fine minima, the strain of a fine wave, the force ratio, the shares.
#[test]
fn what_the_notes_say_of_the_pairs() {
    let tangential_ratio = |found: &StackPair| {
        found.nominal_tangential_stiffness() / found.shear_tangential_stiffness()
    };
    let lk = pair(LK);
    assert_eq!(lk.fine, None);
    assert_eq!(lk.first_scale(), FirstScale::Large);
    assert!(lk.nominal_disagrees());
    assert_prints(lk.force_ratio, 2.1, 0.1, "r_N");
    assert_prints(lk.bending_transfer, 0.067, 1e-3, "β");
    // The prototype prints 1.79 %; the springs' value is 1.781 %.
    let fine = lk.strain(std::f64::consts::TAU / 2.5e-3);
    assert_prints(100.0 * fine, 1.79, 0.02, "e(2.5 mm)");
    assert_prints(tangential_ratio(&lk), 6.4, 0.1, "K_t");

    for values in [LK, THIN_FILM, FACE2, MIDDLE, WEAK] {
        // As stiff as for a layer of its own at the fine wave, and as shear alone where sliding is even.
        let found = pair(values);
        let k = found.upper.wrinkling.wave_number;
        let at_fine_wave =
            found.shear_tangential_stiffness() + found.drift_gradient_stiffness(k) * k * k;
        assert_close(
            at_fine_wave,
            found.nominal_tangential_stiffness(),
            1e-12,
            "K_g",
        );
    }
    let film = pair(THIN_FILM);
    let fine = film.fine.expect("two minima");
    assert_prints(100.0 * fine.critical_strain, 3.8, 0.1, "ε");
    assert_prints(1e3 * fine.wavelength, 0.64, 0.01, "λ");
    assert_eq!(film.first_scale(), FirstScale::Fine);
    assert_prints(film.bending_transfer, 0.39, 0.01, "β");
    assert_prints(tangential_ratio(&film), 24.0, 1.0, "K_t");

    let face = pair(FACE2);
    let fine = face.fine.expect("two minima");
    assert_prints(100.0 * fine.critical_strain, 4.0, 0.1, "ε");
    assert_prints(1e3 * fine.wavelength, 0.79, 0.01, "λ");
    assert_eq!(face.first_scale(), FirstScale::Large);
    assert!(face.nominal_disagrees());
    assert_prints(face.bending_transfer, 0.30, 0.01, "β");

    // S2/S1 = .1: +5 %; .3: +12 % in wavelength, -7 % in onset.
    for (values, longer, earlier) in [(WEAK, 0.05, 0.0), (MIDDLE, 0.12, 0.07)] {
        let found = pair(values);
        let alone = found.lower.wrinkling;
        let length = joint(&found).wavelength / alone.wavelength - 1.0;
        assert!((length - longer).abs() < 0.01, "{length}");
        let onset = 1.0 - joint(&found).critical_strain / alone.critical_strain;
        assert!((onset - earlier).abs() < 0.01, "{onset}");
        assert!(!found.nominal_disagrees());
        assert_eq!(found.first_scale(), FirstScale::Large);
    }
}

/// A film whose wave, of a half-space, is long against the layer below slides on the shear of all of it.
#[test]
fn sliding_is_never_held_less_the_shorter_it_is() {
    let materials = [skin(0.1, 0.1), skin(600.0, 0.12)];
    let below = skin(0.05, 10.0).as_substrate();
    let placed = |material: LayerMaterial, below: &_| {
        StackLayer::new(material, below, WavelengthModel::HalfSpace).expect("valid materials")
    };
    let lower = placed(materials[0], &below);
    let upper = placed(materials[1], &materials[0].as_substrate());
    let found = StackPair::new(&lower, &upper).expect("valid materials");
    assert!(found.nominal_tangential_stiffness() < found.shear_tangential_stiffness());
    let k = found.upper.wrinkling.wave_number;
    assert_eq!(found.drift_gradient_stiffness(k), 0.0);
}

/// The estimate `S2/S1 = 3 λ2/(8 ε2 λ1 √ε1)`, of half-spaces, within a quarter for all of the table.
#[test]
fn membrane_ratio_from_what_is_seen() {
    for values in [LK, THIN_FILM, FACE2, MIDDLE, WEAK] {
        let found = pair(values);
        let (lower, upper) = (found.lower.wrinkling, found.upper.wrinkling);
        let estimate = 3.0 * upper.wavelength
            / (8.0 * upper.critical_strain * lower.wavelength * lower.critical_strain.sqrt());
        assert_close(estimate, found.membrane_ratio, 0.25, "S2/S1");
    }
}

/// The smaller root of `det(A - e B) = 0` by the textbook's formula, at each wave number.
#[test]
fn strain_is_the_smallest_eigenvalue() {
    for values in [LK, THIN_FILM, FACE2, MIDDLE, WEAK] {
        let found = pair(values);
        let (one, two) = (found.lower.wrinkling, found.upper.wrinkling);
        let offset = 0.5 * (found.lower.material.thickness + found.upper.material.thickness);
        for step in 0..60 {
            let k = one.wave_number * (f64::from(step) / 10.0 - 1.0).exp();
            let (s1, s2) = (
                one.membrane_stiffness * k * k,
                two.membrane_stiffness * k * k,
            );
            let shear = 1.0 / (1.0 / s1 + 1.0 / found.shear_tangential_stiffness() + 1.0 / s2);
            let below = one.normal_stiffness + one.gradient_stiffness * k * k;
            let between = two.normal_stiffness + two.gradient_stiffness * k * k;
            let first =
                one.bending_stiffness * k.powi(4) + below + between + shear * (offset * k).powi(2);
            let second = two.bending_stiffness * k.powi(4) + between;
            let strain = found.strain(k);
            let residual = (first - strain * s1) * (second - strain * s2) - between * between;
            assert!(residual.abs() < 1e-12 * first * second, "{values:?}, k {k}");
            // The other eigenvalue is the larger one: their sum is the trace.
            assert!(first / s1 + second / s2 - strain >= strain * (1.0 - 1e-12));
        }
    }
}

/// The presets of the two-layer face fit together.
#[test]
fn face2_is_a_stack() {
    let [dermis, epidermis] =
        ["face2-dermis", "face2-epidermis"].map(|name| preset(name).expect("a preset"));
    assert_eq!(dermis.layer.as_substrate(), epidermis.substrate);
    let layers = stack(&[dermis.layer, epidermis.layer], dermis.substrate);
    let found = StackPair::new(&layers[0], &layers[1]).expect("valid");
    let same = pair(FACE2);
    assert_close(joint(&found).wavelength, joint(&same).wavelength, 1e-7, "λ");
    assert_close(
        joint(&found).critical_strain,
        joint(&same).critical_strain,
        1e-12,
        "e",
    );
}

/// A lower layer twelve times as stiff as its substrate is no film: the fine wave is all there is.
#[test]
fn a_pair_without_a_large_wave() {
    let found = pair([90.0, 0.0387, 0.119, 1.262, 0.01, 1.0]);
    assert_eq!(found.joint, None);
    let fine = found.fine.expect("the upper layer wrinkles");
    assert_close(fine.wavelength, found.upper.wrinkling.wavelength, 0.1, "λ");
    assert_eq!(found.first_scale(), FirstScale::Fine);
    assert!(!found.nominal_disagrees());
    let words = found.composite().unwrap_err().to_string();
    assert!(words.contains("no large wave"), "{words}");
}

/// Numbers that no material has end in an error, not in an endless search.
#[test]
fn spoilt_layers_are_refused() {
    let good = pair(LK);
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        let mut upper = good.upper;
        upper.wrinkling.wave_number = bad;
        assert!(StackPair::new(&good.lower, &upper).is_err());
        let mut lower = good.lower;
        lower.wrinkling.membrane_stiffness = bad;
        let found = StackPair::new(&lower, &good.upper);
        assert!(
            found.is_err() || found.is_ok_and(|pair| pair.composite().is_err()),
            "{bad}"
        );
    }
}

fn lower_wave(pair: &StackPair) -> f64 {
    pair.lower.wrinkling.wavelength
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Any pair whose upper layer is the finer one: the joint wave costs no more than either layer
    /// alone, what is returned is finite, and composites keep to their bound or say so.
    #[test]
    fn any_pair_has_a_joint_wave(
        substrate_young in -3.0..1.0_f64,
        ratios in prop::array::uniform2(0.5..4.0_f64),
        height in -1.0..2.0_f64,
        thickness in -1.0..1.0_f64,
        finer in -3.0..0.0_f64,
        poisson in prop::array::uniform3(0.0..0.4999_f64),
    ) {
        let power = |exponent: f64| 10f64.powf(exponent);
        let young = power(substrate_young);
        let with = |layer: LayerMaterial, poisson| LayerMaterial { poisson, ..layer };
        let base = with(skin(young, power(height)), poisson[0]).as_substrate();
        let lower = with(skin(young * power(ratios[0]), power(thickness)), poisson[1]);
        let upper = with(skin(young * power(ratios[0] + ratios[1]), power(thickness + finer)), poisson[2]);
        let layers = stack(&[lower, upper], base);
        let found = StackPair::new(&layers[0], &layers[1]).expect("valid");
        let modes = [found.joint, found.fine];
        prop_assert!(modes.iter().flatten().count() > 0);
        for mode in modes.into_iter().flatten() {
            prop_assert!(mode.critical_strain > 0.0 && mode.critical_strain.is_finite());
            prop_assert_eq!(found.strain(mode.wave_number), mode.critical_strain);
            for factor in [0.98, 1.02] {
                prop_assert!(found.strain(factor * mode.wave_number) >= mode.critical_strain);
            }
        }
        let bound = lower_wave(&found) * 0.6;
        prop_assert!(found.joint.is_none_or(|joint| joint.wavelength > bound));
        prop_assert!(found.fine.is_none_or(|fine| fine.wavelength <= bound));
        match found.composite() {
            Ok(composite) => prop_assert_eq!(composite.material.validate(), Ok(())),
            Err(MaterialError::CompositeUnstable { gradient_stiffness, bound }) => {
                prop_assert!(gradient_stiffness.abs() >= bound);
            }
            Err(other) => {
                prop_assert!(matches!(other, MaterialError::NoJointWave { .. }), "{other}");
                prop_assert!(found.joint.is_none());
                prop_assert_eq!(found.first_scale(), FirstScale::Fine);
            }
        }
    }
}
