//! The numbers of the two papers and of the presets, to their printed digits.

mod skins;

use std::f64::consts::{PI, TAU};

use ruga_material::{
    LayerMaterial, PRESETS, Substrate, WavelengthModel, Wrinkling, preset, wrinkling,
};
use skins::{assert_close, assert_prints};

fn layer(young: f64, poisson: f64, thickness: f64) -> LayerMaterial {
    LayerMaterial {
        young,
        poisson,
        thickness,
        density: 1100.0,
    }
}

fn solve(layer: &LayerMaterial, substrate: &Substrate, model: WavelengthModel) -> Wrinkling {
    wrinkling(layer, substrate, model).expect("the parameters are valid")
}

/// Rémillard and Kry 2013, table 1: (h, E_x/E_q, λ as printed, λ exact).
const REMILLARD_KRY: [(f64, f64, f64, f64); 7] = [
    (0.0002, 1e2, 0.00404, 0.004_044),
    (0.0004, 1e2, 0.00808, 0.008_088),
    (0.0005, 1e2, 0.01010, 0.010_111),
    (0.0007, 1e4, 0.06566, 0.065_701),
    (0.0010, 1e2, 0.02021, 0.020_221),
    (0.0001, 1e2, 0.00202, 0.002_022),
    (0.0002, 1e3, 0.00870, 0.008_713),
];

/// The table was made with π = 3.14, and cut rather than rounded.
const COARSE_PI: f64 = 314.0 / 100.0;

#[test]
fn remillard_kry_table_1() {
    for poisson in [0.0, 0.3, 0.48] {
        for (thickness, ratio, printed, exact) in REMILLARD_KRY {
            let substrate = Substrate {
                young: 1e4,
                poisson,
                thickness: 0.5,
            };
            let skin = layer(ratio * substrate.young, poisson, thickness);
            let found = solve(&skin, &substrate, WavelengthModel::HalfSpace).wavelength;
            assert_prints(found, exact, 1e-6, "exact");
            let cut = (found * COARSE_PI / PI * 1e5).floor() / 1e5;
            assert_close(cut, printed, 1e-12, "table");
        }
    }
}

/// A layer on an all but incompressible substrate whose thickness is `k_inf_h` over the half-space's
/// critical wave number.
fn on_incompressible(k_inf_h: f64) -> (LayerMaterial, Substrate) {
    let skin = layer(1e8, 0.48, 1e-3);
    let mut substrate = Substrate {
        young: 1e4,
        poisson: 0.5 - 1e-12,
        thickness: 1.0,
    };
    let half_space = solve(&skin, &substrate, WavelengthModel::HalfSpace);
    substrate.thickness = k_inf_h / half_space.wave_number;
    (skin, substrate)
}

#[test]
fn finite_thickness_against_half_space_and_cerda_mahadevan() {
    // (k_inf H, λ/λ_half-space, ε_c/ε_half-space, digit of the latter, λ_Cerda-Mahadevan/λ)
    let table = [
        (0.2, 0.261, 7.51, 0.01, 1.01),
        (0.5, 0.407, 3.22, 0.01, 1.02),
        (1.0, 0.562, 1.83, 0.01, 1.05),
        (1.5, 0.673, 1.40, 0.01, 1.07),
        (2.0, 0.759, 1.21, 0.01, 1.10),
        (3.0, 0.881, 1.06, 0.01, 1.16),
        (4.0, 0.952, 1.015, 0.001, 1.24),
        (6.0, 0.996, 1.001, 0.001, 1.45),
    ];
    for (k_inf_h, wavelength, strain, digit, cerda) in table {
        let (skin, substrate) = on_incompressible(k_inf_h);
        let exact = solve(&skin, &substrate, WavelengthModel::Layer);
        let half_space = solve(&skin, &substrate, WavelengthModel::HalfSpace);
        let thin = solve(&skin, &substrate, WavelengthModel::CerdaMahadevan);
        let at = format!("k_inf H = {k_inf_h}");
        assert_prints(
            exact.wavelength / half_space.wavelength,
            wavelength,
            1e-3,
            &at,
        );
        assert_prints(
            exact.critical_strain / half_space.critical_strain,
            strain,
            digit,
            &at,
        );
        assert_prints(thin.wavelength / exact.wavelength, cerda, 0.01, &at);
    }
}

#[test]
fn cerda_mahadevan_prefactor() {
    let substrate = Substrate {
        young: 1e4,
        poisson: 0.4,
        thickness: 3e-3,
    };
    let half = 0.5 - 1e-12;
    for (poisson, prefactor) in [(0.0, 2.936), (0.3, 2.983), (0.45, 3.049), (half, 3.081)] {
        let skin = layer(7e6, poisson, 1e-4);
        let found = solve(&skin, &substrate, WavelengthModel::CerdaMahadevan).wavelength;
        let length = (skin.thickness * substrate.thickness).sqrt();
        let scale = length * (skin.young / substrate.young).powf(1.0 / 6.0);
        assert_prints(found / scale, prefactor, 1e-3, "prefactor");
    }
}

#[test]
fn thin_compressible_substrate_follows_the_quarter_power() {
    let skin = layer(1e8, 0.3, 1e-3);
    let substrate = Substrate {
        young: 1e4,
        poisson: 0.3,
        thickness: 1e-6,
    };
    let confined = substrate.young * 0.7 / (1.3 * 0.4);
    let expected = TAU * (skin.bending_stiffness() * substrate.thickness / confined).powf(0.25);
    let found = solve(&skin, &substrate, WavelengthModel::Layer);
    assert_close(found.wavelength, expected, 1e-6, "λ");
}

/// Derived table, the rows that a soft foundation can have: `N_c/(D k²)` and `12 ε_c/(k h)²` for
/// `K ~ k^p`.
#[test]
fn critical_force_for_each_power_of_the_foundation() {
    let skin = layer(1e8, 0.3, 1e-4);
    let thick = Substrate {
        young: 1e4,
        poisson: 0.3,
        thickness: 1.0,
    };
    let thin = Substrate {
        thickness: 1e-7,
        ..thick
    };
    let cases = [
        (thick, WavelengthModel::HalfSpace, 3.0, 4.0),
        (thick, WavelengthModel::Layer, 3.0, 4.0),
        (thin, WavelengthModel::Layer, 2.0, 6.0),
        (thin, WavelengthModel::CerdaMahadevan, 1.5, 8.0),
    ];
    for (substrate, model, force_ratio, divisor) in cases {
        let found = solve(&skin, &substrate, model);
        let bending_force = found.bending_stiffness * found.wave_number.powi(2);
        assert_close(
            found.critical_force / bending_force,
            force_ratio,
            1e-6,
            model.name(),
        );
        let kh = found.wave_number * skin.thickness;
        assert_close(found.critical_strain, kh * kh / divisor, 1e-6, model.name());
    }
    let incompressible = Substrate {
        poisson: 0.5 - 1e-15,
        thickness: 1e-5,
        ..thick
    };
    let found = solve(&skin, &incompressible, WavelengthModel::Layer);
    let bending_force = found.bending_stiffness * found.wave_number.powi(2);
    assert_close(
        found.critical_force / bending_force,
        1.5,
        1e-3,
        "incompressible",
    );
}

/// Derived table, in mm: half-space, exact, Cerda-Mahadevan (ν 0.48), exact strain.
#[test]
fn thesis_parameters() {
    // Without shear at its upper face the dermis' layer would give 11.33; bonded, as here, 60-digit
    // arithmetic gives 11.3204.
    let cases = [
        ("reference-epidermis", 2.78, 2.46, 2.79, 0.0195, 1e-4),
        ("reference-dermis", 11.33, 11.32, 19.2, 0.130, 1e-3),
    ];
    for (name, half_space, exact, cerda, strain, strain_digit) in cases {
        let pair = preset(name).unwrap();
        let millimetres = |model| 1e3 * solve(&pair.layer, &pair.substrate, model).wavelength;
        assert_prints(
            millimetres(WavelengthModel::HalfSpace),
            half_space,
            0.01,
            name,
        );
        assert_prints(millimetres(WavelengthModel::Layer), exact, 0.01, name);
        let digit = if cerda > 10.0 { 0.1 } else { 0.01 };
        assert_prints(
            millimetres(WavelengthModel::CerdaMahadevan),
            cerda,
            digit,
            name,
        );
        let found = solve(&pair.layer, &pair.substrate, WavelengthModel::Layer);
        assert_prints(found.critical_strain, strain, strain_digit, name);
    }
}

/// Derived table, how far the Poisson ratio of the substrate moves the exact wavelength (mm).
#[test]
fn thesis_parameters_for_other_substrates() {
    // For the dermis at 0.3 a shear-free interface gives 12.0; bonded it is 11.64.
    let cases = [
        ("reference-epidermis", 0.5 - 1e-12, 2.42, 0.01),
        ("reference-epidermis", 0.3, 2.65, 0.01),
        ("reference-dermis", 0.5 - 1e-12, 11.2, 0.1),
        ("reference-dermis", 0.3, 11.64, 0.01),
    ];
    for (name, poisson, printed, digit) in cases {
        let pair = preset(name).unwrap();
        let substrate = Substrate {
            poisson,
            ..pair.substrate
        };
        let found = solve(&pair.layer, &substrate, WavelengthModel::Layer);
        assert_prints(1e3 * found.wavelength, printed, digit, name);
    }
}

/// Layers 1.4: (name, λ mm, its digit, ε_c %, K0 MPa/mm, K1 N/mm, with the digits of the last two).
#[test]
fn presets_print_their_table() {
    let table = [
        (
            "reference-dermis",
            11.3,
            0.1,
            13.0,
            0.1,
            0.0903,
            1e-4,
            0.293,
            1e-3,
        ),
        (
            "reference-epidermis",
            2.46,
            0.01,
            1.95,
            0.01,
            4.80,
            1e-2,
            0.356,
            1e-3,
        ),
        (
            "forehead-furrow",
            10.3,
            0.1,
            4.5,
            0.1,
            0.00419,
            1e-5,
            0.0102,
            1e-4,
        ),
        ("cheek", 8.1, 0.1, 5.4, 0.1, 0.00504, 1e-5, 0.0084, 1e-4),
        ("neck", 12.3, 0.1, 4.2, 0.1, 0.00539, 1e-5, 0.00755, 1e-5),
        (
            "crows-feet",
            2.9,
            0.1,
            4.7,
            0.1,
            0.0523,
            1e-4,
            0.00507,
            1e-5,
        ),
        ("knuckle", 4.7, 0.1, 5.1, 0.1, 0.0308, 1e-4, 0.0127, 1e-4),
        ("eyelid", 1.4, 0.1, 4.6, 0.1, 0.0383, 1e-4, 0.00114, 1e-5),
        ("fine-lines", 0.80, 0.01, 3.8, 0.1, 1.53, 1e-2, 0.0249, 1e-4),
    ];
    for (name, wavelength, wave_digit, strain, strain_digit, k0, k0_digit, k1, k1_digit) in table {
        let pair = preset(name).unwrap();
        let found = solve(&pair.layer, &pair.substrate, WavelengthModel::Layer);
        assert_prints(1e3 * found.wavelength, wavelength, wave_digit, name);
        assert_prints(100.0 * found.critical_strain, strain, strain_digit, name);
        assert_prints(1e-9 * found.normal_stiffness, k0, k0_digit, name);
        assert_prints(1e-3 * found.gradient_stiffness, k1, k1_digit, name);
    }
    for (name, wavelength, wave_digit, strain) in [
        ("face2-dermis", 10.0, 0.1, 9.7),
        ("face2-epidermis", 0.78, 0.01, 4.0),
    ] {
        let pair = preset(name).unwrap();
        let found = solve(&pair.layer, &pair.substrate, WavelengthModel::Layer);
        assert_prints(1e3 * found.wavelength, wavelength, wave_digit, name);
        assert_prints(100.0 * found.critical_strain, strain, 0.1, name);
    }
}

#[test]
fn preset_names_are_unique_and_found() {
    for one in &PRESETS {
        assert!(
            one.name
                .bytes()
                .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-')
        );
        assert_eq!(
            PRESETS
                .iter()
                .filter(|other| other.name == one.name)
                .count(),
            1
        );
        assert_eq!(preset(one.name), Some(one));
        assert!(!one.description.is_empty());
        assert_eq!(one.layer.validate().and(one.substrate.validate()), Ok(()));
    }
    assert_eq!(preset("Forehead furrow"), None);
    let (dermis, epidermis) = (&PRESETS[0], &PRESETS[1]);
    assert_eq!(dermis.layer.as_substrate(), epidermis.substrate);
}
