//! The plan as a page: its pictures on the posed mesh, before anything is baked.

use std::path::Path;

use nalgebra::Vector2;
use ruga_io::write_atomically;
use ruga_preview::{Atlas, Legend, Overlay, PlanPreview, PlannedPose};
use ruga_scene::{Placement, Scene, ScenePlan};
use ruga_stepper::PlannedSurface;

use crate::canvas::Canvas;
use crate::error::CliError;
use crate::plan_painting::{
    COLOURS, RAMP, RAMP_ENDS, Square, check_name, layer_note, note as legend_note, refusal,
    surfaces, wrinkles,
};
use crate::preview_fault::PreviewFault;
use crate::table::duration;

/// Side of a picture, or of a tile in it, texels.
const SIDE: u32 = 1024;

/// Places along a side at which it is shown how wrinkles run.
const GRID: f64 = 32.0;

/// Writes the page of a plan to `path`, an HTML file, whole or not at all; `facts` is what is said of all poses.
///
/// # Errors
/// A plan without wrinkles or of a soft body, a file that cannot be written.
pub(crate) fn write(
    path: &Path,
    scene: &Scene,
    plan: &ScenePlan,
    facts: String,
) -> Result<(), CliError> {
    check_name(path, "pages are HTML files", "html")?;
    let surfaces = surfaces(path, scene, plan)?;
    let levels = levels(plan);
    if levels.is_empty() {
        return Err(refusal(
            path,
            "nothing wrinkles, so there is nothing to show",
        ));
    }
    let on_page = |source| {
        let folder = path.to_owned();
        CliError::from(PreviewFault::Page { folder, source })
    };
    let tiles: Vec<[i32; 2]> = match scene.is_tiled() {
        true => scene.tiles.iter().map(|tile| tile.origin()).collect(),
        false => Vec::new(),
    };
    let atlas = Atlas::new(SIDE, &tiles);
    let mut poses = Vec::new();
    for (pose, spec) in scene.poses.iter().enumerate() {
        let layers = plan.pose_layers(pose).into_iter();
        let layers = layers.filter(|layer| layer.vertices > 0);
        let note = |seconds: f64, note: String| format!("{note}, about {}", duration(seconds));
        let overlays = levels
            .iter()
            .map(|level| overlay((scene, &atlas), plan, &surfaces, [pose, level.0]));
        let named = spec.weights.iter().filter(|(_, weight)| *weight != 0.0);
        let shapes: Vec<&str> = scene.driver.shape_names().collect();
        poses.push(PlannedPose {
            name: spec.name.clone(),
            weights: named
                .map(|(shape, weight)| (shapes[shape].to_owned(), weight))
                .collect(),
            notes: layers
                .map(|layer| note(layer.seconds, layer_note(layer)))
                .collect(),
            overlays: overlays.collect::<Result<_, _>>().map_err(on_page)?,
        });
    }
    let page = PlanPreview {
        mesh: &scene.mesh.mesh,
        turn: Placement::of(&scene.mesh).turn,
        atlas,
        poses,
        layers: levels.into_iter().map(|(_, name)| name).collect(),
        legend: Legend {
            ramp: RAMP.to_vec(),
            ends: RAMP_ENDS.map(str::to_owned),
            colours: COLOURS
                .map(|(colour, text)| (colour, text.to_owned()))
                .to_vec(),
            note: legend_note(scene),
        },
        facts,
    };
    let html = page.to_html().map_err(on_page)?;
    Ok(write_atomically(path, html.as_bytes())?)
}

/// Numbers in their stacks of layers that wrinkle in some pose, with the names of those of all zones, which lie side
/// by side and are shown together.
fn levels(plan: &ScenePlan) -> Vec<(usize, String)> {
    let stacks = plan.zones.iter().flat_map(|zone| &zone.plan.poses);
    let highest = stacks.clone().map(|pose| pose.layers.len()).max();
    let named = (0..highest.unwrap_or(0)).map(|level| {
        let mut names: Vec<&str> = Vec::new();
        let layers = stacks.clone().filter_map(|pose| pose.layers.get(level));
        for layer in layers.filter(|layer| layer.vertices > 0) {
            if !names.contains(&layer.name.as_str()) {
                names.push(&layer.name);
            }
        }
        (level, names.join(", "))
    });
    named.filter(|(_, name)| !name.is_empty()).collect()
}

/// The picture of one pose on one level of all zones; `None` where nothing wrinkles.
fn overlay(
    (scene, atlas): (&Scene, &Atlas),
    plan: &ScenePlan,
    surfaces: &[PlannedSurface<'_>],
    [pose, level]: [usize; 2],
) -> Result<Option<Overlay>, ruga_preview::PreviewError> {
    let is_simulated = |zone: &usize| {
        let layers = &plan.zones[*zone].plan.poses[pose].layers;
        layers.get(level).is_some_and(|layer| layer.vertices > 0)
    };
    let zones = (0..plan.zones.len()).filter(is_simulated);
    let numbers: Vec<usize> = zones.collect();
    let zones = numbers
        .iter()
        .map(|&zone| surfaces[zone].faces(pose, level));
    let zones: Vec<_> = zones.collect();
    if zones.is_empty() {
        return Ok(None);
    }
    let mut canvas = Canvas::new(atlas.size(), atlas.size());
    let mut places = Vec::new();
    for (number, tile) in scene.tiles.iter().enumerate() {
        let square = Square {
            tile: *tile,
            origin: Vector2::from(atlas.origin(number).map(f64::from)),
            side: f64::from(atlas.side()),
            grid: GRID,
        };
        for faces in &zones {
            square.pad(&mut canvas, faces);
        }
        square.paint_layout(&mut canvas, scene.driver.uvs().as_slice());
        for faces in &zones {
            square.paint(&mut canvas, faces);
        }
        for &zone in &numbers {
            let layer = &scene.layers[plan.zones[zone].layers[level]];
            square.draw_creases(&mut canvas, layer, &scene.driver);
        }
        let wrinkled = zones.iter().flatten().filter(|face| wrinkles(face));
        let local = wrinkled.filter_map(|face| square.local(&face.uvs));
        places.extend(local.flatten().map(|uv| atlas.place(number, uv)));
    }
    let (_, colours) = canvas.finished();
    Overlay::new(atlas.size(), &colours, places).map(Some)
}
