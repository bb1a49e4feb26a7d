//! The plan as a picture: what every pose asks of the skin, on the mesh's texture layout.

use std::collections::BTreeSet;
use std::path::Path;

use nalgebra::Vector2;
use ruga_io::{PngTexels, write_png};
use ruga_material::UvTile;
use ruga_scene::{Scene, ScenePlan};
use ruga_stepper::{PlannedFace, Treatment};

use crate::canvas::{Canvas, Words};
use crate::error::CliError;
use crate::plan_painting::{
    COLOURS, MOST, RAMP_ENDS, Square, check_name, layer_note, note, ramp, refusal, surfaces,
};

/// Side of a panel.
const SIDE: u32 = 600;

/// Panels of a picture: eight rows of eight still can be looked at.
const MOST_PANELS: usize = 64;

/// Height of a panel's heading.
const HEADING: u32 = 36;

/// White between panels, and around them.
const GAP: u32 = 16;

/// Height of the legend.
const LEGEND: u32 = 84;

/// Width that the legend's words need.
const LEAST_WIDTH: u32 = 1240;

/// Height of letters.
const LETTERS: f64 = 17.0;

/// Places along a side of a panel at which it is shown how wrinkles run.
const GRID: f64 = 16.0;

/// Widths that the names of the single colours need.
const WIDTHS: [f64; 4] = [160.0, 190.0, 230.0, 300.0];

/// A pose and a layer that it wrinkles.
struct Panel {
    pose: usize,
    /// Number of the zone, and of the layer in its stack.
    place: [usize; 2],
    heading: String,
}

/// Writes the picture of a plan to `path`, a PNG: a panel for every pose and layer with wrinkles, in the order of
/// the scene.
///
/// # Errors
/// A plan without wrinkles or of a soft body, a file that cannot be written.
pub(crate) fn write(path: &Path, scene: &Scene, plan: &ScenePlan) -> Result<(), CliError> {
    check_name(path, "pictures are PNG files", "png")?;
    let surfaces = surfaces(path, scene, plan)?;
    let panels = panels(scene, plan);
    if panels.is_empty() {
        return Err(refusal(
            path,
            "nothing wrinkles, so there is nothing to show",
        ));
    }
    if panels.len() > MOST_PANELS {
        let reason = format!(
            "{} poses and layers wrinkle, and a picture shows at most {MOST_PANELS}; choose some with `--pose`",
            panels.len()
        );
        return Err(refusal(path, &reason));
    }
    let columns = (panels.len() as f64).sqrt().ceil() as u32;
    let rows = (panels.len() as u32).div_ceil(columns);
    let width = (GAP + columns * (SIDE + GAP)).max(LEAST_WIDTH);
    let mut canvas = Canvas::new(width, GAP + rows * (HEADING + SIDE + GAP) + LEGEND);
    let mut words = Vec::new();
    for (number, panel) in (0..).zip(&panels) {
        let [column, row] = [number % columns, number / columns];
        let corner = [
            GAP + column * (SIDE + GAP),
            GAP + row * (HEADING + SIDE + GAP),
        ];
        let corner = Vector2::from(corner.map(f64::from));
        words.push(line(
            &panel.heading,
            corner + Vector2::y() * 0.5 * f64::from(HEADING),
        ));
        let origin = corner + Vector2::y() * f64::from(HEADING);
        let [zone, layer] = panel.place;
        let faces = surfaces[zone].faces(panel.pose, layer);
        let tiles = tiles_shown(scene, &faces);
        // Tiles beside each other, in as many rows as columns.
        let columns = (tiles.len() as f64).sqrt().ceil().max(1.0);
        for (number, tile) in tiles.into_iter().enumerate() {
            let place = number as f64;
            let cell = Vector2::new(place % columns, (place / columns).floor());
            let side = f64::from(SIDE) / columns;
            let square = Square {
                tile,
                origin: origin + cell * side,
                side,
                grid: GRID,
            };
            square.paint_layout(&mut canvas, scene.driver.uvs().as_slice());
            square.paint(&mut canvas, &faces);
            let layer = &scene.layers[plan.zones[zone].layers[layer]];
            square.draw_creases(&mut canvas, layer, &scene.driver);
            if scene.is_tiled() {
                let at = square.origin + Vector2::repeat(LETTERS);
                words.push(line(&tile.number().to_string(), at));
            }
        }
    }
    let top = f64::from(GAP + rows * (HEADING + SIDE + GAP));
    words.extend(legend(&mut canvas, top, &note(scene)));
    canvas.words(&words);
    let (size, bytes) = canvas.finished();
    let [width, height] = size.map(|side| side as usize);
    Ok(write_png(path, width, height, PngTexels::Rgb8(&bytes))?)
}

/// The poses and layers with wrinkles, in the order of the scene.
fn panels(scene: &Scene, plan: &ScenePlan) -> Vec<Panel> {
    let mut panels = Vec::new();
    for (pose, spec) in scene.poses.iter().enumerate() {
        for (zone, stack) in plan.zones.iter().enumerate() {
            let layers = stack.plan.poses[pose].layers.iter().enumerate();
            for (layer, planned) in layers.filter(|(_, planned)| planned.vertices > 0) {
                panels.push(Panel {
                    pose,
                    place: [zone, layer],
                    heading: format!("{}, {}", spec.name, layer_note(planned)),
                });
            }
        }
    }
    panels
}

fn line(text: &str, at: Vector2<f64>) -> Words {
    Words {
        text: text.to_owned(),
        at,
        height: LETTERS,
    }
}

/// The tiles of a panel: those with simulated skin, or the first one.
fn tiles_shown(scene: &Scene, faces: &[PlannedFace]) -> Vec<UvTile> {
    let is_simulated = |face: &&PlannedFace| !matches!(face.treatment, Treatment::Smooth);
    let simulated = faces.iter().filter(is_simulated);
    let shown: BTreeSet<UvTile> = simulated
        .filter_map(|face| UvTile::of_triangle(&face.uvs))
        .collect();
    let mut tiles = scene.tiles.clone();
    tiles.retain(|tile| shown.contains(tile));
    if tiles.is_empty() {
        tiles.push(scene.tiles[0]);
    }
    tiles
}

/// Draws the legend and returns its words.
fn legend(canvas: &mut Canvas, top: f64, note: &str) -> Vec<Words> {
    let mut words = Vec::new();
    let left = f64::from(GAP);
    let (bar, height) = (300.0, 20.0);
    for step in 0..bar as u32 {
        let x = left + f64::from(step);
        let ratio = MOST.powf(f64::from(step) / bar);
        let corners = [Vector2::new(x, top), Vector2::new(x + 1.0, top + height)];
        canvas.rectangle(corners, ramp(ratio));
    }
    let below = top + 1.7 * height;
    words.push(line(RAMP_ENDS[0], Vector2::new(left, below)));
    words.push(line(RAMP_ENDS[1], Vector2::new(left + bar - 100.0, below)));
    words.push(line(note, Vector2::new(left, top + 3.0 * height)));
    let mut x = left + bar + 40.0;
    for ((colour, text), width) in COLOURS.into_iter().zip(WIDTHS) {
        let corner = Vector2::new(x, top);
        canvas.rectangle([corner, corner + Vector2::repeat(height)], colour);
        words.push(line(
            text,
            corner + Vector2::new(1.4 * height, 0.5 * height),
        ));
        x += width;
    }
    words
}
