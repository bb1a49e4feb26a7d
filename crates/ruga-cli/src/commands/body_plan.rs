//! `ruga plan` for a layer on a soft body: its lattice, its mesh, its poses.

use ruga_scene::{Scene, counted};
use ruga_stepper::{InteriorPlan, Plan};
use serde::Serialize;

use super::plan::layers_table;
use crate::messages;
use crate::table::{duration, memory, number, table};

/// Prints the plan as tables.
pub(super) fn print(scene: &Scene, plan: &Plan, interior: &InteriorPlan) {
    messages::result(&layers_table(scene, plan.wrinkling()));
    messages::result("");
    let [x, y, z] = [0, 1, 2].map(|axis| 1e3 * interior.cell_size[axis]);
    messages::result(&format!(
        "interior: {} of {x:.1} x {y:.1} x {z:.1} mm, {} along the longest side, {}",
        counted(interior.cells, "lattice cell"),
        interior.cells_along,
        counted(interior.nodes, "node")
    ));
    messages::result("");
    let poses = || scene.poses.iter().zip(&plan.poses);
    let rows: Vec<Vec<String>> = poses()
        .map(|(pose, planned)| {
            let layer = &planned.layers[0];
            vec![
                pose.name.clone(),
                layer.name.clone(),
                layer.vertices.to_string(),
                number(layer.points_per_wavelength, 1, ""),
                pose.steps.to_string(),
                duration(layer.seconds),
                memory(layer.memory),
            ]
        })
        .collect();
    let headings = [
        "pose",
        "layer",
        "vertices",
        "points/wave",
        "steps",
        "time",
        "memory",
    ];
    messages::result(&table(&headings, &rows));
    let layers = || plan.poses.iter().map(|planned| &planned.layers[0]);
    let bytes = layers().map(|layer| layer.memory).fold(0.0, f64::max);
    messages::result(&format!(
        "total: {}, {} on one core, {} per thread",
        counted(scene.poses.len(), "pose"),
        duration(layers().map(|layer| layer.seconds).sum()),
        memory(bytes)
    ));
}

#[derive(Serialize)]
struct BodyPlanJson<'a> {
    version: u32,
    ruga: &'a str,
    scene: String,
    warnings: Vec<&'a String>,
    interior: InteriorJson,
    layer: LayerJson<'a>,
    poses: Vec<PoseJson<'a>>,
}

#[derive(Serialize)]
struct InteriorJson {
    cells: usize,
    cells_along: u32,
    cell_size_m: [f64; 3],
    nodes: usize,
}

#[derive(Serialize)]
struct LayerJson<'a> {
    name: &'a str,
    wavelength_m: f64,
    critical_strain: f64,
    vertices: usize,
    points_per_wavelength: f64,
}

#[derive(Serialize)]
struct PoseJson<'a> {
    name: &'a str,
    steps: u32,
    seconds: f64,
    memory_bytes: f64,
}

/// The same as JSON, version 1.
pub(super) fn json(scene: &Scene, plan: &Plan, interior: &InteriorPlan) -> String {
    let layer = &plan.poses[0].layers[0];
    let document = BodyPlanJson {
        version: 1,
        ruga: env!("CARGO_PKG_VERSION"),
        scene: scene.path.to_string_lossy().into_owned(),
        warnings: scene.warnings.iter().chain(&plan.warnings).collect(),
        interior: InteriorJson {
            cells: interior.cells,
            cells_along: interior.cells_along,
            cell_size_m: interior.cell_size.into(),
            nodes: interior.nodes,
        },
        layer: LayerJson {
            name: &layer.name,
            wavelength_m: layer.wavelength,
            critical_strain: layer.critical_strain,
            vertices: layer.vertices,
            points_per_wavelength: layer.points_per_wavelength,
        },
        poses: (scene.poses.iter().zip(&plan.poses))
            .map(|(pose, planned)| PoseJson {
                name: &pose.name,
                steps: pose.steps,
                seconds: planned.layers[0].seconds,
                memory_bytes: planned.layers[0].memory,
            })
            .collect(),
    };
    serde_json::to_string_pretty(&document)
        .expect("structs of numbers, strings and lists always serialise")
}
