//! Creases in films and in paper, as the product's energies and solver fold them, against theory.

mod depth;
mod lines;
mod paper;
mod virtual_nodes;

use std::f64::consts::TAU;

use ruga_material::Wrinkling;
use ruga_mesh::{EdgeId, TriMesh};
use ruga_shell::FaceParameters;
use ruga_solver::NewtonSettings;

/// Forces to a ten-thousandth of what the comparison is about.
fn exact() -> NewtonSettings {
    NewtonSettings {
        energy_tolerance: 1e-10,
        ..NewtonSettings::default()
    }
}

/// A film of unit wavelength and bending modulus on a foundation without `K1`, with this critical strain, and
/// its thickness.
fn film(critical_strain: f64) -> (Wrinkling, f64) {
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
fn film_face((theory, thickness): (&Wrinkling, f64)) -> FaceParameters {
    FaceParameters {
        young: theory.membrane_stiffness / thickness,
        poisson: 0.0,
        thickness,
        normal_stiffness: theory.normal_stiffness,
        gradient_stiffness: 0.0,
    }
}

/// Inner edges whose two ends are both in a set of vertices.
fn edges_within(mesh: &TriMesh, is_in: impl Fn(u32) -> bool) -> Vec<EdgeId> {
    let edges = mesh.edges().iter();
    let inside =
        edges.filter(|(_, edge)| !edge.is_border() && edge.vertices.iter().all(|v| is_in(v.0)));
    inside.map(|(id, _)| id).collect()
}
