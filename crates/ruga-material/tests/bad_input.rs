//! Every mistake is named, with its value; nothing panics and no NaN comes out.

use nalgebra::Vector2;
use proptest::prelude::*;
use ruga_material::{
    LayerMaterial, MaterialError, PRESETS, Preset, PropertyImage, PropertyMap, RelativeProperties,
    StackLayer, StackPair, Substrate, WavelengthModel, Wrap, composite_layers, design_layer,
    wrinkling,
};

const NOT_POSITIVE: [f64; 6] = [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
const NOT_POISSON: [f64; 6] = [-1.0, 0.5, 0.51, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

type SetLayer = fn(&mut LayerMaterial, f64);
type SetSubstrate = fn(&mut Substrate, f64);

fn error_of(layer: &LayerMaterial, substrate: &Substrate) -> MaterialError {
    wrinkling(layer, substrate, WavelengthModel::Layer).expect_err("a parameter is out of range")
}

/// The parameter named and the bits of its value, so that a NaN equals itself.
fn named(error: MaterialError) -> (&'static str, u64) {
    match error {
        MaterialError::NotPositive { parameter, value }
        | MaterialError::PoissonOutOfRange { parameter, value } => (parameter, value.to_bits()),
        other => panic!("unexpected {other}"),
    }
}

#[test]
fn layer_parameters_are_named() {
    let cases: [(&str, SetLayer, &[f64]); 4] = [
        (
            "layer Young's modulus (Pa)",
            |layer, v| layer.young = v,
            &NOT_POSITIVE,
        ),
        (
            "layer Poisson ratio",
            |layer, v| layer.poisson = v,
            &NOT_POISSON,
        ),
        (
            "layer thickness (m)",
            |layer, v| layer.thickness = v,
            &NOT_POSITIVE,
        ),
        (
            "layer density (kg/m³)",
            |layer, v| layer.density = v,
            &NOT_POSITIVE,
        ),
    ];
    for (name, set, values) in cases {
        for &value in values {
            let mut layer = PRESETS[0].layer;
            set(&mut layer, value);
            let error = error_of(&layer, &PRESETS[0].substrate);
            assert_eq!(named(error), (name, value.to_bits()));
            assert!(error.to_string().contains(name));
            assert_eq!(
                layer.validate().map_err(|e| e.to_string()),
                Err(error.to_string())
            );
        }
    }
}

#[test]
fn substrate_parameters_are_named() {
    let cases: [(&str, SetSubstrate, &[f64]); 3] = [
        (
            "substrate Young's modulus (Pa)",
            |substrate, v| substrate.young = v,
            &NOT_POSITIVE,
        ),
        (
            "substrate Poisson ratio",
            |substrate, v| substrate.poisson = v,
            &NOT_POISSON,
        ),
        (
            "substrate thickness (m)",
            |substrate, v| substrate.thickness = v,
            &NOT_POSITIVE,
        ),
    ];
    for (name, set, values) in cases {
        for &value in values {
            let mut substrate = PRESETS[0].substrate;
            set(&mut substrate, value);
            assert_eq!(
                named(error_of(&PRESETS[0].layer, &substrate)),
                (name, value.to_bits())
            );
        }
    }
}

#[test]
fn messages_say_what_is_accepted() {
    let layer = LayerMaterial {
        thickness: -0.001,
        ..PRESETS[0].layer
    };
    let substrate = PRESETS[0].substrate;
    assert_eq!(
        error_of(&layer, &substrate).to_string(),
        "layer thickness (m) is -0.001, but must be a finite number above 0"
    );
    let substrate = Substrate {
        poisson: 0.5,
        ..substrate
    };
    assert_eq!(
        error_of(&PRESETS[0].layer, &substrate).to_string(),
        "substrate Poisson ratio is 0.5, but must lie strictly between -1 and 0.5"
    );
}

#[test]
fn design_targets_are_named() {
    let substrate = PRESETS[0].substrate;
    for value in NOT_POSITIVE {
        let error = design_layer(value, 0.05, 0.48, 1100.0, &substrate).unwrap_err();
        assert_eq!(named(error), ("wavelength (m)", value.to_bits()));
        let error = design_layer(0.01, 0.05, 0.48, value, &substrate).unwrap_err();
        assert_eq!(named(error), ("layer density (kg/m³)", value.to_bits()));
    }
    for value in [0.0, 1.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = design_layer(0.01, value, 0.48, 1100.0, &substrate).unwrap_err();
        assert!(
            matches!(error, MaterialError::StrainOutOfRange { .. }),
            "{error}"
        );
        assert!(error.to_string().contains("strictly between 0 and 1"));
    }
    for value in NOT_POISSON {
        let error = design_layer(0.01, 0.05, value, 1100.0, &substrate).unwrap_err();
        assert_eq!(named(error), ("layer Poisson ratio", value.to_bits()));
    }
    let hollow = Substrate {
        thickness: 0.0,
        ..substrate
    };
    let error = design_layer(0.01, 0.05, 0.48, 1100.0, &hollow).unwrap_err();
    assert_eq!(named(error), ("substrate thickness (m)", 0));
}

#[test]
fn overflow_is_an_error() {
    let layer = LayerMaterial {
        young: 1e300,
        thickness: 1e100,
        ..PRESETS[0].layer
    };
    let error = error_of(&layer, &PRESETS[0].substrate);
    assert!(matches!(error, MaterialError::Overflow { .. }), "{error}");
    let substrate = Substrate {
        young: 1e300,
        ..PRESETS[0].substrate
    };
    let error = design_layer(1e-200, 1e-200, 0.48, 1100.0, &substrate).unwrap_err();
    assert!(matches!(error, MaterialError::Overflow { .. }), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Any numbers at all, most of them acceptable and dozens of decades apart.
    #[test]
    fn any_number_gives_an_error_or_finite_results(
        values in prop::array::uniform8(prop_oneof![
            1 => any::<f64>(),
            9 => (-60.0..60.0_f64).prop_map(|exponent| 10f64.powf(exponent)),
        ]),
        poisson in prop::array::uniform2(prop_oneof![9 => -1.0..0.5, 1 => any::<f64>()]),
    ) {
        let layer = LayerMaterial {
            young: values[0], poisson: poisson[0], thickness: values[1], density: values[2],
        };
        let substrate = Substrate { young: values[3], poisson: poisson[1], thickness: values[4] };
        for model in WavelengthModel::ALL {
            if let Ok(found) = wrinkling(&layer, &substrate, model) {
                let all = [
                    found.wavelength, found.wave_number, found.critical_strain,
                    found.critical_force, found.bending_stiffness, found.membrane_stiffness,
                    found.normal_stiffness, found.tangential_stiffness,
                ];
                prop_assert!(all.iter().all(|v| v.is_finite() && *v > 0.0), "{found:?}");
                prop_assert!(found.gradient_stiffness.is_finite(), "{found:?}");
            }
        }
        let strain = values[6] / (1.0 + values[6]);
        if let Ok(found) = design_layer(values[5], strain, poisson[0], values[7], &substrate) {
            prop_assert_eq!(found.validate(), Ok(()));
        }
    }
}

#[test]
fn layers_of_a_stack_set_by_hand_are_checked() {
    let layer = |which: usize| {
        let Preset {
            layer, substrate, ..
        } = PRESETS[which];
        StackLayer::new(layer, &substrate, WavelengthModel::Layer).expect("a preset")
    };
    let (lower, upper) = (layer(0), layer(1));
    assert!(StackPair::new(&lower, &upper).is_ok());
    let breaks: [fn(&mut StackLayer, f64); 5] = [
        |layer, bad| layer.material.thickness = bad,
        |layer, bad| layer.material.young = bad,
        |layer, bad| layer.wrinkling.wave_number = bad,
        |layer, bad| layer.wrinkling.membrane_stiffness = bad,
        |layer, bad| layer.wrinkling.gradient_stiffness = bad,
    ];
    for set in breaks {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut broken = lower;
            set(&mut broken, bad);
            assert!(StackPair::new(&broken, &upper).is_err());
            assert!(composite_layers(&[broken, upper]).is_err());
            let mut broken = upper;
            set(&mut broken, bad);
            assert!(StackPair::new(&lower, &broken).is_err());
            assert!(composite_layers(&[lower, broken]).is_err());
        }
    }
}

#[test]
fn nothing_is_painted_where_there_is_no_uv() {
    let image = PropertyImage {
        width: 1,
        height: 1,
        values: vec![1.0],
        range: [1.0, 3.0],
    };
    for wrap in [Wrap::ClampToEdge, Wrap::Repeat] {
        let map = PropertyMap::new(None, None, Some(image.clone()), wrap).expect("a map");
        assert_eq!(map.sample(&Vector2::new(0.3, 0.9)).thickness, 3.0);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let uv = Vector2::new(0.5, bad);
            assert_eq!(map.sample(&uv), RelativeProperties::default());
            assert_eq!(map.crossings(&uv, &Vector2::zeros(), 1.2), Ok(vec![]));
        }
    }
}
