//! Creases in films and in paper, as the product's energies and solver fold them, against theory.

mod depth;
mod lines;
mod paper;
mod virtual_nodes;

use ruga_solver::NewtonSettings;

/// Forces to a ten-thousandth of what the comparison is about.
fn exact() -> NewtonSettings {
    NewtonSettings {
        energy_tolerance: 1e-10,
        ..NewtonSettings::default()
    }
}
