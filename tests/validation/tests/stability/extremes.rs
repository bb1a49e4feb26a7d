//! T11: materials far from each other.

use ruga_material::{LayerMaterial, MaterialError, Substrate, WavelengthModel, preset, wrinkling};
use ruga_stepper::LayerSpec;
use ruga_validation::{Finding, FlatFilm, table_line};

use crate::{draft, patch, planned, simulated, skin};

const TEST: &str = "T11 modulus ratio 3 to 1e7, nu 0 to 0.5";

/// Wavelength and amplitude over theory's at 1.5 critical strains.
fn at_ratio(ratio: f64, poisson: f64) -> [f64; 2] {
    let mut film = FlatFilm {
        waves: [4.0, 5.0],
        load: 2.0,
        ..FlatFilm::new(ratio)
    };
    film.layer.material.poisson = poisson;
    film.layer.substrate.poisson = poisson;
    let (_, states) = film.states(&draft(), &[1.5, 2.0]);
    [states[0].relative_wavelength, states[0].relative_amplitude]
}

#[test]
fn t11_extreme_materials() {
    let dermis = preset("forehead-furrow").expect("a preset");
    let wave = |model| {
        let numbers = wrinkling(&dermis.layer, &dermis.substrate, model);
        numbers.expect("a wavelength").wavelength
    };
    let ratio = wave(WavelengthModel::CerdaMahadevan) / wave(WavelengthModel::Layer);
    assert!(ratio > 1.1, "{ratio}");
    let numbers =
        format!("thin-substrate formula on a thick one: lam {ratio:.2} of the bonded layer's");
    table_line(TEST, "papers: Cerda-Mahadevan", Finding::Fails, &numbers);

    // 1e7 is a thickness of a thousandth of the wavelength.
    for ratio in [1e2, 1e4, 1e7] {
        for poisson in [0.0, 0.4999] {
            let [wavelength, amplitude] = at_ratio(ratio, poisson);
            assert!((wavelength - 1.0).abs() < 0.04, "{wavelength}");
            assert!(
                (amplitude - 1.0).abs() < 0.1,
                "{ratio} {poisson}: {amplitude}"
            );
        }
    }
    let numbers = "ratio 1e2 to 1e7 (h/lam 1e-3), nu 0 and 0.4999: lam within 4 %, A within 10 %";
    table_line(TEST, "ruga: stiff film", Finding::Holds, numbers);

    let Substrate { young, .. } = dermis.substrate;
    let bad = LayerMaterial {
        young,
        poisson: 0.5,
        ..dermis.layer
    };
    let refusal = wrinkling(&bad, &dermis.substrate, WavelengthModel::Layer);
    assert!(matches!(
        refusal,
        Err(MaterialError::PoissonOutOfRange { .. })
    ));
    table_line(
        TEST,
        "ruga: nu 0.5",
        Finding::Warns,
        "refused with the accepted range",
    );
}

/// St. Venant-Kirchhoff's force has a maximum of `C / (3 sqrt 3)` and cannot reach a critical
/// force above that, `0.19 C`; and the stepper caps strain at 0.25.
#[test]
fn t11_films_as_soft_as_their_base() {
    let mut soft = LayerSpec { ..skin() };
    soft.material.young = 5.0 * soft.substrate.young;
    let numbers = wrinkling(&soft.material, &soft.substrate, soft.model);
    let critical = numbers.expect("a wavelength").critical_strain;
    assert!((0.15..0.2).contains(&critical));
    let result = simulated(&patch(0.3), &soft, &draft(), 4);
    let warnings = planned(&patch(0.3), &soft, &draft()).warnings;
    assert!(result.converged && result.layers[0].wavelength.is_none());
    assert!(
        warnings.iter().any(|w| w.contains("late or not at all")),
        "{warnings:?}"
    );
    let numbers = format!("eps_c {critical:.2}, pressed by 0.30: stays smooth, and says why");
    table_line(
        TEST,
        "ruga: film as soft as its base",
        Finding::Warns,
        &numbers,
    );

    soft.material.young = 0.4 * soft.substrate.young;
    let numbers = wrinkling(&soft.material, &soft.substrate, soft.model).expect("a wavelength");
    let thickness = soft.material.thickness / numbers.wavelength;
    assert!(thickness > 0.3, "{thickness}");
    let plan = planned(&patch(0.4), &soft, &draft());
    assert_eq!(plan.poses[0].layers[0].active_area, 0.0);
    let numbers = format!(
        "eps_c {:.2}: planned as what cannot wrinkle at 40 %, not simulated",
        numbers.critical_strain
    );
    table_line(TEST, "ruga: h/lam 0.3", Finding::Holds, &numbers);
}
