//! A soft slab that is pushed together: its layer wrinkles as theory says.

mod bodies;

use std::f64::consts::PI;
use std::sync::Arc;

use bodies::{compression, free_body, layer, modelling, pose, push, slab, slice, top};
use nalgebra::Vector3;
use ruga_material::{PropertyImage, PropertyMap, Wrap};
use ruga_solver::{Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError, minimise};
use ruga_stepper::{Coupling, EdgeLimits, Modelling, Plan, PoseResult, Silent, plan_body};

const SIZE: Vector3<f64> = Vector3::new(0.08, 0.02, 0.02);

/// Of a layer 150 times as stiff as a half-space of the same Poisson ratio: `(3/150)^(2/3) / 4`.
const CRITICAL: f64 = 0.018_420_157;
const WAVELENGTH: f64 = 0.01;

/// The slab, eight wavelengths long, held at both ends and pushed together; with the effective
/// strain of its surface in the middle at the end.
fn pushed(coupling: Coupling, points: f64, limits: EdgeLimits) -> (PoseResult, f64) {
    let driver = slab(SIZE, [16, 4, 4], |p| p);
    let spec = layer(150.0);
    let plan = planned_push(coupling, points, |modelling| {
        modelling.remesh = Some(limits)
    });
    let planned = &plan.poses[0].layers[0];
    assert!((planned.wavelength - WAVELENGTH).abs() < 1e-12);
    assert!((planned.critical_strain - CRITICAL).abs() < 1e-8);
    let interior = plan.interior.as_ref().expect("a body");
    assert_eq!([interior.cells, interior.nodes], [8 * 2 * 2, 10 * 4 * 4]);
    assert!((planned.points_per_wavelength / points - 1.0).abs() < 1e-12);
    let result = plan.simulate(0, &mut Silent).expect("a run");
    assert!(result.converged, "{:?}", result.warnings);
    let found = result.layers[0].vertices as f64 / planned.vertices as f64;
    assert!((0.7..1.4).contains(&found), "{found} of what was planned");
    let now = result.keys[0].artist_positions.as_ref().expect("a body");
    let strain = |from: [f64; 2], to: [f64; 2]| {
        let at = |[x, y]: [f64; 2]| Vector3::new(x, y, SIZE.z);
        compression(&driver, now, [at(from), at(to)])
    };
    let along = strain([0.03, 0.01], [0.05, 0.01]);
    let across = strain([0.04, 0.005], [0.04, 0.015]);
    // The inside bulges, which takes from what compresses the layer. Held by rows alone, the layer
    // moves the places between which this is measured about as much.
    assert!(
        across < -0.03 * along || coupling == Coupling::Constraint,
        "{along} {across}"
    );
    (result, along + spec.material.poisson * across)
}

fn planned_push(coupling: Coupling, points: f64, change: impl Fn(&mut Modelling)) -> Plan {
    let driver = slab(SIZE, [16, 4, 4], |p| p);
    let mut spec = layer(150.0);
    spec.coupling = coupling;
    let mut body = free_body(8);
    body.handles = vec![slice("left", -1.0, 0.01), slice("right", 0.07, 1.0)];
    let mut modelling = modelling(points);
    modelling.region = top();
    change(&mut modelling);
    let way = Vector3::x() * (0.03 * 1.8 * CRITICAL);
    let motions = vec![push("left", way), push("right", -way)];
    let poses = [pose(motions, &[1.0], 2)];
    plan_body(&driver, &[spec], &body, &poses, &modelling, 1024).expect("a closed slab")
}

/// With 8 edges to a wave the artist's vertices, between which strain is measured, ride on the waves too
/// much to compare an onset with theory.
#[test]
fn wrinkles_have_the_length_the_height_and_the_onset_of_theory() {
    let (result, strain) = pushed(Coupling::Hybrid, 12.0, EdgeLimits::default());
    let report = &result.layers[0];
    let bending = report.bending_ratio.expect("a measured mesh");
    assert!((0.9..1.05).contains(&bending), "{bending}");
    let wavelength = report.wavelength.expect("wrinkles") / WAVELENGTH;
    assert!((0.9..1.1).contains(&wavelength), "{wavelength}");
    // A layer that ends has less to bear there than what lies below it, by shear lag.
    let onset = report.onset_load.expect("an onset") * strain / CRITICAL;
    assert!((0.9..1.25).contains(&onset), "{onset}");
    // A single sine whose force stays at the critical one.
    let theory = WAVELENGTH / PI * (strain - CRITICAL).sqrt();
    let amplitude = report.amplitude / theory;
    assert!((0.75..1.1).contains(&amplitude), "{amplitude}");
}

/// A mesh that is fine across the wrinkles alone gives what one that is fine everywhere does, with a
/// third of the vertices.
#[test]
fn a_fitted_mesh_is_as_good_as_a_uniform_one() {
    let everywhere = EdgeLimits {
        aspect: 1.0,
        max_edge: 1.4 * WAVELENGTH / 12.0,
        ..EdgeLimits::default()
    };
    let limits = [EdgeLimits::default(), everywhere];
    let [fitted, uniform] = limits.map(|limits| pushed(Coupling::Hybrid, 12.0, limits));
    let [fitted, uniform] = [&fitted.0.layers[0], &uniform.0.layers[0]];
    assert!(3 * fitted.vertices < uniform.vertices);
    let lengths = fitted.wavelength.zip(uniform.wavelength).expect("wrinkles");
    assert!((lengths.0 / lengths.1 - 1.0).abs() < 0.03, "{lengths:?}");
    let heights = [fitted.amplitude, uniform.amplitude];
    // Patterns on different meshes are not the same.
    assert!((heights[0] / heights[1] - 1.0).abs() < 0.03, "{heights:?}");
}

/// Newton's method, to which a system as small as that of a coarse mesh is too much.
fn fails_on_coarse_meshes(
    objective: &dyn Objective,
    targets: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let is_coarse = x.len() < 3 * 700;
    let solve = minimise(objective, targets, x, kkt, settings, keep_going)?;
    Ok(SolveReport {
        converged: solve.converged && !is_coarse,
        ..solve
    })
}

/// Where the run ahead fails, the mesh is fine everywhere, and that is told.
#[test]
fn without_a_run_ahead_the_mesh_is_fine_everywhere() {
    let limits = EdgeLimits::default();
    let plan = planned_push(Coupling::Hybrid, 6.0, |modelling| {
        modelling.remesh = Some(limits);
        modelling.minimise = fails_on_coarse_meshes;
    });
    let result = plan.simulate(0, &mut Silent).expect("a run");
    assert!(result.converged, "{:?}", result.warnings);
    let report = &result.layers[0];
    assert!(
        report.vertices > 700 && report.bending_ratio.is_none(),
        "{report:?}"
    );
    assert!(
        result
            .warnings
            .iter()
            .any(|w| w.contains("a first run on a coarse mesh"))
    );
}

/// Rows alone hold a layer on a body, too; how early it buckles depends on how they are sampled.
#[test]
fn rows_alone_hold_the_layer() {
    let (result, strain) = pushed(Coupling::Constraint, 6.0, EdgeLimits::default());
    let report = &result.layers[0];
    let onset = report.onset_load.expect("an onset") * strain / CRITICAL;
    assert!((0.5..1.1).contains(&onset), "{onset}");
    assert!(report.constraints > 50);
}

/// Paint counts where the layer is: half as thick on half of it, it needs 5/2 of the vertices; twice
/// as thick, fewer and longer cells.
#[test]
fn a_plan_knows_the_paint_and_the_limits_of_edges() {
    let driver = slab(SIZE, [16, 4, 4], |p| p);
    let planned_with = |range: Option<[f64; 2]>, limits, (budget, map_size)| -> Plan {
        let mut spec = layer(150.0);
        let paint = |range| {
            let values = (0..64).map(|i| if i < 16 { 1.0 } else { 0.0 }).collect();
            let image = PropertyImage {
                width: 64,
                height: 1,
                values,
                range,
            };
            PropertyMap::new(None, None, Some(image), Wrap::ClampToEdge).expect("a map")
        };
        spec.map = range.map(|range| Arc::new(paint(range)));
        let mut body = free_body(8);
        body.cells = None;
        let mut modelling = modelling(8.0);
        modelling.region = top();
        modelling.remesh = Some(limits);
        modelling.vertex_budget = budget;
        let poses = [pose(Vec::new(), &[1.0], 1)];
        plan_body(
            &driver,
            std::slice::from_ref(&spec),
            &body,
            &poses,
            &modelling,
            map_size,
        )
        .expect("a closed slab")
    };
    let mesh = |plan: &Plan| plan.poses[0].layers[0].clone();
    let cells_along = |plan: &Plan| plan.interior.as_ref().expect("a body").cells_along;
    let planned = |range, limits| planned_with(range, limits, (100_000, 1024));
    let plain = planned(None, EdgeLimits::default());
    let thin = planned(Some([0.5, 1.0]), EdgeLimits::default());
    let more = mesh(&thin).vertices as f64 / mesh(&plain).vertices as f64;
    assert!((2.4..2.6).contains(&more), "{more}");
    assert_eq!(cells_along(&thin), cells_along(&plain));
    let thick = planned(Some([1.0, 2.0]), EdgeLimits::default());
    assert!(cells_along(&thick) < cells_along(&plain));
    let max_edge = 0.5 * WAVELENGTH / 8.0;
    let limits = EdgeLimits {
        max_edge,
        ..EdgeLimits::default()
    };
    let fine = planned(None, limits);
    let more = mesh(&fine).vertices as f64 / mesh(&plain).vertices as f64;
    assert!((3.95..4.05).contains(&more), "{more}");
    assert!((mesh(&fine).points_per_wavelength - 16.0).abs() < 1e-9);
    assert!(fine.warnings.is_empty(), "{:?}", fine.warnings);

    // Edges twice as long by the budget, twice as long by their limit, and a map of few texels.
    let warned = |plan: &Plan, text: &str| plan.warnings.iter().any(|w| w.contains(text));
    let short = planned_with(
        None,
        EdgeLimits::default(),
        (mesh(&plain).vertices / 4, 1024),
    );
    assert!((mesh(&short).points_per_wavelength - 4.0).abs() < 0.1);
    assert!(warned(&short, "vertex budget"), "{:?}", short.warnings);
    let limits = EdgeLimits {
        min_edge: 2.0 * WAVELENGTH / 8.0,
        ..EdgeLimits::default()
    };
    let coarse = planned(None, limits);
    assert!((mesh(&coarse).points_per_wavelength - 4.0).abs() < 1e-9);
    assert!(
        warned(&coarse, "shortest edge of 2.50 mm"),
        "{:?}",
        coarse.warnings
    );
    let small = planned_with(None, EdgeLimits::default(), (100_000, 16));
    assert!(
        warned(&small, "texels per wavelength"),
        "{:?}",
        small.warnings
    );
}
