//! What a body's simulation will be made of.

use std::sync::Arc;

use ruga_blend::Driver;
use ruga_lattice::LatticeError;
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id};

use super::carrier::Carrier;
use super::cost::cost;
use super::handles::{HeldNodes, Moves};
use super::lattice_size::lattice_warnings;
use super::obstacle::{self, distance};
use super::waves::Waves;
use crate::plan::within;
use crate::plan_warnings::resolution_warnings;
use crate::stacking::Stacking;
use crate::surface_measures::{MAX_LEVELS, MAX_PLANNING_FACES, needed_levels};
use crate::validation::{check_body_modelling, check_layer, check_map_size, check_pose};
use crate::{
    Body, InteriorPlan, LayerPlan, LayerSpec, LoadPath, Modelling, Plan, PosePlan, PoseSpec, Stack,
    StepperError,
};

/// Edges over those asked for from which on a mesh is worth a warning.
const WORTH_TELLING: f64 = 1.1;

/// A body, its lattice, and what holds it.
#[derive(Clone, Debug)]
pub(crate) struct Interior {
    pub(crate) body: Body,
    pub(crate) carrier: Arc<Carrier>,
    pub(crate) held: HeldNodes,
}

/// Finds out what a body under a layer will be made of: its lattice, and the layer's mesh.
///
/// The layer covers the whole surface, or the faces on which its masks and that of
/// [`Modelling::region`] let it be; borders of a mask are free. `layer.substrate` stands
/// for the interior at the scale of the wrinkles, which the lattice does not resolve, and
/// [`Body::material`] for it at the scale of the body: the two are meant to be the same stuff. A
/// lattice without a number of cells has as many as let the body bend, as long as they are longer than
/// its waves. A map of the layer counts everywhere, but for a twentieth of the area with the shortest
/// waves and one with the longest. `map_size` (texels) is only for the warning about too small a map.
///
/// # Errors
/// [`StepperError::Setting`] for a value out of range or that is no number, before any work is done;
/// a bad material, a black mask, a surface that does not enclose a body, a handle without cells,
/// handles that hold all of it, a sharp map whose boundaries are nearly everywhere; a motion of something
/// that is not there, or whose keyframes do not ascend; an obstacle without a shape.
pub fn plan_body(
    driver: &Arc<Driver>,
    layer: &LayerSpec,
    body: &Body,
    poses: &[PoseSpec],
    modelling: &Modelling,
    map_size: u32,
) -> Result<Plan, StepperError> {
    check_body_modelling(modelling)?;
    check_map_size(map_size)?;
    check_layer(layer)?;
    poses.iter().try_for_each(|pose| check_pose(driver, pose))?;
    let layer = within(layer, modelling.region.mask());
    let stacking = Stacking::new(std::slice::from_ref(&layer), Stack::Nominal)?;
    check(body)?;
    body.obstacles.iter().try_for_each(obstacle::check)?;
    for pose in poses {
        Moves::new(body, pose)?;
    }
    let numbers = &stacking.wrinkling[0];
    let faces = covered_faces(driver, &layer)?;
    let layer_mesh = LayerMesh::new(driver, &faces, (&layer, numbers), modelling)?;
    let waves = &layer_mesh.waves;
    let carrier = Carrier::new(driver, body, waves.longest, modelling.smoothing)?;
    let held = HeldNodes::new(&carrier.lattice, &body.handles)?;
    let mut warnings = lattice_warnings(&carrier, body, waves.longest);
    let covered = (faces.len(), layer.material.thickness);
    warnings.extend(obstacle_warnings(driver, body, covered));
    let of_layer = |text: String| format!("layer '{}': {text}", layer.name);
    warnings.extend(
        layer_mesh
            .warnings(modelling, map_size)
            .into_iter()
            .map(of_layer),
    );
    let lattice = &carrier.lattice;
    let interior = InteriorPlan {
        cells: lattice.element_count(),
        cells_along: carrier.cells,
        cell_size: lattice.cell_size(),
        nodes: lattice.node_count(),
    };
    let (per_step, memory) = cost(layer_mesh.vertices, &interior);
    let layer_plan = LayerPlan {
        name: layer.name.clone(),
        wavelength: numbers.wavelength,
        critical_strain: numbers.critical_strain,
        painted: None,
        applied: None,
        active_area: waves.area(),
        vertices: layer_mesh.vertices,
        levels: layer_mesh.levels,
        points_per_wavelength: layer_mesh.points,
        texels_per_wavelength: waves.texels(map_size),
        seconds: 0.0,
        memory,
        asked_points: modelling.points_per_wavelength,
        needed: layer_mesh.needed,
        region: faces.iter().map(|face| u64::from(face.0)).collect(),
    };
    let pose_plan = |pose: &PoseSpec| PosePlan {
        name: pose.name.clone(),
        path: LoadPath::Weight,
        layers: vec![LayerPlan {
            seconds: per_step * f64::from(pose.steps),
            ..layer_plan.clone()
        }],
    };
    let plan = Plan {
        poses: poses.iter().map(pose_plan).collect(),
        warnings,
        interior: Some(interior),
        driver: Arc::clone(driver),
        modelling: modelling.clone(),
        specs: poses.to_vec(),
        stacking,
        planning_levels: 0,
        body: Some(Interior {
            body: body.clone(),
            carrier: Arc::new(carrier),
            held,
        }),
    };
    plan.check_boundaries()?;
    Ok(plan)
}

fn check(body: &Body) -> Result<(), StepperError> {
    let refuse = |name, value, accepted| {
        Err(StepperError::Lattice(LatticeError::Setting {
            name,
            value,
            accepted,
        }))
    };
    if let Some(value) = body.follow.filter(|k| !(*k > 0.0 && k.is_finite())) {
        return refuse("follow", value, "a positive number");
    }
    if !(body.density > 0.0 && body.density.is_finite()) {
        return refuse("density", body.density, "a positive number");
    }
    if let Some(&value) = body.gravity.iter().find(|c| !c.is_finite()) {
        return refuse("gravity", value, "a finite number");
    }
    Ok(())
}

/// What keeps obstacles from pressing as meant on a layer that covers so many faces and is so thick, m.
fn obstacle_warnings(
    driver: &Driver,
    body: &Body,
    (covered, thickness): (usize, f64),
) -> Vec<String> {
    let mut warnings = Vec::new();
    if !body.obstacles.is_empty() && covered < driver.topology().face_count() {
        warnings.push(
            "interior: obstacles press on the layer, and where the mask leaves none they pass through the body".to_owned(),
        );
    }
    for obstacle in &body.obstacles {
        let depths = driver
            .rest()
            .iter()
            .map(|x| -distance(&obstacle.shape, x).value);
        let depth = depths.fold(0.0, f64::max);
        if depth > thickness {
            warnings.push(format!(
                "interior: obstacle '{}' begins {:.2} mm inside the body; let it begin outside and move it in",
                obstacle.name,
                1e3 * depth
            ));
        }
    }
    warnings
}

fn covered_faces(driver: &Driver, layer: &LayerSpec) -> Result<Vec<FaceId>, StepperError> {
    let is_covered = |face: &FaceId| {
        let [a, b, c] = driver.uvs()[*face];
        layer.presence.covers((a + b + c) / 3.0)
    };
    let faces: Vec<FaceId> = driver.topology().faces().ids().filter(is_covered).collect();
    match faces.is_empty() {
        true => Err(StepperError::BlackMask {
            layer: layer.name.clone(),
        }),
        false => Ok(faces),
    }
}

/// How fine the layer's mesh will be.
struct LayerMesh {
    waves: Waves,
    /// Times the driver's faces are split in four where results are handed out.
    levels: u32,
    /// Edges to the shortest waves.
    points: f64,
    /// What they are limited by, for people.
    limit: String,
    vertices: usize,
    /// Vertices that would meet what was asked for.
    needed: f64,
}

impl LayerMesh {
    /// For a layer, and how it wrinkles, that covers `faces`.
    fn new(
        driver: &Driver,
        faces: &[FaceId],
        (layer, numbers): (&LayerSpec, &Wrinkling),
        modelling: &Modelling,
    ) -> Result<Self, StepperError> {
        let asked = modelling.points_per_wavelength;
        let [median, long] = edges(driver, faces);
        let needed_levels = |wavelength: f64| {
            let faces_at = |levels| faces.len() as f64 * 4f64.powi(levels as i32);
            let edges_at = |levels: u32| {
                let split = f64::from(1u32 << levels);
                (median / split, long / split)
            };
            // The layer is held to places of the lattice, not to a base with facets.
            needed_levels((wavelength / asked, None), modelling, faces_at, edges_at)
        };
        // Without paint and variation waves are the same everywhere.
        let seen = match layer.map.is_some() || layer.variation.is_some() {
            true => needed_levels(numbers.wavelength).min(readable_levels(faces.len())),
            false => 0,
        };
        let smoothing = modelling.smoothing;
        let waves = Waves::new(driver, faces, (layer, numbers), (seen, smoothing))?;
        let levels = needed_levels(waves.shortest);
        let budget = || format!("the vertex budget of {}", modelling.vertex_budget);
        let Some(limits) = modelling.remesh else {
            let vertices = (faces.len() << (2 * levels)) / 2;
            return Ok(Self {
                points: waves.shortest * f64::from(1u32 << levels) / median,
                limit: budget(),
                vertices,
                needed: vertices as f64,
                waves,
                levels,
            });
        };
        let needed = waves.vertices(asked, &limits);
        let coarseness = (needed / modelling.vertex_budget as f64).sqrt().max(1.0);
        let edge = (waves.shortest / asked).clamp(limits.min_edge, limits.max_edge);
        Ok(Self {
            points: waves.shortest / (edge * coarseness),
            limit: match coarseness > 1.0 {
                true => budget(),
                false => format!("the shortest edge of {:.2} mm", 1e3 * limits.min_edge),
            },
            vertices: (needed / (coarseness * coarseness)) as usize,
            needed,
            waves,
            levels,
        })
    }

    /// What the user should know, without the layer's name.
    fn warnings(&self, modelling: &Modelling, map_size: u32) -> Vec<String> {
        let asked = modelling.points_per_wavelength;
        let mut warnings = resolution_warnings(asked, self.waves.texels(map_size));
        if asked > WORTH_TELLING * self.points {
            warnings.push(format!(
                "{} leaves {:.1} points per wavelength of {asked} asked for",
                self.limit, self.points,
            ));
        }
        warnings
    }
}

/// Median and long edges of the faces, m.
fn edges(driver: &Driver, faces: &[FaceId]) -> [f64; 2] {
    let mut edges = Vec::new();
    for face in faces {
        let [a, b, c] = driver.topology().faces()[*face].map(|v| driver.rest()[v.index()]);
        edges.extend([(b - a).norm(), (c - b).norm(), (a - c).norm()]);
    }
    edges.sort_by(f64::total_cmp);
    [50, 95].map(|percent| edges[(edges.len() - 1) * percent / 100])
}

/// Splits up to which paint is read.
fn readable_levels(faces: usize) -> u32 {
    let fits = |levels: &u32| (faces << (2 * levels)) <= MAX_PLANNING_FACES;
    (1..MAX_LEVELS).take_while(fits).last().unwrap_or(0)
}
