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
use crate::skin_mesh::{check_boundaries, sharp_map};
use crate::{Body, LayerSpec, Modelling, Region, StepperError};

/// Vertices of the mesh that a fitted one is handed out on, in vertex budgets.
const HANDED_OUT: f64 = 4.0;

/// Splits of one face in four, at most.
const MAX_LEVELS: u32 = 10;

/// Edges over those asked for from which on a mesh is worth a warning.
const WORTH_TELLING: f64 = 1.1;

/// A body and its layer as they will be modelled.
#[derive(Clone, Debug)]
pub struct BodyPlan {
    /// Critical wavelength of the layer on its substrate, m.
    pub wavelength: f64,
    /// Critical strain.
    pub critical_strain: f64,
    /// Length of the layer's edges, m: the share of a wavelength that is asked for, or as much
    /// longer as the vertex budget needs.
    pub edge: f64,
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
}

impl BodyPlan {
    /// The file's triangles that the layer covers, ascending.
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
/// The layer covers the whole surface, or the faces on which the mask of
/// [`Modelling::region`] is at least one half; borders of a mask are free. `layer.substrate` stands
/// for the interior at the scale of the wrinkles, which the lattice does not resolve, and
/// [`Body::material`] for it at the scale of the body: the two are meant to be the same stuff. A
/// lattice without a number of cells has as many as let the body bend, as long as they are longer than
/// its waves.
///
/// # Errors
/// A bad material, a black mask, a surface that does not enclose a body, a handle without cells,
/// handles that hold all of it, a sharp map whose boundaries are nearly everywhere.
pub fn plan_body(
    driver: &Driver,
    layer: &LayerSpec,
    body: &Body,
    modelling: &Modelling,
) -> Result<BodyPlan, StepperError> {
    let numbers = wrinkling(&layer.material, &layer.substrate, layer.model);
    let numbers = numbers.map_err(|source| StepperError::Material {
        layer: layer.name.clone(),
        source,
    })?;
    check(body)?;
    body.obstacles.iter().try_for_each(obstacle::check)?;
    let faces = covered_faces(driver, modelling)?;
    let carrier = Carrier::new(driver, body, numbers.wavelength, modelling.smoothing)?;
    let held = HeldNodes::new(&carrier.lattice, &body.handles)?;
    let asked = numbers.wavelength / modelling.points_per_wavelength;
    let mesh = LayerMesh::new(driver, &faces, asked, modelling);
    if sharp_map(layer).is_some() {
        let surface = BaseSurface::new(driver, &faces, mesh.levels, modelling.smoothing);
        check_boundaries(driver, &surface, layer)?;
    }
    let lattice = &carrier.lattice;
    let mut warnings = lattice_warnings(&carrier, body, numbers.wavelength);
    let covered = (faces.len(), layer.material.thickness);
    warnings.extend(obstacle_warnings(driver, body, covered));
    if mesh.edge > WORTH_TELLING * asked {
        warnings.push(format!(
            "layer '{}': the vertex budget of {} leaves {:.1} points per wavelength of {} asked for",
            layer.name,
            modelling.vertex_budget,
            numbers.wavelength / mesh.edge,
            modelling.points_per_wavelength
        ));
    }
    Ok(BodyPlan {
        wavelength: numbers.wavelength,
        critical_strain: numbers.critical_strain,
        edge: mesh.edge,
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
        levels: mesh.levels,
        carrier: Arc::new(carrier),
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

fn covered_faces(driver: &Driver, modelling: &Modelling) -> Result<Vec<FaceId>, StepperError> {
    let faces = driver.topology().faces().ids();
    let Region::Mask(mask) = &modelling.region else {
        return Ok(faces.collect());
    };
    let is_white = |face: &FaceId| {
        let [a, b, c] = driver.uvs()[*face];
        mask.at((a + b + c) / 3.0) >= 0.5
    };
    let faces: Vec<FaceId> = faces.filter(is_white).collect();
    match faces.is_empty() {
        true => Err(StepperError::BlackMask),
        false => Ok(faces),
    }
}

/// How fine the layer's mesh will be.
struct LayerMesh {
    edge: f64,
    vertices: usize,
    levels: u32,
}

impl LayerMesh {
    fn new(driver: &Driver, faces: &[FaceId], asked: f64, modelling: &Modelling) -> Self {
        let (mut area, mut edges) = (0.0, Vec::new());
        for face in faces {
            let [a, b, c] = driver.topology().faces()[*face].map(|v| driver.rest()[v.index()]);
            area += 0.5 * (b - a).cross(&(c - a)).norm();
            edges.extend([(b - a).norm(), (c - b).norm(), (a - c).norm()]);
        }
        edges.sort_by(f64::total_cmp);
        let quantile = |percent: usize| edges[(edges.len() - 1) * percent / 100];
        let (median, long) = (quantile(50), quantile(95));
        let budget = modelling.vertex_budget as f64;
        let shown = match modelling.remesh {
            Some(_) => HANDED_OUT * budget,
            None => budget,
        };
        let is_coarse = |levels: u32| {
            let split = f64::from(1u32 << levels);
            median / split > 1.1 * asked || long / split > 1.65 * asked
        };
        let vertices_at = |levels: u32| 0.5 * faces.len() as f64 * 4f64.powi(levels as i32);
        let mut levels = 0;
        while is_coarse(levels) && levels < MAX_LEVELS && vertices_at(levels + 1) <= shown {
            levels += 1;
        }
        if modelling.remesh.is_none() {
            return Self {
                edge: median / f64::from(1u32 << levels),
                vertices: vertices_at(levels) as usize,
                levels,
            };
        }
        // Of equilateral triangles.
        let needed = area / (0.75f64.sqrt() * asked * asked);
        let coarseness = (needed / budget).sqrt().max(1.0);
        Self {
            edge: asked * coarseness,
            vertices: (needed / (coarseness * coarseness)) as usize,
            levels,
        }
    }
}
