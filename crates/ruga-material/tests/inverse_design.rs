//! The layer designed for a wavelength and a strain has them.

use proptest::prelude::*;
use ruga_material::{PRESETS, Substrate, WavelengthModel, design_layer, wrinkling};

/// Relative error of the round trip.
const ROUND_TRIP: f64 = 1e-9;

#[test]
fn presets_come_back() {
    for pair in &PRESETS {
        let found = wrinkling(&pair.layer, &pair.substrate, WavelengthModel::Layer).unwrap();
        let (wavelength, strain) = (found.wavelength, found.critical_strain);
        let layer = design_layer(wavelength, strain, 0.48, 1100.0, &pair.substrate).unwrap();
        assert!(
            (layer.young / pair.layer.young - 1.0).abs() < ROUND_TRIP,
            "{}",
            pair.name
        );
        assert!(
            (layer.thickness / pair.layer.thickness - 1.0).abs() < ROUND_TRIP,
            "{}",
            pair.name
        );
        assert_eq!((layer.poisson, layer.density), (0.48, 1100.0));
    }
}

/// Layers 1.4: on a half-space ε_c of 2, 3, 5, 8 % needs a modulus ratio of 133, 72, 34, 17, and for
/// 10 mm a thickness of .45, .55, .71, .90 mm.
#[test]
fn deep_substrate_gives_the_closed_form() {
    let poisson = 0.5 - 1e-9;
    let substrate = Substrate {
        young: 2e4,
        poisson,
        thickness: 1.0,
    };
    for (strain, ratio, millimetres) in [
        (0.02, 133.0, 0.45),
        (0.03, 72.0, 0.55),
        (0.05, 34.0, 0.71),
        (0.08, 17.0, 0.90),
    ] {
        let layer = design_layer(0.01, strain, poisson, 1100.0, &substrate).unwrap();
        assert!(
            (layer.young / substrate.young - ratio).abs() <= 0.5,
            "{layer:?}"
        );
        assert!(
            (1e3 * layer.thickness - millimetres).abs() <= 0.005,
            "{layer:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn targets_come_back(
        log_wavelength in -5.0..0.0_f64,
        strain in 1e-4..0.9_f64,
        poisson in -0.99..0.499_f64,
        log_young in 2.0..9.0_f64,
        substrate_poisson in prop_oneof![-0.99..0.499_f64, (-12.0..-1.0_f64).prop_map(|e| 0.5 - 10f64.powf(e))],
        log_height in -6.0..1.0_f64,
    ) {
        let wavelength = 10f64.powf(log_wavelength);
        let substrate = Substrate {
            young: 10f64.powf(log_young),
            poisson: substrate_poisson,
            thickness: 10f64.powf(log_height),
        };
        let layer = design_layer(wavelength, strain, poisson, 1000.0, &substrate).unwrap();
        let found = wrinkling(&layer, &substrate, WavelengthModel::Layer).unwrap();
        prop_assert!((found.wavelength / wavelength - 1.0).abs() < ROUND_TRIP, "{found:?}");
        prop_assert!((found.critical_strain / strain - 1.0).abs() < ROUND_TRIP, "{found:?}");
    }
}
