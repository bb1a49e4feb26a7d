//! `ruga plan`: what will be modelled, where, how fine and at what cost.

use ruga_material::{LaminatedSheet, Wrinkling};
use ruga_scene::{Scene, SceneOptions, ScenePlan, counted};
use ruga_stepper::{InteriorPlan, Sheet};

use super::plan_creases::creases_table;
use super::plan_json::{Totals, json, pairs};
use crate::arguments::PlanArguments;
use crate::error::CliError;
use crate::messages;
use crate::outcome::Outcome;
use crate::table::{ABSENT, duration, memory, number, table};
use crate::{plan_page, plan_picture};

/// Prints the plan of a scene, and draws it where that is asked for; nothing is simulated.
///
/// # Errors
/// Whatever keeps the scene from being read or planned, and its picture from being written.
pub(crate) fn run(arguments: &PlanArguments) -> Result<Outcome, CliError> {
    let options = SceneOptions {
        poses: arguments.poses.clone(),
        points_per_wavelength: arguments.quality.points_per_wavelength(),
    };
    let scene = Scene::read_with(&arguments.scene, &options)?;
    let planned = scene.plan()?;
    draw(arguments, &scene, &planned)?;
    if arguments.json {
        messages::result(&json(&scene, &planned));
        return Ok(Outcome::Done);
    }
    print(&scene, &planned);
    let warnings = scene.warnings.iter().chain(planned.warnings());
    messages::warnings(warnings, "`--json` lists all");
    Ok(Outcome::Done)
}

/// Draws the picture and the page that are asked for.
fn draw(arguments: &PlanArguments, scene: &Scene, plan: &ScenePlan) -> Result<(), CliError> {
    if arguments.image.is_none() && arguments.preview.is_none() {
        return Ok(());
    }
    // Pictures are of the poses themselves, of which some are simulated as their mirror images.
    let as_posed = Scene {
        mirror: None,
        ..scene.clone()
    };
    let own = scene.mirror.as_ref().map(|_| as_posed.plan()).transpose()?;
    let shown = own.as_ref().unwrap_or(plan);
    if let Some(path) = &arguments.image {
        plan_picture::write(path, &as_posed, shown)?;
    }
    if let Some(path) = &arguments.preview {
        plan_page::write(path, &as_posed, shown, totals(plan))?;
    }
    Ok(())
}

/// Poses that are made of the simulation of others, or of half of one, in words.
fn alike(scene: &Scene, plan: &ScenePlan) -> Vec<String> {
    let poses = (0..scene.poses.len()).map(|pose| (pose, plan.first_alike(pose)));
    let shared = poses.clone().filter(|(pose, first)| pose != first);
    let halves = poses.filter(|(pose, _)| plan.is_half(*pose));
    let halves: Vec<String> = halves
        .map(|(pose, _)| format!("`{}`", scene.poses[pose].name))
        .collect();
    let of_halves = match halves.as_slice() {
        [] => None,
        [one] => Some(format!(
            "{one} mirrors itself: `ruga bake` simulates one half, whose numbers these are"
        )),
        many => Some(format!(
            "{} mirror themselves: `ruga bake` simulates one half of each, whose numbers these are",
            many.join(", ")
        )),
    };
    shared
        .map(|(pose, first)| {
            let [own, other] = [pose, first].map(|number| &scene.poses[number].name);
            let what = match plan.is_image(pose) == plan.is_image(first) {
                true => "the same",
                false => "mirror images",
            };
            format!("`{own}` and `{other}` are {what}: `ruga bake` makes both of one simulation")
        })
        .chain(of_halves)
        .collect()
}

fn print(scene: &Scene, plan: &ScenePlan) {
    let waves = waves(scene, plan);
    match plan.sheet() {
        Some(free) => messages::result(&sheet(scene, free)),
        None => messages::result(&layers_table(scene, &waves)),
    }
    messages::result("");
    let creases = creases_table(scene, &waves);
    if !creases.is_empty() {
        messages::result(&creases);
        messages::result("");
    }
    if let Some(interior) = plan.interior() {
        messages::result(&lattice(interior));
        messages::result("");
    }
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
    for line in alike(scene, plan) {
        messages::result(&line);
    }
    messages::result(&totals(plan));
}

/// The critical wave of every layer, in the order of the scene.
pub(super) fn waves(scene: &Scene, plan: &ScenePlan) -> Vec<Wrinkling> {
    let mut waves = vec![None; scene.layers.len()];
    for zone in &plan.zones {
        for (number, wave) in zone.layers.iter().zip(zone.plan.wrinkling()) {
            waves[*number] = Some(*wave);
        }
    }
    waves.into_iter().flatten().collect()
}

/// Every layer with its critical wave.
fn layers_table(scene: &Scene, waves: &[Wrinkling]) -> String {
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

/// A free sheet in words.
fn sheet(scene: &Scene, free: &Sheet) -> String {
    let layer = &scene.layers[0];
    let material = format!(
        "{} of {}",
        number(1e3 * layer.material.thickness, 3, "mm"),
        number(layer.material.young / 1e6, 3, "MPa"),
    );
    let made_of = match &layer.laminate {
        None => material,
        Some(laminate) => format!(
            "{}, {} in all, as stiff as {material}",
            plies(laminate),
            number(1e3 * laminate.thickness(), 3, "mm"),
        ),
    };
    let [burning, fresh] = free.edges(scene.driver.rest());
    let length = |edge: f64| number(1e3 * edge, 2, "mm");
    let edges = match burning < fresh {
        true => format!("{}, {} where it burns", length(fresh), length(burning)),
        false => length(burning),
    };
    format!(
        "sheet: {}, {made_of}, edges up to {edges}, {}, {}",
        layer.name,
        counted(free.handles.len(), "handle"),
        counted(free.obstacles.len(), "obstacle"),
    )
}

/// The number of plies of a laminate in words.
pub(super) fn plies(laminate: &LaminatedSheet) -> String {
    match laminate.ply_count() {
        1 => "1 ply".to_owned(),
        count => format!("{count} plies"),
    }
}

/// The lattice of a body in words.
fn lattice(interior: &InteriorPlan) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| 1e3 * interior.cell_size[axis]);
    format!(
        "interior: {} of {x:.1} x {y:.1} x {z:.1} mm, {} along the longest side, {}",
        counted(interior.cells, "lattice cell"),
        interior.cells_along,
        counted(interior.nodes, "node")
    )
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

/// Table of what paint and natural unevenness make of the layers in every pose; empty where
/// nothing is uneven.
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
            // What a body compresses is known when it is simulated.
            let applied = |value: String| match layer.applied {
                Some(_) => value,
                None => ABSENT.to_owned(),
            };
            let strain = layer.applied.unwrap_or_default();
            rows.push(vec![
                pose.name.clone(),
                layer.name.clone(),
                applied(number(1e2 * strain.median, 1, "%")),
                applied(number(1e2 * strain.p99, 1, "%")),
                number(1e4 * layer.active_area, 1, "cm2"),
                shown(applied(number(1e4 * strain.capped_area, 1, "cm2"))),
                layer.vertices.to_string(),
                shown(number(layer.points_per_wavelength, 1, "")),
                shown(number(layer.texels_per_wavelength, 1, "")),
                match plan.first_alike(index) == index {
                    true => duration(if simulated { layer.seconds } else { 0.0 }),
                    false => ABSENT.to_owned(),
                },
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

fn totals(plan: &ScenePlan) -> String {
    let totals = Totals::of(plan);
    let poses = plan.zones[0].plan.poses.len();
    let wrinkles = |pose: &usize| {
        let mut layers = plan.pose_layers(*pose).into_iter();
        layers.any(|layer| layer.vertices > 0)
    };
    let is_free = plan.interior().is_some() || plan.sheet().is_some();
    let poses = match is_free {
        true => counted(poses, "pose"),
        false => {
            let wrinkling = (0..poses).filter(wrinkles).count();
            format!("{wrinkling} of {poses} poses wrinkle")
        }
    };
    format!(
        "total: {poses}, {} vertices, {} on one core, {} per thread",
        totals.vertices,
        duration(totals.seconds),
        memory(totals.largest_memory),
    )
}
