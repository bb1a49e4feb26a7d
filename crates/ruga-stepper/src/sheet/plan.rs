//! What a sheet's simulation will be made of.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_mesh::{FaceId, Id, face_areas, mean_edge_lengths};
use ruga_shell::BendingModel;

use super::field_grid::levels;
use super::{Fire, Sheet};
use crate::error::{Checked, refuse};
use crate::plan::body_cost::cost;
use crate::plan::stacking::Stacking;
use crate::plan::surface_measures::faces_within;
use crate::skin::skin_mesh::sharp_map;
use crate::support::obstacle;
use crate::validation::{
    check_bends, check_growth, check_half, check_layer, check_map_size, check_modelling,
    check_pose, check_sheet_layer, check_sheet_pose,
};
use crate::{LayerPlan, LayerSpec, LoadPath, Modelling, Plan, PosePlan, PoseSpec, StepperError};

/// Edges along the longest side of a sheet that says nothing of them ([`Sheet::edge`]).
pub const SHEET_EDGES: f64 = 60.0;

/// Longest edges of a sheet that burns, over the width of the front, unless it says something else of them: across the
/// burning zone, of about two widths, its shrinkage then has four.
const FRONT_EDGES: f64 = 0.5;

/// Edges of a fresh sheet over those of a burning one from which on it pays to have two lengths.
const WORTH_IT: f64 = 1.5;

/// Widths of the front along which a sheet that burns has fine edges, as the plan has it: those around what burns and
/// those that are ahead of it.
const FINE_WIDTHS: f64 = 8.0;

/// Edges of triangles that are halved until none is too long, over the longest allowed: they end between half
/// and all of it.
const MEAN_EDGE: f64 = 0.75;

/// Finds out what a free sheet of one `layer` will be made of.
///
/// Nothing carries it: of the layer only material, map, variation, growths and creases count; the map's wavelength
/// does not. It covers all of the driver, which is its rest shape, flat or curved. Every load step begins where the
/// last one ended and ends in an equilibrium, or with [`Modelling::dynamics`] one step in time later.
///
/// # Errors
/// [`StepperError::Setting`] for a value out of range or that is no number, for blend-shape weights, anchors of
/// creases or growth of what lies below, and for a part of the sheet that nothing keeps from falling where it is to be in
/// equilibrium; motions of something that is not there; an obstacle without a shape.
pub fn plan_sheet(
    driver: &Arc<Driver>,
    layer: &LayerSpec,
    sheet: &Sheet,
    poses: &[PoseSpec],
    modelling: &Modelling,
    map_size: u32,
) -> Result<Plan, StepperError> {
    check_modelling(modelling)?;
    check_map_size(map_size)?;
    check_layer(layer)?;
    check_sheet_layer(layer)?;
    check_half(driver, poses, false)?;
    for pose in poses {
        check_pose(driver, pose)?;
        check_sheet_pose(pose)?;
        check_growth(layer, pose)?;
        check_bends(layer, pose, modelling.bending)?;
    }
    if let Some(fire) = &sheet.fire {
        check_fire(driver, layer, fire, poses, modelling)?;
    }
    sheet.obstacles.iter().try_for_each(obstacle::check)?;
    check(driver, sheet, modelling)?;
    for pose in poses {
        sheet.moves(pose)?;
    }
    let [edge, coarse] = sheet.edges(driver.rest());
    // Boundaries of a map are followed by an even mesh alone.
    let is_even = sharp_map(layer).is_some();
    let topology = driver.topology();
    let areas = face_areas(topology, driver.rest());
    let area: f64 = areas.as_slice().iter().sum();
    // A sheet has two triangles to a vertex, but for its border.
    let vertices = 0.5 * faces_within(area, MEAN_EDGE * edge);
    let vertices = (vertices as usize).max(topology.vertex_count());
    if vertices > modelling.vertex_budget {
        let accepted = format!(
            "longer edges: this takes about {vertices} vertices, and the vertex budget is {}",
            modelling.vertex_budget
        );
        refuse("sheet", "edge", format!("{edge} m"), accepted)?;
    }
    if let Some(fire) = &sheet.fire {
        // The artist's own edges may be shorter than those asked for.
        let own = mean_edge_lengths(topology, driver.rest());
        let own = own.iter().sum::<f64>() / own.len().max(1) as f64;
        let wanted = fire.front.width / fire.edges_per_width;
        let levels = levels(own.min(MEAN_EDGE * edge), wanted);
        check_fields(fire, (levels, vertices), modelling.vertex_budget)?;
    }
    let moving = match is_even || edge == coarse {
        true => vertices,
        // A front about as long as the sheet is wide.
        false => {
            let fine = FINE_WIDTHS * edge / FRONT_EDGES / area.sqrt();
            let fresh = 0.5 * faces_within(area, MEAN_EDGE * coarse);
            vertices.min((fine * vertices as f64 + fresh) as usize)
        }
    };
    let faces: Vec<FaceId> = topology.faces().ids().collect();
    let pose_plan = |pose: &PoseSpec| {
        let (per_step, memory) = cost(moving, None);
        PosePlan {
            name: pose.name.clone(),
            path: LoadPath::Weight,
            layers: vec![LayerPlan {
                name: layer.name.clone(),
                // A free sheet has no wavelength of its own.
                wavelength: f64::NAN,
                critical_strain: f64::NAN,
                painted: None,
                applied: None,
                active_area: area,
                vertices: moving,
                levels: 0,
                points_per_wavelength: f64::NAN,
                texels_per_wavelength: f64::NAN,
                seconds: per_step * f64::from(pose.steps),
                memory,
                asked_points: f64::NAN,
                needed: moving as f64,
                region: faces.iter().map(|face| u64::from(face.0)).collect(),
                output_edges: vec![edge; faces.len()],
                creases: vec![true; layer.creases.len()],
            }],
        }
    };
    let plan = Plan {
        poses: poses.iter().map(pose_plan).collect(),
        warnings: warnings((driver, sheet), modelling, map_size),
        interior: None,
        driver: Arc::clone(driver),
        modelling: modelling.clone(),
        specs: poses.to_vec(),
        stacking: Stacking::of_sheet(layer),
        planning_levels: 0,
        body: None,
        sheet: Some(Arc::new(Sheet {
            edge: if is_even { Some(edge) } else { sheet.edge },
            ..sheet.clone()
        })),
    };
    plan.check_boundaries()?;
    Ok(plan)
}

impl Sheet {
    /// Longest edges of its mesh where it burns, and elsewhere, m; the same twice where one length serves all of it, as
    /// without a fire, with an [`Self::edge`], or among obstacles, which new vertices would have to stay out of.
    /// `rest`: positions of the sheet's vertices at rest, m.
    pub fn edges(&self, rest: &[Vector3<f64>]) -> [f64; 2] {
        let even = longest_side(rest) / SHEET_EDGES;
        let of_front = |fire: &Fire| FRONT_EDGES * fire.front.width;
        let finest = self
            .fire
            .as_ref()
            .map_or(even, |fire| even.min(of_front(fire)));
        match self.edge {
            Some(edge) => [edge; 2],
            None if even < WORTH_IT * finest || !self.obstacles.is_empty() => [finest; 2],
            None => [finest, even],
        }
    }
}

fn check(driver: &Driver, sheet: &Sheet, modelling: &Modelling) -> Result<(), StepperError> {
    let of = "sheet";
    if let Some(value) = sheet.gravity.iter().find(|c| !c.is_finite()) {
        return refuse(of, "gravity", value, "finite numbers");
    }
    if let Some(edge) = sheet.edge.filter(|edge| !(*edge > 0.0 && edge.is_finite())) {
        return refuse(of, "edge", edge, "a length above 0, in metres");
    }
    // What lies in the way may hold what nothing else does.
    let may_fall = sheet.gravity.norm() > 0.0 && sheet.obstacles.is_empty();
    if may_fall && modelling.dynamics.is_none() {
        let parts = driver.topology().connected_parts(|_| true);
        let is_held = |part: &&Vec<FaceId>| {
            let corners = part
                .iter()
                .flat_map(|&face| driver.topology().faces()[face]);
            let mut places = corners.map(|v| &driver.rest()[v.index()]);
            places.any(|x| sheet.handles.iter().any(|handle| handle.holds(x)))
        };
        let held = parts.iter().filter(is_held).count();
        if held < parts.len() {
            let found = format!("what holds {held} of {} parts of the sheet", parts.len());
            let accepted = "a handle for each part, obstacles in its way, or motion in time: nothing else keeps it from falling";
            return refuse(of, "handles", found, accepted);
        }
    }
    Ok(())
}

/// Refuses what a fire on a layer cannot be simulated with.
fn check_fire(
    driver: &Driver,
    layer: &LayerSpec,
    fire: &Fire,
    poses: &[PoseSpec],
    modelling: &Modelling,
) -> Checked {
    fire.check(driver)?;
    poses.iter().try_for_each(|pose| fire.check_pose(pose))?;
    if modelling.dynamics.is_none() {
        let accepted = "motion in time (`mode = \"dynamic\"`), as a fire takes time";
        return refuse("burn", "mode", "equilibria", accepted);
    }
    if modelling.bending == BendingModel::Hinge {
        let accepted = "vertex curvature (`BendingModel::VertexCurvature`): hinges cannot curl";
        return refuse("burn", "bending", "hinges", accepted);
    }
    if let Some(crease) = layer.creases.first() {
        let found = format!("crease '{}'", crease.name);
        return refuse("burn", "creases", found, "none on a sheet that burns");
    }
    Ok(())
}

/// Refuses a mesh of temperature and fuel that is finer than the budget allows: that of the sheet, of so many
/// vertices, with its edges halved so often.
pub(super) fn check_fields(
    fire: &Fire,
    (levels, vertices): (u32, usize),
    budget: usize,
) -> Checked {
    let fields = 4_f64.powi(levels as i32) * vertices as f64;
    if levels == 0 || fields <= budget as f64 {
        return Ok(());
    }
    let wider = fire.front.width * (fields / budget as f64).sqrt();
    let accepted = format!(
        "from about {wider:.1e} m: its mesh takes {fields:.1e} vertices, and the vertex budget is {budget}"
    );
    refuse(
        "burn",
        "front_width",
        format!("{} m", fire.front.width),
        accepted,
    )
}

fn warnings(
    (driver, sheet): (&Driver, &Sheet),
    modelling: &Modelling,
    map_size: u32,
) -> Vec<String> {
    let is_loose = sheet.handles.is_empty() && sheet.obstacles.is_empty();
    let falls = sheet.gravity.norm() > 0.0 && is_loose && modelling.dynamics.is_some();
    let falling = falls.then(|| {
        let [x, y, z]: [f64; 3] = sheet.gravity.normalize().into();
        format!(
            "sheet: it is held nowhere and nothing is in its way, so that it falls for ever, towards [{x:.2}, {y:.2}, {z:.2}]; give it handles or obstacles"
        )
    });
    let of_fire = sheet.fire.iter().flat_map(|fire| {
        let of_steps = modelling.dynamics.and_then(|own| fire.leaps(own.time_step));
        fire.warnings(driver, map_size).into_iter().chain(of_steps)
    });
    falling.into_iter().chain(of_fire).collect()
}

/// Longest side of the upright box around some places, m.
pub(super) fn longest_side(places: &[Vector3<f64>]) -> f64 {
    let places = places.iter();
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let sides = (0..3).map(|axis| {
        let along = places.clone().map(|x| x[axis]);
        let [low, high] = along.fold(start, |[low, high], x| [low.min(x), high.max(x)]);
        high - low
    });
    sides.fold(0.0, f64::max)
}
