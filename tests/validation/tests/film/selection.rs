//! The film chooses its own wavelength, whatever its thickness and stiffness.

use ruga_stepper::Modelling;
use ruga_validation::FlatFilm;

/// Wavelength (m) at 1.5 critical strains, less what finite strain adds to that of theory.
fn wavelength(film: &FlatFilm) -> f64 {
    let (_, states) = film.states(&Modelling::standard(), &[1.5, 2.0]);
    let theory = film.theory();
    states[0].relative_wavelength * theory.wavelength / (1.0 + theory.critical_strain / 3.0)
}

/// Li 2014, fig. 3-3: a quarter of the thickness, 64 times the modulus.
#[test]
fn wavelength_scales_with_thickness_and_cube_root_of_modulus() {
    let film = FlatFilm {
        load: 2.0,
        ..FlatFilm::new(20.0)
    };
    let (mut thin, mut stiff) = (film.clone(), film.clone());
    thin.layer.material.thickness /= 4.0;
    stiff.layer.material.young *= 64.0;
    let reference = wavelength(&film);
    let [quarter, fourfold] = [thin, stiff].map(|film| wavelength(&film) / reference);
    println!("thickness / 4: {quarter:.4}; modulus x 64: {fourfold:.3}");
    assert!((4.0 * quarter - 1.0).abs() < 0.02);
    assert!((fourfold / 4.0 - 1.0).abs() < 0.04);
}
