//! `ruga plan --json`: the plan of a skin or a soft body as one document, version 1.

use ruga_material::FirstScale;
use ruga_scene::{Scene, ScenePlan, ZonePlan};
use ruga_stepper::{AppliedStrain, InteriorPlan, LayerPlan, LoadPath};
use serde::Serialize;

use super::plan::waves;
use super::plan_creases::{CreaseJson, creases};

/// The plan as JSON.
pub(super) fn json(scene: &Scene, plan: &ScenePlan) -> String {
    let totals = Totals::of(plan);
    let interior = plan.interior();
    let body_layer = interior.and_then(|_| plan.pose_layers(0).into_iter().next());
    let document = PlanJson {
        version: 1,
        ruga: env!("CARGO_PKG_VERSION"),
        scene: scene.path.to_string_lossy().into_owned(),
        warnings: scene.warnings.iter().chain(plan.warnings()).collect(),
        interior: interior.map(InteriorJson::new),
        layer: body_layer.map(LayerJson::new),
        pairs: pairs(scene, plan),
        creases: creases(scene, &waves(scene, plan)),
        poses: (0..scene.poses.len())
            .map(|index| PoseJson::new(scene, plan, index))
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

#[derive(Serialize)]
struct PlanJson<'a> {
    version: u32,
    ruga: &'a str,
    scene: String,
    warnings: Vec<&'a String>,
    /// The lattice of a soft body.
    #[serde(skip_serializing_if = "Option::is_none")]
    interior: Option<InteriorJson>,
    /// The layer of a soft body, as in its first pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    layer: Option<LayerJson<'a>>,
    /// Bottom first; empty for a single layer.
    pairs: Vec<PairJson<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    creases: Vec<CreaseJson<'a>>,
    poses: Vec<PoseJson<'a>>,
    total: TotalJson,
}

#[derive(Serialize)]
struct InteriorJson {
    cells: usize,
    cells_along: u32,
    cell_size_m: [f64; 3],
    nodes: usize,
}

impl InteriorJson {
    fn new(interior: &InteriorPlan) -> Self {
        Self {
            cells: interior.cells,
            cells_along: interior.cells_along,
            cell_size_m: interior.cell_size.into(),
            nodes: interior.nodes,
        }
    }
}

/// A layer on the one below. Where the two have no wave in common, that wave's numbers are `null`.
#[derive(Serialize)]
pub(super) struct PairJson<'a> {
    pub(super) lower: &'a str,
    pub(super) upper: &'a str,
    /// Membrane stiffness of the upper layer over that of the lower one.
    pub(super) membrane_ratio: f64,
    /// Critical force of the upper layer over that of the lower one, each alone.
    pub(super) force_ratio: f64,
    pub(super) joint_wavelength_m: Option<f64>,
    pub(super) joint_critical_strain: Option<f64>,
    /// Scale that a growing compression would show first of both together: `fine` or `large`.
    pub(super) first_scale: &'static str,
    /// The share that is used: the scene's, or what its kind of stack has.
    pub(super) bending_transfer: f64,
}

#[derive(Serialize)]
struct PoseJson<'a> {
    name: &'a str,
    /// Quantity that grows from load step to load step: `weight` or `strain`.
    path: &'static str,
    steps: u32,
    /// Whether one half of the pose is simulated, which the other numbers are of.
    half: bool,
    seconds: f64,
    memory_bytes: f64,
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
            strain_median: applied(|strain| strain.median).filter(|s| s.is_finite()),
            strain_p99: applied(|strain| strain.p99).filter(|s| s.is_finite()),
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

impl<'a> PoseJson<'a> {
    fn new(scene: &'a Scene, plan: &'a ScenePlan, index: usize) -> Self {
        let mut paths = plan.zones.iter().map(|zone| zone.plan.poses[index].path);
        let layers = plan.pose_layers(index).into_iter();
        let layers: Vec<LayerJson<'_>> = layers.map(LayerJson::new).collect();
        Self {
            name: &scene.poses[index].name,
            path: match paths.any(|path| path == LoadPath::Strain) {
                true => "strain",
                false => "weight",
            },
            steps: scene.poses[index].steps,
            half: plan.is_half(index),
            seconds: layers.iter().map(|layer| layer.seconds).sum(),
            memory_bytes: plan.pose_memory(index),
            layers,
        }
    }
}

/// Every layer of a zone with the one that carries it.
pub(super) fn pairs<'a>(scene: &'a Scene, plan: &ScenePlan) -> Vec<PairJson<'a>> {
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

/// Sums over poses; memory is that of the largest, as poses come and go.
pub(super) struct Totals {
    pub(super) vertices: usize,
    pub(super) seconds: f64,
    pub(super) largest_memory: f64,
}

impl Totals {
    pub(super) fn of(plan: &ScenePlan) -> Self {
        let simulated = || {
            // Poses of the same simulation cost it once.
            let poses = 0..plan.zones[0].plan.poses.len();
            let poses = poses.filter(|&pose| plan.first_alike(pose) == pose);
            let layers = poses.flat_map(|pose| plan.pose_layers(pose));
            layers.filter(|layer| layer.vertices > 0)
        };
        Self {
            vertices: simulated().map(|layer| layer.vertices).sum(),
            seconds: simulated().map(|layer| layer.seconds).sum(),
            largest_memory: (0..plan.zones[0].plan.poses.len())
                .map(|pose| plan.pose_memory(pose))
                .fold(0.0, f64::max),
        }
    }
}
