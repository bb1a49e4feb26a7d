//! The wave found is the one of least force, and the springs reproduce it.

mod skins;

use std::f64::consts::TAU;

use proptest::prelude::*;
use ruga_material::{
    LayerMaterial, PRESETS, Substrate, WavelengthModel, Wrinkling, capped_strain, effective_strain,
    substrate_stiffness, wrinkling,
};
use skins::assert_close;

/// `N(k) = D k² + K(k)/k²` on the bonded layer.
fn force(found: &Wrinkling, substrate: &Substrate, wave_number: f64) -> f64 {
    let squared = wave_number * wave_number;
    found.bending_stiffness * squared + substrate_stiffness(wave_number, substrate) / squared
}

/// `(E, ν, h, E_s, ν_s, H)` with wavelength and critical strain from 60-digit arithmetic: the two
/// published layers; thin and nearly incompressible; auxetic; far too thick a layer; a half-space.
const REFERENCES: [([f64; 6], f64, f64); 6] = [
    (
        [4e6, 0.48, 1.3e-3, 0.5e6, 0.48, 15e-3],
        0.011_320_411_707_827_938,
        0.130_134_985_860_932_56,
    ),
    (
        [6e8, 0.48, 1.2e-4, 4e6, 0.48, 1.3e-3],
        0.002_456_662_690_685_760_4,
        0.019_501_808_050_887_418,
    ),
    (
        [1e9, 0.3, 1e-4, 1e5, 0.499_999_999, 1e-4],
        0.001_379_776_666_152_187_3,
        0.026_107_645_500_939_018,
    ),
    (
        [1e7, 0.45, 2e-3, 1e6, -0.9, 5e-3],
        0.008_869_476_887_405_744,
        0.492_807_114_594_724_3,
    ),
    (
        [3e6, 0.2, 1e-2, 1e6, 0.3, 1e-4],
        0.013_177_208_406_513_381,
        3.789_093_426_982_504,
    ),
    (
        [2e9, 0.0, 1e-5, 1e6, 0.0, 0.1],
        0.000_498_696_748_316_400_6,
        0.003_968_502_629_920_498,
    ),
];

#[test]
fn wave_and_strain_to_the_last_digits() {
    for (values, wavelength, strain) in REFERENCES {
        let [
            young,
            poisson,
            thickness,
            substrate_young,
            substrate_poisson,
            height,
        ] = values;
        let layer = LayerMaterial {
            young,
            poisson,
            thickness,
            density: 1.0,
        };
        let substrate = Substrate {
            young: substrate_young,
            poisson: substrate_poisson,
            thickness: height,
        };
        let found = wrinkling(&layer, &substrate, WavelengthModel::Layer).unwrap();
        assert_close(found.wavelength, wavelength, 2e-14, "λ");
        assert_close(found.critical_strain, strain, 2e-14, "ε_c");
    }
}

/// A shell on the springs needs `D k² + K1 + K0/k²`: least at `k_c`, and `N_c` there.
#[test]
fn springs_reproduce_wave_and_force() {
    for pair in &PRESETS {
        for model in WavelengthModel::ALL {
            let found = wrinkling(&pair.layer, &pair.substrate, model).unwrap();
            let spring_force = |k: f64| {
                found.bending_stiffness * k * k
                    + found.gradient_stiffness
                    + found.normal_stiffness / (k * k)
            };
            let critical = spring_force(found.wave_number);
            assert_close(critical, found.critical_force, 1e-14, pair.name);
            for factor in [0.5, 0.99, 1.01, 2.0] {
                assert!(
                    spring_force(factor * found.wave_number) > critical,
                    "{}",
                    pair.name
                );
            }
            assert_close(found.wavelength * found.wave_number, TAU, 1e-15, pair.name);
        }
    }
}

#[test]
fn tangential_stiffness_is_clamped() {
    // 2 K0 = C k² (k h)²/6, so that the clamp 0.12 C k² acts from k h = 0.849 on.
    let substrate = Substrate {
        young: 1e5,
        poisson: 0.4,
        thickness: 0.1,
    };
    let mut clamped = [0, 0];
    for ratio in [2.0, 4.0, 6.0, 10.0, 100.0] {
        let layer = LayerMaterial {
            young: ratio * 1e5,
            poisson: 0.4,
            thickness: 1e-3,
            density: 1e3,
        };
        let found = wrinkling(&layer, &substrate, WavelengthModel::HalfSpace).unwrap();
        let kh = found.wave_number * layer.thickness;
        let membrane = found.membrane_stiffness * found.wave_number.powi(2);
        let expected = (kh * kh / 6.0).min(0.12);
        assert_close(found.tangential_stiffness / membrane, expected, 1e-14, "Kt");
        clamped[usize::from(kh * kh / 6.0 > 0.12)] += 1;
    }
    assert_eq!(clamped, [3, 2]);
}

/// Couplings 4: `chi = 3/(ε_c (k_c R)²)` on a half-space; .165 and .585 at `R = 5 λ` for modulus
/// ratios 150 and 1000, .041 and .146 at 10, .002 and .006 at 50.
#[test]
fn curvature_measure_prints_its_table() {
    let substrate = Substrate {
        young: 1e4,
        poisson: 0.45,
        thickness: 1.0,
    };
    for (ratio, radius, printed) in [
        (150.0, 5.0, 0.165),
        (1000.0, 5.0, 0.585),
        (150.0, 10.0, 0.041),
        (1000.0, 10.0, 0.146),
        (150.0, 50.0, 0.002),
        (1000.0, 50.0, 0.006),
    ] {
        let layer = LayerMaterial {
            young: ratio * 1e4,
            poisson: 0.45,
            thickness: 1e-3,
            density: 1.0,
        };
        let found = wrinkling(&layer, &substrate, WavelengthModel::HalfSpace).unwrap();
        let chi = found.curvature_measure(radius * found.wavelength);
        assert!((chi - printed).abs() <= 5e-4, "{chi}, printed {printed}");
        assert_eq!(chi, found.curvature_measure(-radius * found.wavelength));
    }
    let flat = wrinkling(
        &PRESETS[0].layer,
        &PRESETS[0].substrate,
        WavelengthModel::Layer,
    )
    .unwrap();
    assert_eq!(flat.curvature_measure(f64::INFINITY), 0.0);
}

#[test]
fn amplitude_of_a_half_space_film() {
    // A = h √(ε/ε_c - 1).
    let layer = LayerMaterial {
        young: 1.5e6,
        poisson: 0.3,
        thickness: 1e-3,
        density: 1.0,
    };
    let substrate = Substrate {
        young: 1e4,
        poisson: 0.3,
        thickness: 1.0,
    };
    let found = wrinkling(&layer, &substrate, WavelengthModel::HalfSpace).unwrap();
    let critical = found.critical_strain;
    for multiple in [1.2_f64, 2.0, 4.0] {
        let expected = layer.thickness * (multiple - 1.0).sqrt();
        assert_close(found.amplitude(multiple * critical), expected, 1e-13, "A");
    }
    for strain in [critical, 0.5 * critical, 0.0, -0.1] {
        assert_eq!(found.amplitude(strain), 0.0);
    }
}

#[test]
fn strain_cap_is_smooth_and_bounded() {
    for strain in [-0.3, 0.0, 0.1, 0.15] {
        assert_eq!(capped_strain(strain), strain);
    }
    assert_close(
        capped_strain(0.25),
        0.15 + 0.1 * (1.0 - (-1.0_f64).exp()),
        1e-15,
        "cap",
    );
    assert!((capped_strain(f64::MAX) - 0.25).abs() < 1e-16);
    let step = 1e-6;
    let slope = (capped_strain(0.15 + step) - capped_strain(0.15 - step)) / (2.0 * step);
    assert!((slope - 1.0).abs() < 1e-5, "{slope}");
    for i in 0..100 {
        let strain = 0.01 * f64::from(i);
        assert!(capped_strain(strain + 0.01) > capped_strain(strain));
        assert!(capped_strain(strain) <= strain);
    }
}

#[test]
fn tension_across_takes_compression_away() {
    // A stretch of 4 % across cancels a whole epidermis threshold.
    assert!((effective_strain(0.0195, -0.04, 0.48) - 0.0003).abs() < 1e-15);
    assert_eq!(effective_strain(0.1, 0.05, 0.0), 0.1);
}

/// Positive numbers spread evenly over decades.
fn decades(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from..to).prop_map(|exponent| 10f64.powf(exponent))
}

/// Poisson ratios over their range, many of them very close to 0.5.
fn poisson_ratio() -> impl Strategy<Value = f64> {
    prop_oneof![
        -0.999..0.5_f64,
        decades(-14.0, -1.0).prop_map(|gap| 0.5 - gap)
    ]
}

prop_compose! {
    /// Modulus ratios 1 to 1e6, thickness ratios over ten decades.
    fn bonded_pair()(
        substrate_young in decades(1.0, 10.0),
        ratio in decades(0.0, 6.0),
        height in decades(-6.0, 1.0),
        thickness_ratio in decades(-7.0, 3.0),
        poisson in poisson_ratio(),
        substrate_poisson in poisson_ratio(),
    ) -> (LayerMaterial, Substrate) {
        let young = ratio * substrate_young;
        let layer =
            LayerMaterial { young, poisson, thickness: thickness_ratio * height, density: 1100.0 };
        let substrate =
            Substrate { young: substrate_young, poisson: substrate_poisson, thickness: height };
        (layer, substrate)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_other_wave_needs_less_force((layer, substrate) in bonded_pair()) {
        let found = wrinkling(&layer, &substrate, WavelengthModel::Layer).unwrap();
        let least = found.critical_force;
        let rounding = 1e-13;
        prop_assert!((force(&found, &substrate, found.wave_number) / least - 1.0).abs() < rounding);
        // Fifteen decades around it, 100 waves per decade.
        for i in -750..=750 {
            let wave_number = found.wave_number * 10f64.powf(0.01 * f64::from(i));
            let other = force(&found, &substrate, wave_number);
            prop_assert!(other > least * (1.0 - rounding), "k {wave_number}: {other} < {least}");
        }
    }

    /// The central difference of ln N in ln k is flat where N is: an error of 1e-8 in `k_c` fails.
    #[test]
    fn force_is_stationary((layer, substrate) in bonded_pair()) {
        let found = wrinkling(&layer, &substrate, WavelengthModel::Layer).unwrap();
        let step = 1e-5_f64;
        let above = force(&found, &substrate, found.wave_number * step.exp());
        let below = force(&found, &substrate, found.wave_number / step.exp());
        let slope = (above - below) / (2.0 * step * found.critical_force);
        // 1e-10 is rounding of N over the step; the curvature of ln N in ln k is at least 1.
        prop_assert!(slope.abs() < 3e-9, "{slope}");
    }

    #[test]
    fn scaling_all_lengths_scales_the_wave((layer, substrate) in bonded_pair(), factor in 0.1..10.0_f64) {
        let found = wrinkling(&layer, &substrate, WavelengthModel::Layer).unwrap();
        let scaled = wrinkling(
            &LayerMaterial { thickness: factor * layer.thickness, ..layer },
            &Substrate { thickness: factor * substrate.thickness, ..substrate },
            WavelengthModel::Layer,
        ).unwrap();
        prop_assert!((scaled.wavelength / (factor * found.wavelength) - 1.0).abs() < 1e-12);
        prop_assert!((scaled.critical_strain / found.critical_strain - 1.0).abs() < 1e-12);
    }
}
