//! `ruga plan`: what will be modelled, where, how fine and at what cost.

use ruga_material::{FirstScale, Wrinkling};
use ruga_scene::{Scene, SceneOptions, ScenePlan, ZonePlan};
use ruga_stepper::{AppliedStrain, LayerPlan, LoadPath};
use serde::Serialize;

use super::body_plan;
use crate::arguments::{PlanArguments, Quality};
use crate::error::CliError;
use crate::messages;
use crate::run::Outcome;
use crate::table::{ABSENT, duration, memory, number, table};

/// Prints the plan of a scene; nothing is simulated.
///
/// # Errors
/// Whatever keeps the scene from being read or planned.
pub(crate) fn run(arguments: &PlanArguments) -> Result<Outcome, CliError> {
    let options = SceneOptions {
        points_per_wavelength: arguments.quality.map(Quality::points_per_wavelength),
        ..SceneOptions::default()
    };
    let scene = Scene::read_with(&arguments.scene, &options)?;
    let planned = scene.plan()?;
    if arguments.json {
        messages::result(&match planned.interior() {
            None => json(&scene, &planned),
            Some(interior) => body_plan::json(&scene, &planned.zones[0].plan, interior),
        });
        return Ok(Outcome::Done);
    }
    match planned.interior() {
        None => print(&scene, &planned),
        Some(interior) => body_plan::print(&scene, &planned.zones[0].plan, interior),
    }
    let warnings = scene.warnings.iter().chain(planned.warnings());
    messages::warnings(warnings, "`--json` lists all");
    Ok(Outcome::Done)
}

fn print(scene: &Scene, plan: &ScenePlan) {
    let mut waves = vec![None; scene.layers.len()];
    for zone in &plan.zones {
        for (number, wave) in zone.layers.iter().zip(zone.plan.wrinkling()) {
            waves[*number] = Some(*wave);
        }
    }
    let waves: Vec<Wrinkling> = waves.into_iter().flatten().collect();
    messages::result(&layers_table(scene, &waves));
    messages::result("");
    if plan.zones.iter().any(|zone| !zone.plan.pairs().is_empty()) {
        messages::result(&pairs_table(scene, plan));
        messages::result("");
    }
    let painted = painted_table(plan);
    if !painted.is_empty() {
        messages::result(&painted);
        messages::result("");
    }
    messages::result(&poses_table(plan));
    messages::result(&totals(plan));
}

/// Every layer with its critical wave.
pub(super) fn layers_table(scene: &Scene, waves: &[Wrinkling]) -> String {
    let rows: Vec<Vec<String>> = scene
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
fn pairs_table(scene: &Scene, plan: &ScenePlan) -> String {
    let rows: Vec<Vec<String>> = pairs(scene, plan)
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

fn pairs<'a>(scene: &'a Scene, plan: &ScenePlan) -> Vec<PairJson<'a>> {
    let of_zone = |zone| zone_pairs(scene, zone);
    plan.zones.iter().flat_map(of_zone).collect()
}

fn zone_pairs<'a>(scene: &'a Scene, ZonePlan { layers, plan }: &ZonePlan) -> Vec<PairJson<'a>> {
    let named = layers.windows(2).zip(plan.pairs());
    named
        .enumerate()
        .map(|(lower, (layers, pair))| PairJson {
            lower: &scene.layers[layers[0]].name,
            upper: &scene.layers[layers[1]].name,
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

/// What paint and natural unevenness make of the layers in every pose; empty where nothing is uneven.
fn painted_table(plan: &ScenePlan) -> String {
    let mut rows = Vec::new();
    for (index, pose) in plan.zones[0].plan.poses.iter().enumerate() {
        for layer in plan.pose_layers(index) {
            let Some(painted) = layer.painted else {
                continue;
            };
            let range = |[low, high]: [f64; 2], factor: f64, places: usize, unit: &str| {
                let [low, high] = [low, high].map(|value| number(factor * value, places, unit));
                format!("{low} to {high}")
            };
            rows.push(vec![
                pose.name.clone(),
                layer.name.clone(),
                range(painted.wavelength, 1e3, 2, "mm"),
                range(painted.critical_strain, 1e2, 1, "%"),
                range(painted.thickness, 1e3, 3, "mm"),
            ]);
        }
    }
    match rows.is_empty() {
        true => String::new(),
        false => {
            let headings = [
                "pose",
                "uneven layer",
                "wavelength",
                "critical strain",
                "thickness",
            ];
            table(&headings, &rows)
        }
    }
}

fn poses_table(plan: &ScenePlan) -> String {
    let mut rows = Vec::new();
    for (index, pose) in plan.zones[0].plan.poses.iter().enumerate() {
        for layer in plan.pose_layers(index) {
            let simulated = layer.vertices > 0;
            let shown = |text: String| if simulated { text } else { ABSENT.to_owned() };
            let applied = layer.applied.unwrap_or_default();
            rows.push(vec![
                pose.name.clone(),
                layer.name.clone(),
                shown(number(1e2 * applied.median, 1, "%")),
                shown(number(1e2 * applied.p99, 1, "%")),
                number(1e4 * layer.active_area, 1, "cm2"),
                number(1e4 * applied.capped_area, 1, "cm2"),
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
    fn of(plan: &ScenePlan) -> Self {
        let simulated = || {
            let poses = plan.zones.iter().flat_map(|zone| &zone.plan.poses);
            let layers = poses.flat_map(|pose| &pose.layers);
            layers.filter(|layer| layer.vertices > 0)
        };
        Self {
            vertices: simulated().map(|layer| layer.vertices).sum(),
            seconds: simulated().map(|layer| layer.seconds).sum(),
            largest_memory: simulated().map(|layer| layer.memory).fold(0.0, f64::max),
        }
    }
}

fn totals(plan: &ScenePlan) -> String {
    let totals = Totals::of(plan);
    let poses = plan.zones[0].plan.poses.len();
    let wrinkles = |pose: &usize| {
        let mut layers = plan.pose_layers(*pose).into_iter();
        layers.any(|layer| layer.vertices > 0)
    };
    let wrinkling = (0..poses).filter(wrinkles).count();
    format!(
        "total: {wrinkling} of {} poses wrinkle, {} vertices, {} on one core, {} per thread",
        poses,
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
    /// Ranges over the active area of what paint and natural unevenness make of the layer.
    wavelength_range_m: Option<[f64; 2]>,
    critical_strain_range: Option<[f64; 2]>,
    thickness_range_m: Option<[f64; 2]>,
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
        let applied = |value: fn(&AppliedStrain) -> f64| layer.applied.as_ref().map(value);
        Self {
            name: &layer.name,
            wavelength_m: layer.wavelength,
            critical_strain: layer.critical_strain,
            strain_median: applied(|strain| strain.median).and_then(known),
            strain_p99: applied(|strain| strain.p99).and_then(known),
            active_area_m2: layer.active_area + 0.0,
            capped_area_m2: applied(|strain| strain.capped_area).unwrap_or(0.0) + 0.0,
            folded_area_m2: applied(|strain| strain.folded_area).unwrap_or(0.0) + 0.0,
            vertices: layer.vertices,
            points_per_wavelength: known(layer.points_per_wavelength),
            chi: applied(|strain| strain.chi).and_then(known),
            texels_per_wavelength: known(layer.texels_per_wavelength),
            wavelength_range_m: layer.painted.map(|painted| painted.wavelength),
            critical_strain_range: layer.painted.map(|painted| painted.critical_strain),
            thickness_range_m: layer.painted.map(|painted| painted.thickness),
            seconds: known(layer.seconds).unwrap_or(0.0),
            memory_bytes: known(layer.memory).unwrap_or(0.0),
        }
    }
}

fn json(scene: &Scene, plan: &ScenePlan) -> String {
    let totals = Totals::of(plan);
    let own = plan.zones.iter().flat_map(|zone| &zone.plan.warnings);
    let has_strain_path = |pose: usize| {
        let mut paths = plan.zones.iter().map(|zone| zone.plan.poses[pose].path);
        paths.any(|path| path == LoadPath::Strain)
    };
    let document = PlanJson {
        version: 1,
        ruga: env!("CARGO_PKG_VERSION"),
        scene: scene.path.to_string_lossy().into_owned(),
        warnings: scene.warnings.iter().chain(own).collect(),
        pairs: pairs(scene, plan),
        poses: (0..)
            .zip(&scene.poses)
            .map(|(index, pose)| PoseJson {
                name: &pose.name,
                path: match has_strain_path(index) {
                    true => "strain",
                    false => "weight",
                },
                layers: plan
                    .pose_layers(index)
                    .into_iter()
                    .map(LayerJson::new)
                    .collect(),
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
