//! `ruga plan` for a layer on a soft body: its lattice, its mesh, its poses.

use ruga_stepper::BodyPlan;
use serde::Serialize;

use super::plan::layers_table;
use crate::error::counted;
use crate::messages;
use crate::project::Project;
use crate::table::{duration, memory, number, table};

/// Prints the plan as tables.
pub(super) fn print(project: &Project, plan: &BodyPlan) {
    messages::result(&layers_table(project, &[plan.wrinkling()]));
    messages::result("");
    let [x, y, z] = [0, 1, 2].map(|axis| 1e3 * plan.cell_size[axis]);
    messages::result(&format!(
        "interior: {} of {x:.1} x {y:.1} x {z:.1} mm, {} along the longest side, {}",
        counted(plan.cells, "lattice cell"),
        plan.cells_along,
        counted(plan.nodes, "node")
    ));
    messages::result("");
    let (seconds, bytes) = (plan.seconds_per_step(), plan.memory());
    let rows: Vec<Vec<String>> = (project.poses.iter())
        .map(|pose| {
            vec![
                pose.name.clone(),
                project.layers[0].name.clone(),
                plan.vertices.to_string(),
                number(plan.points_per_wavelength, 1, ""),
                pose.steps.to_string(),
                duration(seconds * f64::from(pose.steps)),
                memory(bytes),
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
    let steps: u32 = project.poses.iter().map(|pose| pose.steps).sum();
    messages::result(&format!(
        "total: {}, {} on one core, {} per thread",
        counted(project.poses.len(), "pose"),
        duration(seconds * f64::from(steps)),
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
pub(super) fn json(project: &Project, plan: &BodyPlan) -> String {
    let document = BodyPlanJson {
        version: 1,
        ruga: env!("CARGO_PKG_VERSION"),
        scene: project.path.to_string_lossy().into_owned(),
        warnings: project.warnings.iter().chain(&plan.warnings).collect(),
        interior: InteriorJson {
            cells: plan.cells,
            cells_along: plan.cells_along,
            cell_size_m: plan.cell_size.into(),
            nodes: plan.nodes,
        },
        layer: LayerJson {
            name: &project.layers[0].name,
            wavelength_m: plan.wavelength,
            critical_strain: plan.critical_strain,
            vertices: plan.vertices,
            points_per_wavelength: plan.points_per_wavelength,
        },
        poses: (project.poses.iter())
            .map(|pose| PoseJson {
                name: &pose.name,
                steps: pose.steps,
                seconds: plan.seconds_per_step() * f64::from(pose.steps),
                memory_bytes: plan.memory(),
            })
            .collect(),
    };
    serde_json::to_string_pretty(&document)
        .expect("structs of numbers, strings and lists always serialise")
}
