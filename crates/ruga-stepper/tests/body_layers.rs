//! Layers on a soft body: two of which each wrinkles as it would alone, and one with a crease.

mod bodies;

use std::sync::Arc;

use bodies::{free_body, layer, modelling, pose, push, slab, slice, top};
use nalgebra::{Vector2, Vector3};
use ruga_blend::Driver;
use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, LineTracer};
use ruga_stepper::{CreaseSpec, FoldSense, LayerSpec, Plan, Silent, plan_body};

const SIZE: Vector3<f64> = Vector3::new(0.08, 0.02, 0.02);

/// The plan of layers on the top of the slab, whose ends handles push by a way (m) each, with so many cells along it.
fn pressed(driver: &Arc<Driver>, layers: &[LayerSpec], (cells, way): (u32, f64)) -> Plan {
    let mut body = free_body(cells);
    body.handles = vec![slice("left", -1.0, 0.01), slice("right", 0.07, 1.0)];
    let mut modelling = modelling(6.0);
    modelling.region = top();
    let way = Vector3::x() * way;
    let motions = vec![push("left", way), push("right", -way)];
    let poses = [pose(motions, &[1.0], 2)];
    plan_body(driver, layers, &body, &poses, &modelling, 2048).expect("layers on a slab")
}

/// A lower layer with waves of a centimetre, and on it one a quarter as thick.
#[test]
fn two_layers_wrinkle_at_both_wavelengths() {
    let driver = slab(SIZE, [16, 4, 4], |p| p);
    let lower = layer(150.0);
    let mut upper = layer(150.0);
    upper.name = "fine".into();
    upper.material.thickness *= 0.25;
    let plan = pressed(&driver, &[lower, upper], (8, 0.03 * 0.04));
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

/// Pressed to about what wrinkles it, a layer on a body folds along a soft line across it that is drawn a little,
/// and along no other.
#[test]
fn a_soft_line_folds_on_a_body() {
    let driver = slab(SIZE, [16, 4, 4], |p| p);
    let mut skin = layer(150.0);
    let tracer = LineTracer::new(driver.topology(), driver.rest()).with_uvs(driver.uvs());
    let line = tracer.trace(&LineInput::Uv {
        points: [0.05, 0.95].map(|v| Vector2::new(0.24, v)).to_vec(),
        is_closed: false,
        corners: Corners::Keep,
    });
    skin.creases = vec![CreaseSpec {
        name: "line".into(),
        line: line.expect("a line on the top"),
        law: LineLaw {
            width: skin.material.thickness,
            stiffness: 0.01,
            angle: 10_f64.to_radians(),
            fade: [2e-3; 2],
        },
        is_ridge: false,
        sense: FoldSense::Valley,
        drive: Drive::Load,
        anchor: None,
        slit: None,
        memory: CreaseMemory::default(),
        absorbs: false,
    }];
    let plan = pressed(&driver, &[skin], (6, 0.02 * 0.03));
    let result = plan.simulate(0, &mut Silent).expect("a run");
    assert!(result.converged, "{:?}", result.warnings);
    let crease = &result.layers[0].creases[0];
    println!("{crease:?}");
    assert!(crease.fold > 0.1, "{crease:?}");
    let surface = &result.keys[0].layers[0];
    let depths = surface.driver_positions.iter().zip(&surface.positions);
    let depths = depths.map(|(p, x)| (p.x, p.z - x.z));
    let deepest = depths.max_by(|a, b| a.1.total_cmp(&b.1)).expect("vertices");
    assert!((deepest.0 - 0.48 * SIZE.x).abs() < 2e-3, "{deepest:?}");
}
