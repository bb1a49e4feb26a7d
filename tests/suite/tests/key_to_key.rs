//! An upper layer that goes on from one key to the next, on a mesh fitted anew.

use ruga_stepper::{LayerReport, LayerSpec, Modelling, PoseResult, Silent, plan};
use ruga_validation::{Patch, skin_layer};

/// The thesis' two layers on a small patch, compressed by 10 %: the lower one stays flat.
fn run(keys: &[f64]) -> PoseResult {
    let patch = Patch {
        length: 30e-3,
        width: 16e-3,
        compression: 0.1,
    };
    let driver = patch.driver();
    let lower = skin_layer("reference-dermis", "reference-dermis");
    let upper = LayerSpec {
        substrate: lower.material.as_substrate(),
        ..skin_layer("reference-epidermis", "reference-epidermis")
    };
    let mut pose = patch.pose(&driver, 2);
    pose.keys = keys.to_vec();
    let poses = [pose];
    let modelling = Modelling {
        points_per_wavelength: 6.0,
        region: ruga_stepper::Region::All,
        ..Modelling::default()
    };
    let plan = plan(&driver, &[lower, upper], &poses, &modelling, 1024).expect("a plan");
    let result = plan.simulate(0, &mut Silent);
    result.expect("two layers that can be simulated")
}

fn slope(layer: &LayerReport) -> f64 {
    layer.amplitude / layer.wavelength.expect("wrinkles")
}

/// Flat at the first key on a coarse mesh, wrinkled at the next, deeper at the last.
#[test]
fn keys_on_the_way_do_not_change_the_last() {
    let [direct, through] = [&[1.0][..], &[0.1, 0.6, 1.0]].map(run);
    assert!(direct.converged && through.converged);
    assert_eq!(through.keys.len(), 3);
    let vertices = |key: usize| through.keys[key].layers[1].computed.positions.len();
    assert!(vertices(0) < vertices(1), "fitted anew where it wrinkles");
    assert_eq!(vertices(1), vertices(2), "the mesh still serves");
    let [direct, through] = [&direct, &through].map(|result| &result.layers[1]);
    let wavelength = through.wavelength.expect("wrinkles") / through.wavelength_predicted;
    assert!((wavelength - 1.0).abs() < 0.15, "{wavelength}");
    for (what, through, direct) in [
        ("energy", through.energy, direct.energy),
        // Half a wave more or less in the patch changes height and length alike.
        ("slope", slope(through), slope(direct)),
    ] {
        let ratio = through / direct;
        assert!((ratio - 1.0).abs() < 0.03, "{what} {ratio}");
    }
}

/// What lies between keys changes nothing from run to run.
#[test]
fn going_on_is_deterministic() {
    let [a, b] = [0, 1].map(|_| run(&[0.4, 0.7]));
    let positions = |result: &PoseResult| result.keys[1].layers[1].positions.clone();
    assert_eq!(positions(&a), positions(&b));
}
