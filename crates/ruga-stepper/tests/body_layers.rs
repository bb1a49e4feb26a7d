//! Two layers on a soft body: each wrinkles as it would alone.

mod bodies;

use bodies::{free_body, layer, modelling, pose, push, slab, slice, top};
use nalgebra::Vector3;
use ruga_stepper::{Silent, plan_body};

const SIZE: Vector3<f64> = Vector3::new(0.08, 0.02, 0.02);

/// A lower layer with waves of a centimetre, and on it one a quarter as thick.
#[test]
fn two_layers_wrinkle_at_both_wavelengths() {
    let driver = slab(SIZE, [16, 4, 4], |p| p);
    let lower = layer(150.0);
    let mut upper = layer(150.0);
    upper.name = "fine".into();
    upper.material.thickness *= 0.25;
    let mut body = free_body(8);
    body.handles = vec![slice("left", -1.0, 0.01), slice("right", 0.07, 1.0)];
    let mut modelling = modelling(6.0);
    modelling.region = top();
    let way = Vector3::x() * (0.03 * 0.04);
    let motions = vec![push("left", way), push("right", -way)];
    let poses = [pose(motions, &[1.0], 2)];
    let plan = plan_body(&driver, &[lower, upper], &body, &poses, &modelling, 2048);
    let plan = plan.expect("two layers on a slab");
    let result = plan.simulate(0, &mut Silent).expect("a run");
    assert!(result.converged, "{:?}", result.warnings);
    assert_eq!(result.keys[0].layers.len(), 2);
    for (report, planned) in result.layers.iter().zip(&plan.poses[0].layers) {
        let length = report.wavelength.expect("wrinkles") / planned.wavelength;
        assert!((0.85..1.15).contains(&length), "{}: {length}", report.name);
        assert!(report.amplitude > 0.02 * planned.wavelength, "{report:?}");
    }
    // Both surfaces stand where the body has gone, the upper one above the lower.
    let [lower, upper] = [0, 1].map(|k| &result.keys[0].layers[k]);
    assert!(lower.offset == 0.0 && upper.offset > 0.0);
}
