//! Painted places: modulus and thickness scale the layer, the painted wavelength the whole section.

use proptest::prelude::*;
use ruga_material::{
    LayerMaterial, MaterialError, PRESETS, RelativeProperties, WavelengthModel, Wrinkling,
    local_wrinkling, wrinkling,
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

/// A section three times as thick has waves three times as long at the same strain; springs per area
/// are a third as stiff, and bending goes with the cube of the thickness.
#[test]
fn a_painted_wavelength_is_a_section_of_another_size() {
    let pair = &PRESETS[2];
    for model in WavelengthModel::ALL {
        let plain = wrinkling(&pair.layer, &pair.substrate, model).expect("a preset");
        for stretch in [0.1, 0.35, 2.0, 3.0] {
            let relative = RelativeProperties {
                wavelength: stretch,
                ..RelativeProperties::default()
            };
            let found =
                local_wrinkling(&pair.layer, &pair.substrate, model, &relative).expect("valid");
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
            assert!(close(found.wavelength, stretch * plain.wavelength));
            assert!(close(found.critical_strain, plain.critical_strain));
            assert!(close(
                found.bending_stiffness,
                stretch.powi(3) * plain.bending_stiffness
            ));
            assert!(close(
                found.normal_stiffness,
                plain.normal_stiffness / stretch
            ));
        }
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
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Whatever else is painted, the wavelength is the painted one and the strain stays.
    #[test]
    fn the_painted_wavelength_leaves_the_strain(
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
        let unstretched = RelativeProperties { wavelength: 1.0, ..relative };
        let of = |relative| local_wrinkling(&pair.layer, &substrate, model, relative);
        let (found, before) = (of(&relative).expect("valid"), of(&unstretched).expect("valid"));
        prop_assert!((found.wavelength / (wavelength * before.wavelength) - 1.0).abs() < 1e-12);
        prop_assert!((found.critical_strain / before.critical_strain - 1.0).abs() < 1e-11);
    }
}
