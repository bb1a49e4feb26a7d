//! A film in units of itself.

use std::f64::consts::TAU;

use ruga_material::Wrinkling;
use ruga_shell::FaceParameters;

/// A film of unit wavelength and bending modulus on a foundation without `K1`, with this critical strain, and
/// its thickness.
pub fn unit_film(critical_strain: f64) -> (Wrinkling, f64) {
    let k = TAU;
    let membrane = 2.0 * k * k / critical_strain;
    let theory = Wrinkling {
        wavelength: 1.0,
        wave_number: k,
        critical_strain,
        critical_force: 2.0 * k * k,
        bending_stiffness: 1.0,
        membrane_stiffness: membrane,
        normal_stiffness: k.powi(4),
        gradient_stiffness: 0.0,
        tangential_stiffness: 2.0 * k.powi(4),
    };
    (theory, (12.0 / membrane).sqrt())
}

/// Faces of such a film.
pub fn unit_face((theory, thickness): (&Wrinkling, f64)) -> FaceParameters {
    FaceParameters {
        young: theory.membrane_stiffness / thickness,
        poisson: 0.0,
        thickness,
        normal_stiffness: theory.normal_stiffness,
        gradient_stiffness: 0.0,
    }
}
