//! Painted places: modulus and thickness scale the layer, the painted wavelength has the last word.

use proptest::prelude::*;
use ruga_material::{
    LayerMaterial, MaterialError, PRESETS, RelativeProperties, WavelengthModel, Wrinkling,
    local_substrate, local_wrinkling, wrinkling,
};

/// Every number of a [`Wrinkling`].
fn numbers(found: &Wrinkling) -> [f64; 9] {
    [
        found.wavelength,
        found.wave_number,
        found.critical_strain,
        found.critical_force,
        found.bending_stiffness,
        found.membrane_stiffness,
        found.normal_stiffness,
        found.gradient_stiffness,
        found.tangential_stiffness,
    ]
}

/// Relative to the larger part of a sum where a number may pass zero (`K1`, of the size of `N_c`).
fn assert_same(found: &Wrinkling, expected: &Wrinkling, relative: f64, what: &str) {
    for (found, wanted) in numbers(found).into_iter().zip(numbers(expected)) {
        let size = if wanted == expected.gradient_stiffness {
            expected.critical_force
        } else {
            wanted
        };
        assert!(
            (found - wanted).abs() <= relative * size,
            "{what}: {found}, expected {wanted}"
        );
    }
}

#[test]
fn nothing_painted_changes_nothing() {
    for pair in &PRESETS {
        for model in WavelengthModel::ALL {
            let plain = wrinkling(&pair.layer, &pair.substrate, model).expect("a preset");
            let one = RelativeProperties::default();
            let found = local_wrinkling(&pair.layer, &pair.substrate, model, &one);
            assert_same(&found.expect("a preset"), &plain, 1e-14, pair.name);
        }
    }
}

#[test]
fn modulus_and_thickness_scale_the_layer() {
    let pair = &PRESETS[1];
    let relative = RelativeProperties {
        young: 0.5,
        thickness: 2.0,
        ..RelativeProperties::default()
    };
    let layer = LayerMaterial {
        young: 300e6,
        thickness: 0.24e-3,
        ..pair.layer
    };
    assert_eq!(relative.scaled(&pair.layer), layer);
    for model in WavelengthModel::ALL {
        let expected = wrinkling(&layer, &pair.substrate, model).expect("valid");
        let found = local_wrinkling(&pair.layer, &pair.substrate, model, &relative);
        assert_same(&found.expect("valid"), &expected, 1e-14, model.name());
    }
}

/// A longer wave needs a softer substrate and comes earlier; on a half-space `k³` is proportional to
/// the modulus, `ε_c` to `k²`.
#[test]
fn powers_of_the_half_space() {
    let pair = &PRESETS[0];
    let model = WavelengthModel::HalfSpace;
    let plain = wrinkling(&pair.layer, &pair.substrate, model).expect("a preset");
    for stretch in [0.5, 2.0, 3.0] {
        let relative = RelativeProperties {
            wavelength: stretch,
            ..RelativeProperties::default()
        };
        let found = local_wrinkling(&pair.layer, &pair.substrate, model, &relative).expect("valid");
        let below = local_substrate(&pair.layer, &pair.substrate, model, &relative).expect("valid");
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-13;
        assert!(close(found.wavelength, stretch * plain.wavelength));
        assert!(close(
            found.critical_strain,
            plain.critical_strain / stretch.powi(2)
        ));
        assert!(close(below.young, pair.substrate.young / stretch.powi(3)));
        assert_eq!(below.thickness, pair.substrate.thickness);
    }
}

#[test]
fn bad_relative_values_are_named() {
    let pair = &PRESETS[0];
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let one = RelativeProperties::default();
        for (name, relative) in [
            (
                "relative wavelength",
                RelativeProperties {
                    wavelength: bad,
                    ..one
                },
            ),
            (
                "relative Young's modulus",
                RelativeProperties { young: bad, ..one },
            ),
            (
                "relative thickness",
                RelativeProperties {
                    thickness: bad,
                    ..one
                },
            ),
        ] {
            for model in WavelengthModel::ALL {
                let error =
                    local_wrinkling(&pair.layer, &pair.substrate, model, &relative).unwrap_err();
                assert!(
                    matches!(error, MaterialError::NotPositive { parameter, .. } if parameter == name)
                );
                assert!(local_substrate(&pair.layer, &pair.substrate, model, &relative).is_err());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// The wavelength is the painted one, and all numbers are those of the painted layer on the
    /// substrate that is said to lie below.
    #[test]
    fn the_painted_wavelength_is_that_of_a_real_pair(
        preset in 0..PRESETS.len(),
        model in 0..3_usize,
        logarithms in prop::array::uniform3(-1.0..1.0_f64),
        substrate_poisson in prop_oneof![0.0..0.49_f64, (-12.0..-2.0_f64).prop_map(|e| 0.5 - 10f64.powf(e))],
    ) {
        let pair = &PRESETS[preset];
        let model = WavelengthModel::ALL[model];
        let substrate = ruga_material::Substrate { poisson: substrate_poisson, ..pair.substrate };
        let [wavelength, young, thickness] = logarithms.map(|l| 10f64.powf(0.7 * l));
        let relative = RelativeProperties { wavelength, young, thickness };
        let layer = relative.scaled(&pair.layer);
        let predicted = wrinkling(&layer, &substrate, model).expect("valid");
        let found = local_wrinkling(&pair.layer, &substrate, model, &relative).expect("valid");
        prop_assert!((found.wavelength / (wavelength * predicted.wavelength) - 1.0).abs() < 1e-13);
        let below = local_substrate(&pair.layer, &substrate, model, &relative).expect("valid");
        let again = wrinkling(&layer, &below, model).expect("valid");
        assert_same(&found, &again, 1e-11, pair.name);
        prop_assert_eq!(wavelength > 1.0, below.young < substrate.young);
    }
}
