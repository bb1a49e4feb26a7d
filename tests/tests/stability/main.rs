//! The stability suite: where methods for wrinkling skin fail, what the papers' method does there
//! and what ruga does. `cargo xtask stability` prints the findings as a table.
//!
//! The papers' method is what stands in the papers: low-pass rows alone, sampled by area or
//! adjusted as printed, Newton on the norm of the forces or with MINRES, one load step.

mod extremes;
mod heterogeneous;
mod invariance;
mod loads;
mod meshes;
mod range;
mod rows;
mod starts;

use nalgebra::Vector3;
use ruga_solver::NewtonSettings;
use ruga_stepper::{LayerSpec, Modelling, Plan, PoseResult, Silent, plan, simulate};
use ruga_tests::{FilmCoupling, FilmSpec, Patch, Sheet, SheetSpec, Strip, skin_layer};

/// Energies to a ten-thousandth of the gap.
fn exact() -> NewtonSettings {
    NewtonSettings {
        energy_tolerance: 1e-9,
        ..NewtonSettings::default()
    }
}

/// The papers' coupling: a hex lattice of averages that lets the critical wavelength through.
fn rows_alone() -> FilmSpec {
    FilmSpec {
        coupling: FilmCoupling::Constraint(1.0 / 3.0_f64.sqrt()),
        ..FilmSpec::flat(150.0)
    }
}

/// Moves the base under a flat film to `load` critical strains.
fn compress(sheet: &mut Sheet, spec: &FilmSpec, strip: &Strip, load: f64) {
    let strain = load * spec.theory().critical_strain;
    let normals = spec.base.normals(strip, strain);
    sheet.lay_on(spec.base.points(strip, strain), &normals);
}

/// A flat film laid on a base at `load` critical strains, with noise of so many thicknesses.
fn compressed(spec: &FilmSpec, strip: &Strip, load: f64, noise: f64, seed: u64) -> Sheet {
    let mut sheet = Sheet::new(SheetSpec::film(spec, strip));
    compress(&mut sheet, spec, strip, load);
    sheet.lie_down(Vector3::z(), noise, seed);
    sheet
}

/// A flat patch of skin of four by two wavelengths, as the product takes it.
fn patch(compression: f64) -> Patch {
    Patch {
        length: 0.04,
        width: 0.02,
        compression,
    }
}

/// The skin on it.
fn skin() -> LayerSpec {
    skin_layer("skin", "forehead-furrow")
}

/// Draft quality.
fn draft() -> Modelling {
    Modelling {
        points_per_wavelength: 6.0,
        ..Modelling::default()
    }
}

/// What the planner says of a patch.
fn planned(patch: &Patch, layer: &LayerSpec, modelling: &Modelling) -> Plan {
    let driver = patch.driver();
    let poses = [patch.pose(&driver, 1)];
    let layers = std::slice::from_ref(layer);
    plan(&driver, layers, &poses, modelling, 1024).expect("a patch that can be planned")
}

/// What the stepper makes of a patch in `steps` load steps.
fn simulated(patch: &Patch, layer: &LayerSpec, modelling: &Modelling, steps: u32) -> PoseResult {
    let driver = patch.driver();
    let pose = patch.pose(&driver, steps);
    let (layers, poses) = (std::slice::from_ref(layer), std::slice::from_ref(&pose));
    let plan = plan(&driver, layers, poses, modelling, 1024).expect("a patch that can be planned");
    simulate(&driver, &plan, 0, &pose, modelling, &mut Silent).expect("a patch")
}
