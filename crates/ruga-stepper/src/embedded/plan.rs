//! What a body's simulation will be made of.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{BaseSurface, Driver};
use ruga_lattice::LatticeError;
use ruga_material::{Wrinkling, wrinkling};
use ruga_mesh::{FaceId, Id};

use super::carrier::Carrier;
use super::handles::HeldNodes;
use super::lattice_size::lattice_warnings;
use super::obstacle::{self, distance};
use super::waves::Waves;
use crate::plan::{MAX_LEVELS, MAX_PLANNING_FACES, needed_levels, within};
use crate::plan_warnings::resolution_warnings;
use crate::skin_mesh::{check_boundaries, sharp_map};
use crate::validation::{PlannedFor, check_body_modelling, check_layer, check_map_size};
use crate::{Body, LayerSpec, Modelling, StepperError};

/// Edges over those asked for from which on a mesh is worth a warning.
const WORTH_TELLING: f64 = 1.1;

/// A body and its layer as they will be modelled.
#[derive(Clone, Debug)]
pub struct BodyPlan {
    /// Critical wavelength of the layer on its substrate, m.
    pub wavelength: f64,
    /// Critical strain.
    pub critical_strain: f64,
    /// Edges of the layer's mesh to its shortest waves: those asked for, or as many as the vertex budget
    /// and the limits of edges leave.
    pub points_per_wavelength: f64,
    /// Vertices of the layer, estimated.
    pub vertices: usize,
    /// Lattice elements.
    pub cells: usize,
    /// Lattice cells along the longest side.
    pub cells_along: u32,
    /// Edges of a lattice cell along x, y, z, m.
    pub cell_size: Vector3<f64>,
    /// Lattice nodes, held ones included.
    pub nodes: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
    pub(crate) wrinkling: Wrinkling,
    pub(crate) spec: LayerSpec,
    pub(crate) body: Body,
    pub(crate) carrier: Arc<Carrier>,
    pub(crate) held: HeldNodes,
    /// The driver's faces that the layer covers.
    pub(crate) faces: Vec<FaceId>,
    /// Times these are split in four where results are handed out.
    pub(crate) levels: u32,
    pub(crate) made_for: PlannedFor,
}

impl BodyPlan {
    /// The file's triangles that the layer covers, ascending.
    ///
    /// # Panics
    /// If `driver` is another than was planned for and has fewer faces.
    pub fn covered_triangles(&self, driver: &Driver) -> Vec<u32> {
        let faces = self.faces.iter();
        let mut triangles: Vec<u32> = faces.map(|face| driver.triangles()[*face]).collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }
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
/// handles that hold all of it, a sharp map whose boundaries are nearly everywhere.
pub fn plan_body(
    driver: &Driver,
    layer: &LayerSpec,
    body: &Body,
    modelling: &Modelling,
    map_size: u32,
) -> Result<BodyPlan, StepperError> {
    check_body_modelling(modelling)?;
    check_map_size(map_size)?;
    check_layer(layer)?;
    let layer = &within(layer, modelling.region.mask());
    let numbers = wrinkling(&layer.material, &layer.substrate, layer.model);
    let numbers = numbers.map_err(|source| StepperError::Material {
        layer: layer.name.clone(),
        source,
    })?;
    check(body)?;
    body.obstacles.iter().try_for_each(obstacle::check)?;
    let faces = covered_faces(driver, layer)?;
    let asked = modelling.points_per_wavelength;
    let [median, long] = edges(driver, &faces);
    let needed = |wavelength: f64| {
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
        true => needed(numbers.wavelength).min(readable_levels(faces.len())),
        false => 0,
    };
    let waves = Waves::new(
        driver,
        &faces,
        (layer, &numbers),
        (seen, modelling.smoothing),
    )?;
    let carrier = Carrier::new(driver, body, waves.longest, modelling.smoothing)?;
    let held = HeldNodes::new(&carrier.lattice, &body.handles)?;
    let levels = needed(waves.shortest);
    let mesh = LayerMesh::new((median, faces.len(), levels), &waves, modelling);
    if sharp_map(layer).is_some() {
        let surface = BaseSurface::new(driver, &faces, levels, modelling.smoothing);
        check_boundaries(driver, &surface, layer)?;
    }
    let lattice = &carrier.lattice;
    let mut warnings = lattice_warnings(&carrier, body, waves.longest);
    let covered = (faces.len(), layer.material.thickness);
    warnings.extend(obstacle_warnings(driver, body, covered));
    let of_layer = |text: String| format!("layer '{}': {text}", layer.name);
    let resolution = resolution_warnings(asked, waves.texels(map_size));
    warnings.extend(resolution.into_iter().map(of_layer));
    if asked > WORTH_TELLING * mesh.points {
        warnings.push(of_layer(format!(
            "{} leaves {:.1} points per wavelength of {asked} asked for",
            mesh.limit, mesh.points,
        )));
    }
    Ok(BodyPlan {
        wavelength: numbers.wavelength,
        critical_strain: numbers.critical_strain,
        points_per_wavelength: mesh.points,
        vertices: mesh.vertices,
        cells: lattice.element_count(),
        cells_along: carrier.cells,
        cell_size: lattice.cell_size(),
        nodes: lattice.node_count(),
        warnings,
        wrinkling: numbers,
        spec: layer.clone(),
        body: body.clone(),
        held,
        faces,
        levels,
        carrier: Arc::new(carrier),
        made_for: PlannedFor::new(driver, &[], modelling),
    })
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
    /// Edges to the shortest waves.
    points: f64,
    /// What they are limited by, for people.
    limit: String,
    vertices: usize,
}

impl LayerMesh {
    /// With the faces' median edge (m), their number, and how often they are split where results are
    /// handed out.
    fn new((edge, faces, levels): (f64, usize, u32), waves: &Waves, modelling: &Modelling) -> Self {
        let budget = || format!("the vertex budget of {}", modelling.vertex_budget);
        let Some(limits) = modelling.remesh else {
            return Self {
                points: waves.shortest * f64::from(1u32 << levels) / edge,
                limit: budget(),
                vertices: (faces << (2 * levels)) / 2,
            };
        };
        let asked = modelling.points_per_wavelength;
        let needed = waves.vertices(asked, &limits);
        let coarseness = (needed / modelling.vertex_budget as f64).sqrt().max(1.0);
        let edge = (waves.shortest / asked).clamp(limits.min_edge, limits.max_edge);
        Self {
            points: waves.shortest / (edge * coarseness),
            limit: match coarseness > 1.0 {
                true => budget(),
                false => format!("the shortest edge of {:.2} mm", 1e3 * limits.min_edge),
            },
            vertices: (needed / (coarseness * coarseness)) as usize,
        }
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
