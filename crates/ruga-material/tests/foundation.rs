//! The stiffness of a bonded layer: against 60-digit values of its closed form, and its limits.

mod skins;

use ruga_material::{Substrate, substrate_stiffness};
use skins::assert_close;

/// Stiffness for `E_s = 1 Pa`, `H = 1 m`.
fn unit_stiffness(poisson: f64, wave_number: f64) -> f64 {
    substrate_stiffness(
        wave_number,
        &Substrate {
            young: 1.0,
            poisson,
            thickness: 1.0,
        },
    )
}

#[test]
fn closed_form_to_the_last_digits() {
    // (Poisson ratio, kH, K H / E_s), the closed form of physics 1.3 evaluated with 60 digits.
    let references = [
        (-0.9, 1e-8, 6.785_714_285_714_287),
        (-0.9, 0.3, 6.930_339_506_738_935),
        (-0.9, 5.0, 28.797_455_365_231_42),
        (0.0, 1e-3, 1.000_000_125_000_003),
        (0.0, 0.99, 1.124_377_362_070_363_2),
        (0.0, 1.01, 1.129_491_855_267_334_3),
        (0.0, 300.0, 200.0),
        (0.3, 0.3, 1.340_163_710_678_812),
        (0.3, 24.0, 14.358_974_358_974_36),
        (0.48, 1e-3, 8.783_766_300_714_39),
        (0.48, 0.99, 3.435_308_231_285_468_6),
        (0.48, 26.0, 16.916_916_916_916_918),
        (0.4999, 0.3, 44.079_866_027_578_1),
        (0.499_999_999, 1e-8, 166_666_661.878_463_54),
        (0.499_999_999, 1e-3, 3_906_250.778_492_725),
        (0.499_999_999, 5.0, 3.351_881_847_401_221_3),
        (0.5, 1e-2, 40_000.800_012_190_48),
    ];
    for (poisson, x, expected) in references {
        assert_close(
            unit_stiffness(poisson, x),
            expected,
            5e-15,
            &format!("ν {poisson}, kH {x}"),
        );
    }
}

#[test]
fn long_waves_feel_the_confined_modulus() {
    for poisson in [-0.9, 0.0, 0.3, 0.48, 0.4999] {
        let confined = (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        for x in [0.0, 1e-300, 1e-8] {
            assert_close(
                unit_stiffness(poisson, x),
                confined,
                1e-10,
                &format!("ν {poisson}"),
            );
        }
    }
}

#[test]
fn a_thin_incompressible_layer_lubricates() {
    // 12 μ/(k² H³) with μ = E/3; the next term is of relative size (kH)².
    for x in [1e-6, 1e-4, 1e-2] {
        assert_close(
            unit_stiffness(0.5, x),
            4.0 / (x * x),
            0.3 * x * x + 1e-14,
            "ν 0.5",
        );
    }
    // Nearly incompressible: in between the confined modulus and the half-space.
    assert_close(
        unit_stiffness(0.5 - 1e-12, 1e-2),
        4e4,
        1e-4,
        "ν close to 0.5",
    );
}

#[test]
fn short_waves_feel_a_half_space() {
    for poisson in [-0.9, 0.0, 0.3, 0.48, 0.5] {
        let reduced = 1.0 / (1.0 - poisson * poisson);
        let slope = 2.0 * reduced * (1.0 - poisson) * (1.0 - poisson) / (3.0 - 4.0 * poisson);
        for x in [30.0, 1e3, 1e150, 1e300] {
            assert_close(
                unit_stiffness(poisson, x),
                slope * x,
                1e-14,
                &format!("ν {poisson}"),
            );
        }
        // Derived table: without shear at the interface E_s k/(2(1 - ν²)); 9 % more at 0.3, a third more
        // at 0, the same at 0.5.
        let bonded_over_free = slope / (0.5 * reduced);
        match poisson {
            0.0 => assert_close(bonded_over_free, 4.0 / 3.0, 1e-15, "ν 0"),
            0.3 => assert_close(bonded_over_free, 1.09, 2e-3, "ν 0.3"),
            0.5 => assert_close(bonded_over_free, 1.0, 1e-15, "ν 0.5"),
            _ => {}
        }
    }
}

#[test]
fn stiffness_scales_with_modulus_and_thickness() {
    let (young, height) = (0.5e6, 15e-3);
    let substrate = Substrate {
        young,
        poisson: 0.48,
        thickness: height,
    };
    for x in [0.1, 1.0, 10.0] {
        let found = substrate_stiffness(x / height, &substrate);
        assert_close(
            found,
            unit_stiffness(0.48, x) * young / height,
            1e-14,
            "scaling",
        );
    }
}
