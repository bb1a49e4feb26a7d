//! What a body's simulation will be made of.

use std::sync::Arc;

use ruga_blend::Driver;
use ruga_lattice::LatticeError;
use ruga_mesh::{FaceId, Id};

use super::body_cost::cost;
use super::waves::Waves;
use crate::plan::crease_places::put_under_drawn_lines;
use crate::plan::stacking::Stacking;
use crate::plan::surface_measures::{
    MAX_LEVELS, MAX_PLANNING_FACES, faces_within, needed_levels, output_coarseness,
};
use crate::plan::warnings::resolution_warnings;
use crate::plan::{add_carried_along, within};
use crate::run::adaptivity::aspect;
use crate::skin::skin_mesh::OUTPUT_SLACK;
use crate::support::Interior;
use crate::support::embedding_lattice::EmbeddingLattice;
use crate::support::handles::{HeldNodes, Moves};
use crate::support::lattice_size::lattice_warnings;
use crate::support::obstacle::{self, distance};
use crate::validation::{
    check_anchor_depths, check_anchors, check_body_modelling, check_carried, check_grows,
    check_growth, check_half, check_layer, check_map_size, check_pose, check_slits,
    check_unabsorbing,
};
use crate::{
    Body, InteriorPlan, LayerPlan, LayerSpec, LoadPath, Modelling, Plan, PosePlan, PoseSpec,
    StepperError,
};

/// Edges over those asked for from which on a mesh is worth a warning.
const WORTH_TELLING: f64 = 1.1;

/// Finds out what a body under `layers` will be made of: its lattice, and the layers' meshes.
///
/// Every layer covers the whole surface, or the faces on which its masks and that of
/// [`Modelling::region`] let it be; borders of a mask are free. The lowest layer's substrate stands
/// for the interior at the scale of the wrinkles, which the lattice does not resolve, and
/// [`Body::material`] for it at the scale of the body: the two are meant to be the same stuff. That
/// layer moves together with the body; those above are solved on it, one on the other, or two at once
/// ([`Stack::Joint`](crate::Stack::Joint)). A lattice without a number of cells has as many as let the
/// body bend, as long as they are longer than the lowest layer's waves. A map of a layer counts
/// everywhere, but for a twentieth of the area with the shortest waves and one with the longest.
/// `map_size` (texels) is only for the warning about too small a map.
///
/// # Errors
/// [`StepperError::Setting`] for a value out of range or that is no number, before any work is done, for an anchor or a
/// slit of a crease that is deeper than the body there, and for a slit that is shallower than a cell or meets another;
/// a bad material, no layer, a black mask, a surface that does not enclose a body, a handle without cells, handles that
/// hold all of it, a sharp map whose boundaries are nearly everywhere; a motion of something that is not there, or whose
/// keyframes do not ascend; an obstacle without a shape.
pub fn plan_body(
    driver: &Arc<Driver>,
    layers: &[LayerSpec],
    body: &Body,
    poses: &[PoseSpec],
    modelling: &Modelling,
    map_size: u32,
) -> Result<Plan, StepperError> {
    check_body_modelling(modelling)?;
    check_map_size(map_size)?;
    if layers.is_empty() {
        return Err(StepperError::NoLayer);
    }
    layers.iter().try_for_each(check_layer)?;
    layers.iter().try_for_each(check_anchors)?;
    layers.iter().try_for_each(check_unabsorbing)?;
    layers.iter().try_for_each(check_slits)?;
    check_half(driver, poses, false)?;
    for pose in poses {
        check_pose(driver, pose)?;
        layers
            .iter()
            .try_for_each(|layer| check_growth(layer, pose))?;
    }
    layers.iter().try_for_each(check_grows)?;
    layers.iter().try_for_each(check_carried)?;
    let region = modelling.region.mask();
    let layers: Vec<LayerSpec> = layers.iter().map(|layer| within(layer, region)).collect();
    let mut stacking = Stacking::new(&layers, modelling.stack)?;
    put_under_drawn_lines(driver, modelling.smoothing, &mut stacking);
    check(body)?;
    body.obstacles.iter().try_for_each(obstacle::check)?;
    for pose in poses {
        // Every run makes them again. Here they only show that names and keyframes are right.
        Moves::of_body(body, pose)?;
    }
    let meshes = (0..stacking.meshes())
        .map(|index| LayerMesh::new(driver, &stacking, index, modelling))
        .collect::<Result<Vec<_>, _>>()?;
    // Two layers that move together wrinkle in a longer wave than either.
    let longest = meshes[0]
        .waves
        .longest
        .max(stacking.wrinkling[0].wavelength);
    let embedding_lattice = EmbeddingLattice::new(driver, body, longest, modelling.smoothing)?;
    let flesh = stacking.specs.iter();
    let flesh = flesh.map(|layer| embedding_lattice.flesh_below(driver, &layer.creases));
    let flesh: Vec<Vec<f64>> = flesh.collect();
    for (layer, flesh) in stacking.specs.iter().zip(&flesh) {
        check_anchor_depths(layer, flesh)?;
    }
    let on = (driver.as_ref(), modelling.smoothing);
    let embedding_lattice = embedding_lattice.with_slits(on, body, &stacking.specs, &flesh)?;
    let held = HeldNodes::new(&embedding_lattice.lattice, &body.handles)?;
    let lattice = &embedding_lattice.lattice;
    let interior = InteriorPlan {
        cells: lattice.element_count(),
        cells_along: embedding_lattice.cells,
        cell_size: lattice.cell_size(),
        nodes: lattice.node_count(),
    };
    let mut warnings = stacking.warnings(modelling.stack);
    let cells = (lattice, embedding_lattice.cells, &embedding_lattice.sides);
    warnings.extend(lattice_warnings(cells, body, longest));
    let covered = (meshes[0].faces.len(), layers[0].material.thickness);
    warnings.extend(obstacle_warnings(driver, body, covered));
    for (layer, mesh) in layers.iter().zip(&meshes) {
        let told = mesh.warnings(map_size).into_iter();
        warnings.extend(told.map(|text| format!("layer '{}': {text}", layer.name)));
    }
    let pose_plan = |pose: &PoseSpec| {
        let on = (&interior, map_size, pose.steps);
        let layers = meshes.iter().enumerate();
        let layers = layers.map(|(index, mesh)| mesh.plan(&stacking, index, on));
        let mut pose = PosePlan {
            name: pose.name.clone(),
            path: LoadPath::Weight,
            layers: layers.collect(),
        };
        add_carried_along(&mut pose, &stacking);
        pose
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
        body: Some(Arc::new(Interior {
            body: body.clone(),
            embedding_lattice,
            held,
        })),
        sheet: None,
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

/// Warnings of what keeps obstacles from pressing as meant on a layer of this thickness (m) that
/// covers so many faces.
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
        // A vertex that is more than a thickness inside an obstacle counts as having passed through
        // it, and no load step that ends like that is kept.
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

/// Resolution of the mesh of a layer.
struct LayerMesh {
    /// The driver's faces that it covers.
    faces: Vec<FaceId>,
    waves: Waves,
    /// Edges per wavelength asked for.
    asked: f64,
    /// Times the driver's faces are split in four for the output mesh.
    levels: u32,
    /// Longest edge that this mesh may have after that, m, if it is not to stay uniform.
    output_edge: Option<f64>,
    /// Edges to the shortest waves.
    points: f64,
    /// Limit that they reach, for messages.
    limit: String,
    vertices: usize,
    /// Vertices that would meet what was asked for.
    needed: f64,
}

impl LayerMesh {
    /// Resolves layer number `index` of a stack.
    fn new(
        driver: &Driver,
        stacking: &Stacking,
        index: usize,
        modelling: &Modelling,
    ) -> Result<Self, StepperError> {
        let (layer, wrinkling) = (&stacking.specs[index], &stacking.simulated[index]);
        let faces = covered_faces(driver, layer)?;
        let asked = modelling.points_of(index, stacking.meshes());
        let [median, long] = edges(driver, &faces);
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
            true => needed_levels(wrinkling.wavelength).min(readable_levels(faces.len())),
            false => 0,
        };
        let smoothing = modelling.smoothing;
        let waves = Waves::new(driver, &faces, (layer, wrinkling), (seen, smoothing))?;
        let levels = needed_levels(waves.shortest);
        let budget = || format!("the vertex budget of {}", modelling.vertex_budget);
        let Some(limits) = modelling.remesh else {
            // A closed surface has two triangles to a vertex.
            let vertices = (faces.len() << (2 * levels)) / 2;
            return Ok(Self {
                points: waves.shortest * f64::from(1u32 << levels) / median,
                limit: budget(),
                vertices,
                needed: vertices as f64,
                faces,
                asked,
                waves,
                levels,
                output_edge: None,
            });
        };
        let output_edge = OUTPUT_SLACK * (waves.shortest / asked).max(limits.min_edge);
        // A closed surface has two triangles to a vertex.
        let output_vertices = 0.5 * faces_within(waves.area(), output_edge);
        // Where the body will compress its layer is not known before it is simulated. So wrinkles
        // are counted everywhere, in one direction each.
        let needed = waves.vertices(asked, &limits) / aspect(&limits, asked);
        // The number of vertices goes with the inverse square of the edge.
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
            faces,
            asked,
            waves,
            levels: 0,
            output_edge: Some(output_edge * output_coarseness(output_vertices, modelling)),
        })
    }

    /// The plan of layer number `index` over so many load steps, with maps of that size.
    fn plan(
        &self,
        stacking: &Stacking,
        index: usize,
        (interior, map_size, steps): (&InteriorPlan, u32, u32),
    ) -> LayerPlan {
        // The lowest layer is solved together with the body.
        let below = (index == 0).then_some(interior);
        let (per_step, memory) = cost(self.vertices, below);
        let wrinkling = &stacking.wrinkling[index];
        LayerPlan {
            name: stacking.specs[index].name.clone(),
            wavelength: wrinkling.wavelength,
            critical_strain: wrinkling.critical_strain,
            painted: None,
            applied: None,
            active_area: self.waves.area(),
            vertices: self.vertices,
            levels: self.levels,
            points_per_wavelength: self.points,
            texels_per_wavelength: self.waves.texels(map_size),
            seconds: per_step * f64::from(steps),
            memory,
            asked_points: self.asked,
            needed: self.needed,
            region: self.faces.iter().map(|face| u64::from(face.0)).collect(),
            output_edges: match self.output_edge {
                Some(edge) => vec![edge; self.faces.len()],
                None => Vec::new(),
            },
            creases: Vec::new(),
        }
    }

    /// Warnings, without the layer's name.
    fn warnings(&self, map_size: u32) -> Vec<String> {
        let asked = self.asked;
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
