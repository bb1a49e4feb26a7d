//! `ruga plan`: what will be modelled, where, how fine and at what cost.

use ruga_material::{FirstScale, Wrinkling};
use ruga_stepper::{LayerPlan, LoadPath, Plan};
use serde::Serialize;

use super::body_plan;
use crate::arguments::PlanArguments;
use crate::error::CliError;
use crate::messages;
use crate::planned::Planned;
use crate::project::Project;
use crate::run::Outcome;
use crate::table::{ABSENT, duration, memory, number, table};

/// Prints the plan of a scene; nothing is simulated.
///
/// # Errors
/// Whatever keeps the scene from being read or planned.
pub(crate) fn run(arguments: &PlanArguments) -> Result<Outcome, CliError> {
    let project = Project::read(&arguments.scene, &[], arguments.quality)?;
    let planned = project.plan()?;
    if arguments.json {
        messages::result(&match &planned {
            Planned::Skin(plan) => json(&project, plan),
            Planned::Body(plan) => body_plan::json(&project, plan),
        });
        return Ok(Outcome::Done);
    }
    match &planned {
        Planned::Skin(plan) => print(&project, plan),
        Planned::Body(plan) => body_plan::print(&project, plan),
    }
    let warnings = project.warnings.iter().chain(planned.warnings());
    messages::warnings(warnings, "`--json` lists all");
    Ok(Outcome::Done)
}

fn print(project: &Project, plan: &Plan) {
    messages::result(&layers_table(project, &plan.wrinkling));
    messages::result("");
    if !plan.pairs.is_empty() {
        messages::result(&pairs_table(project, plan));
        messages::result("");
    }
    messages::result(&poses_table(plan));
    messages::result(&totals(plan));
}

/// Every layer with its critical wave.
pub(super) fn layers_table(project: &Project, waves: &[Wrinkling]) -> String {
    let rows: Vec<Vec<String>> = project
        .layers
        .iter()
        .zip(waves)
        .map(|(layer, numbers)| {
            vec![
                layer.name.clone(),
                number(1e3 * numbers.wavelength, 2, "mm"),
                number(1e2 * numbers.critical_strain, 2, "%"),
                layer.model.name().to_owned(),
                number(layer.material.young / 1e6, 3, "MPa"),
                number(1e3 * layer.material.thickness, 3, "mm"),
            ]
        })
        .collect();
    let headings = [
        "layer",
        "wavelength",
        "critical strain",
        "model",
        "Young's modulus",
        "thickness",
    ];
    table(&headings, &rows)
}

/// Every layer on the one that carries it: what the two would do together.
fn pairs_table(project: &Project, plan: &Plan) -> String {
    let rows: Vec<Vec<String>> = pairs(project, plan)
        .iter()
        .map(|pair| {
            let joint = |value: Option<f64>| value.unwrap_or(f64::NAN);
            vec![
                format!("{} on {}", pair.upper, pair.lower),
                number(pair.membrane_ratio, 2, ""),
                number(pair.force_ratio, 2, ""),
                number(1e3 * joint(pair.joint_wavelength_m), 2, "mm"),
                number(1e2 * joint(pair.joint_critical_strain), 2, "%"),
                pair.first_scale.to_owned(),
                number(pair.bending_transfer, 3, ""),
            ]
        })
        .collect();
    let headings = [
        "pair",
        "membrane ratio",
        "force ratio",
        "joint wavelength",
        "joint critical strain",
        "first scale",
        "bending transfer",
    ];
    table(&headings, &rows)
}

fn pairs<'a>(project: &'a Project, plan: &Plan) -> Vec<PairJson<'a>> {
    let layers = project.layers.windows(2);
    let named = layers.zip(&plan.pairs);
    named
        .enumerate()
        .map(|(lower, (layers, pair))| PairJson {
            lower: &layers[0].name,
            upper: &layers[1].name,
            membrane_ratio: pair.membrane_ratio,
            force_ratio: pair.force_ratio,
            joint_wavelength_m: pair.joint.map(|joint| joint.wavelength),
            joint_critical_strain: pair.joint.map(|joint| joint.critical_strain),
            first_scale: match pair.first_scale() {
                FirstScale::Fine => "fine",
                FirstScale::Large => "large",
            },
            bending_transfer: plan.bending_transfer(lower + 1),
        })
        .collect()
}

fn poses_table(plan: &Plan) -> String {
    let mut rows = Vec::new();
    for pose in &plan.poses {
        for layer in &pose.layers {
            let simulated = layer.vertices > 0;
            let shown = |text: String| if simulated { text } else { ABSENT.to_owned() };
            rows.push(vec![
                pose.name.clone(),
                layer.name.clone(),
                shown(number(1e2 * layer.strain_median, 1, "%")),
                shown(number(1e2 * layer.strain_p99, 1, "%")),
                number(1e4 * layer.active_area, 1, "cm2"),
                number(1e4 * layer.capped_area, 1, "cm2"),
                layer.vertices.to_string(),
                shown(number(layer.points_per_wavelength, 1, "")),
                shown(number(layer.texels_per_wavelength, 1, "")),
                duration(if simulated { layer.seconds } else { 0.0 }),
                memory(if simulated { layer.memory } else { 0.0 }),
            ]);
        }
    }
    let headings = [
        "pose",
        "layer",
        "strain median",
        "99 %",
        "simulated",
        "beyond 15 %",
        "vertices",
        "points/wave",
        "texels/wave",
        "time",
        "memory",
    ];
    table(&headings, &rows)
}

/// Sums over poses; memory is that of the largest, as poses come and go.
struct Totals {
    vertices: usize,
    seconds: f64,
    largest_memory: f64,
}

impl Totals {
    fn of(plan: &Plan) -> Self {
        let simulated = || {
            plan.poses
                .iter()
                .flat_map(|pose| &pose.layers)
                .filter(|layer| layer.vertices > 0)
        };
        Self {
            vertices: simulated().map(|layer| layer.vertices).sum(),
            seconds: simulated().map(|layer| layer.seconds).sum(),
            largest_memory: simulated().map(|layer| layer.memory).fold(0.0, f64::max),
        }
    }
}

fn totals(plan: &Plan) -> String {
    let totals = Totals::of(plan);
    let wrinkling = plan
        .poses
        .iter()
        .filter(|pose| pose.layers.iter().any(|layer| layer.vertices > 0))
        .count();
    format!(
        "total: {wrinkling} of {} poses wrinkle, {} vertices, {} on one core, {} per thread",
        plan.poses.len(),
        totals.vertices,
        duration(totals.seconds),
        memory(totals.largest_memory),
    )
}

#[derive(Serialize)]
struct PlanJson<'a> {
    version: u32,
    ruga: &'a str,
    scene: String,
    warnings: Vec<&'a String>,
    /// Bottom first; empty for a single layer.
    pairs: Vec<PairJson<'a>>,
    poses: Vec<PoseJson<'a>>,
    total: TotalJson,
}

/// A layer on the one below. Where the two have no wave in common, that wave's numbers are `null`.
#[derive(Serialize)]
struct PairJson<'a> {
    lower: &'a str,
    upper: &'a str,
    /// Membrane stiffness of the upper layer over that of the lower one.
    membrane_ratio: f64,
    /// Critical force of the upper layer over that of the lower one, each alone.
    force_ratio: f64,
    joint_wavelength_m: Option<f64>,
    joint_critical_strain: Option<f64>,
    /// What a growing compression would show first of both together: `fine` or `large`.
    first_scale: &'static str,
    /// The share that is used: the scene's, or what its kind of stack has.
    bending_transfer: f64,
}

#[derive(Serialize)]
struct PoseJson<'a> {
    name: &'a str,
    /// What grows from load step to load step: `weight` or `strain`.
    path: &'static str,
    layers: Vec<LayerJson<'a>>,
}

/// Numbers that do not exist, as in a layer that is not simulated, are `null`.
#[derive(Serialize)]
struct LayerJson<'a> {
    name: &'a str,
    wavelength_m: f64,
    critical_strain: f64,
    strain_median: Option<f64>,
    strain_p99: Option<f64>,
    active_area_m2: f64,
    capped_area_m2: f64,
    folded_area_m2: f64,
    vertices: usize,
    points_per_wavelength: Option<f64>,
    chi: Option<f64>,
    texels_per_wavelength: Option<f64>,
    seconds: f64,
    memory_bytes: f64,
}

#[derive(Serialize)]
struct TotalJson {
    vertices: usize,
    seconds: f64,
    memory_bytes_per_pose: f64,
}

impl<'a> LayerJson<'a> {
    fn new(layer: &'a LayerPlan) -> Self {
        let simulated = layer.vertices > 0;
        let known = |value: f64| Some(value).filter(|v| simulated && v.is_finite());
        Self {
            name: &layer.name,
            wavelength_m: layer.wavelength,
            critical_strain: layer.critical_strain,
            strain_median: known(layer.strain_median),
            strain_p99: known(layer.strain_p99),
            active_area_m2: layer.active_area + 0.0,
            capped_area_m2: layer.capped_area + 0.0,
            folded_area_m2: layer.folded_area + 0.0,
            vertices: layer.vertices,
            points_per_wavelength: known(layer.points_per_wavelength),
            chi: known(layer.chi),
            texels_per_wavelength: known(layer.texels_per_wavelength),
            seconds: known(layer.seconds).unwrap_or(0.0),
            memory_bytes: known(layer.memory).unwrap_or(0.0),
        }
    }
}

fn json(project: &Project, plan: &Plan) -> String {
    let totals = Totals::of(plan);
    let document = PlanJson {
        version: 1,
        ruga: env!("CARGO_PKG_VERSION"),
        scene: project.path.to_string_lossy().into_owned(),
        warnings: project.warnings.iter().chain(&plan.warnings).collect(),
        pairs: pairs(project, plan),
        poses: plan
            .poses
            .iter()
            .map(|pose| PoseJson {
                name: &pose.name,
                path: match pose.path {
                    LoadPath::Weight => "weight",
                    LoadPath::Strain => "strain",
                },
                layers: pose.layers.iter().map(LayerJson::new).collect(),
            })
            .collect(),
        total: TotalJson {
            vertices: totals.vertices,
            seconds: totals.seconds,
            memory_bytes_per_pose: totals.largest_memory,
        },
    };
    serde_json::to_string_pretty(&document)
        .expect("structs of numbers, strings and lists always serialise")
}
