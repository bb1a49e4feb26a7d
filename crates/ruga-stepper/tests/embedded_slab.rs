//! A soft slab that is pushed together: its layer wrinkles as theory says.

mod bodies;

use bodies::{compression, free_body, layer, modelling, pose, push, slab, slice, top};
use nalgebra::Vector3;
use ruga_material::WavelengthModel;
use ruga_stepper::{Coupling, PoseResult, Silent, plan_body, simulate_body};

const SIZE: Vector3<f64> = Vector3::new(0.08, 0.03, 0.02);

/// The slab, eight wavelengths long, held at both ends and pushed together; with the effective
/// strain of its surface in the middle at the end.
fn pushed(coupling: Coupling, points: f64) -> (PoseResult, f64) {
    let driver = slab(SIZE, [16, 6, 4], |p| p);
    let mut spec = layer(150.0);
    spec.coupling = coupling;
    let mut body = free_body(8);
    body.handles = vec![slice("left", -1.0, 0.01), slice("right", 0.07, 1.0)];
    let mut modelling = modelling(points);
    modelling.region = top();
    let plan = plan_body(&driver, &spec, &body, &modelling).expect("a closed slab");
    assert!((plan.wavelength - 0.01).abs() < 1e-12);
    assert_eq!(plan.cells, 8 * 3 * 2);
    assert_eq!(plan.nodes, 10 * 5 * 4);
    assert!((plan.edge - plan.wavelength / points).abs() < 1e-12);
    let way = Vector3::x() * (0.03 * 1.8 * plan.critical_strain);
    let motions = vec![push("left", way), push("right", -way)];
    let pose = pose(motions, &[1.0], 2);
    let result = simulate_body(&driver, &plan, &pose, &modelling, &mut Silent).expect("a run");
    assert!(result.converged, "{:?}", result.warnings);
    let found = result.layers[0].vertices as f64 / plan.vertices as f64;
    assert!((0.8..1.25).contains(&found), "{found} of what was planned");
    let now = result.keys[0].artist_positions.as_ref().expect("a body");
    let strain = |from: [f64; 2], to: [f64; 2]| {
        let at = |[x, y]: [f64; 2]| Vector3::new(x, y, SIZE.z);
        compression(&driver, now, [at(from), at(to)])
    };
    let along = strain([0.03, 0.015], [0.05, 0.015]);
    let across = strain([0.04, 0.01], [0.04, 0.02]);
    // The inside bulges, which takes from what compresses the layer.
    assert!(across < -0.03 * along, "{along} {across}");
    (result, along + spec.material.poisson * across)
}

#[test]
fn wrinkles_have_the_length_the_height_and_the_onset_of_theory() {
    let (result, strain) = pushed(Coupling::Hybrid, 8.0);
    let spec = layer(150.0);
    let model = WavelengthModel::HalfSpace;
    let theory = ruga_material::wrinkling(&spec.material, &spec.substrate, model);
    let theory = theory.expect("a material");
    let report = &result.layers[0];
    let wavelength = report.wavelength.expect("wrinkles") / theory.wavelength;
    assert!((0.9..1.1).contains(&wavelength), "{wavelength}");
    // A layer that ends has less to bear there than what lies below it, by shear lag.
    let onset = report.onset_load.expect("an onset") * strain / theory.critical_strain;
    assert!((0.9..1.25).contains(&onset), "{onset}");
    let amplitude = report.amplitude / theory.amplitude(strain);
    assert!((0.75..1.1).contains(&amplitude), "{amplitude}");
}

/// The papers' rows alone buckle far too early, at a length that is theirs, as on a given surface.
#[test]
fn rows_alone_buckle_early() {
    let [hybrid, rows] = [Coupling::Hybrid, Coupling::Constraint].map(|coupling| {
        let (result, _) = pushed(coupling, 6.0);
        result.layers[0].clone()
    });
    let [late, early] = [&hybrid, &rows].map(|report| report.onset_load.expect("an onset"));
    assert!(early < 0.75 * late, "{early} {late}");
    assert!(rows.constraints > 4 * hybrid.constraints);
}
