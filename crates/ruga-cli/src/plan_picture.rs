//! The plan as a picture: what every pose asks of the skin, on the mesh's texture layout.

use std::collections::BTreeSet;
use std::path::Path;

use nalgebra::Vector2;
use ruga_io::{PngTexels, write_png};
use ruga_material::UvTile;
use ruga_scene::{Scene, SceneError, ScenePlan};
use ruga_stepper::{LayerPlan, PlannedFace, Treatment};

use crate::canvas::{Canvas, Colour, INK, Words};
use crate::error::CliError;

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

/// Wavelength in pixels below which lines as far apart would merge.
const FINEST: f64 = 3.0;

/// Strain over the critical one at which the ramp of colours ends.
const MOST: f64 = 5.0;

/// Why a body has no picture.
const ON_A_BODY: &str = "the strain on a soft body is known only when it is simulated; a picture shows layers on a posed mesh";

/// Skin that is not simulated.
const SMOOTH: Colour = [232, 232, 232];

/// Simulated skin that does not wrinkle.
const MARGIN: Colour = [198, 219, 239];

/// Folds of the artist.
const FOLDED: Colour = [20, 20, 20];

/// Compression beyond what is simulated.
const CAPPED: Colour = [136, 65, 157];

/// Colours from where skin begins to wrinkle up to [`MOST`] critical strains.
const RAMP: [Colour; 4] = [[255, 237, 160], [254, 178, 76], [240, 89, 40], [177, 0, 38]];

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
    let refuse = |reason: &str| CliError::NoPicture {
        path: path.to_owned(),
        reason: reason.to_owned(),
    };
    if !path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("png"))
    {
        return Err(refuse(
            "pictures are PNG files, with a name that ends in `.png`",
        ));
    }
    if plan.interior().is_some() {
        return Err(refuse(ON_A_BODY));
    }
    let panels = panels(scene, plan);
    if panels.is_empty() {
        return Err(refuse("nothing wrinkles, so there is nothing to show"));
    }
    if panels.len() > MOST_PANELS {
        let reason = format!(
            "{} poses and layers wrinkle, and a picture shows at most {MOST_PANELS}; choose some with `--pose`",
            panels.len()
        );
        return Err(refuse(&reason));
    }
    let columns = (panels.len() as f64).sqrt().ceil() as u32;
    let rows = (panels.len() as u32).div_ceil(columns);
    let width = (GAP + columns * (SIDE + GAP)).max(LEAST_WIDTH);
    let mut canvas = Canvas::new(width, GAP + rows * (HEADING + SIDE + GAP) + LEGEND);
    let mut surfaces = Vec::new();
    for zone in &plan.zones {
        let surface = zone.plan.surface().map_err(|source| SceneError::Model {
            scene: scene.path.clone(),
            source: Box::new(source),
        })?;
        surfaces.push(surface.ok_or_else(|| refuse(ON_A_BODY))?);
    }
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
                corner: origin + cell * side,
                side,
            };
            square.draw(&mut canvas, scene.driver.uvs().as_slice(), &faces);
            if scene.is_tiled() {
                let at = square.corner + Vector2::repeat(LETTERS);
                words.push(line(&tile.number().to_string(), at));
            }
        }
    }
    let top = f64::from(GAP + rows * (HEADING + SIDE + GAP));
    words.extend(legend(&mut canvas, top));
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
                    heading: heading(&spec.name, planned),
                });
            }
        }
    }
    panels
}

fn heading(pose: &str, layer: &LayerPlan) -> String {
    let millimetres = |length: f64| format!("{:.1}", 1e3 * length);
    let [low, high] = match layer.painted {
        Some(painted) => painted.wavelength.map(millimetres),
        None => [0, 1].map(|_| millimetres(layer.wavelength)),
    };
    let waves = match low == high {
        true => low,
        false => format!("{low} to {high}"),
    };
    let area = 1e4 * layer.active_area;
    format!(
        "{pose}, {}: waves of {waves} mm on {area:.0} cm2",
        layer.name
    )
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

/// Place of one tile in the picture.
struct Square {
    tile: UvTile,
    /// Its upper left corner.
    corner: Vector2<f64>,
    /// Its side in pixels.
    side: f64,
}

impl Square {
    /// Draws the mesh's texture layout in the tile, what is done on it, and how wrinkles run.
    fn draw(&self, canvas: &mut Canvas, layout: &[[Vector2<f64>; 3]], faces: &[PlannedFace]) {
        let place = |uv: &Vector2<f64>| self.corner + uv * self.side;
        for uvs in layout.iter().filter_map(|uvs| self.local(uvs)) {
            canvas.triangle(uvs.each_ref().map(place), SMOOTH);
        }
        let shown = faces
            .iter()
            .filter_map(|face| Some((face, self.local(&face.uvs)?)));
        let shown: Vec<(&PlannedFace, [Vector2<f64>; 3])> = shown.collect();
        for (face, uvs) in &shown {
            if let Some(colour) = colour(face) {
                canvas.triangle(uvs.each_ref().map(place), colour);
            }
        }
        for (face, uvs) in shown.iter().filter(|(face, _)| wrinkles(face)) {
            for uv in grid_points(uvs) {
                // One wavelength apart; waves that a panel cannot show get one line.
                let across = face.across * self.side;
                let Some(along) = face.along.try_normalize(0.0) else {
                    continue;
                };
                let half = 0.35 * self.side / GRID * along;
                let sides: &[f64] = match across.norm() < FINEST {
                    true => &[0.0],
                    false => &[-0.5, 0.5],
                };
                for side in sides {
                    let middle = place(&uv) + across * *side;
                    canvas.stroke([middle - half, middle + half], 1.5, INK);
                }
            }
        }
    }

    /// The corners of a triangle in the tile, if it lies there.
    fn local(&self, uvs: &[Vector2<f64>; 3]) -> Option<[Vector2<f64>; 3]> {
        let local = uvs.each_ref().map(|uv| self.tile.local(uv));
        local.iter().all(is_shown).then_some(local)
    }
}

/// Whether a place relative to a tile is in it.
fn is_shown(uv: &Vector2<f64>) -> bool {
    uv.iter().all(|value| (0.0..=1.0).contains(value))
}

fn wrinkles(face: &PlannedFace) -> bool {
    let is_simulated = matches!(face.treatment, Treatment::Simulated | Treatment::Capped);
    is_simulated && face.strain_ratio > 1.0
}

fn colour(face: &PlannedFace) -> Option<Colour> {
    match face.treatment {
        Treatment::Smooth => None,
        Treatment::Folded => Some(FOLDED),
        Treatment::Capped => Some(CAPPED),
        Treatment::Simulated if face.strain_ratio > 1.0 => Some(ramp(face.strain_ratio)),
        Treatment::Simulated => Some(MARGIN),
    }
}

/// Colour of a strain in critical strains, by doublings.
fn ramp(ratio: f64) -> Colour {
    let last = RAMP.len() - 1;
    let place = (ratio.log2() / MOST.log2()).clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last - 1);
    let (low, high) = (RAMP[below], RAMP[below + 1]);
    let share = place - below as f64;
    std::array::from_fn(|i| {
        let [low, high] = [low[i], high[i]].map(f64::from);
        (low + share * (high - low)).round() as u8
    })
}

/// Texture coordinates in a triangle at which a panel shows how wrinkles run: the centres of a grid.
fn grid_points(uvs: &[Vector2<f64>; 3]) -> Vec<Vector2<f64>> {
    let [a, b, c] = uvs;
    let (low, high) = (a.inf(b).inf(c) * GRID, a.sup(b).sup(c) * GRID);
    let cells = |axis: usize| (low[axis].floor() as u32)..(high[axis].ceil() as u32);
    let area = (b - a).perp(&(c - a));
    let is_in = |p: &Vector2<f64>| {
        let sides = [(a, b), (b, c), (c, a)];
        sides
            .iter()
            .all(|(from, to)| (*to - *from).perp(&(p - *from)) * area > 0.0)
    };
    let centre = |x: u32, y: u32| Vector2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) / GRID;
    let all = cells(1).flat_map(|y| cells(0).map(move |x| centre(x, y)));
    all.filter(is_in).collect()
}

/// Draws the legend and returns its words.
fn legend(canvas: &mut Canvas, top: f64) -> Vec<Words> {
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
    words.push(line("begins to wrinkle", Vector2::new(left, below)));
    words.push(line(
        "5 times that",
        Vector2::new(left + bar - 100.0, below),
    ));
    words.push(line(
        "Colours: compression, from where the skin begins to wrinkle. Lines run as the wrinkles will, one wavelength apart.",
        Vector2::new(left, top + 3.0 * height),
    ));
    let mut x = left + bar + 40.0;
    for (colour, text, width) in [
        (SMOOTH, "not simulated", 160.0),
        (MARGIN, "simulated, smooth", 190.0),
        (CAPPED, "beyond 15 %: shallower", 230.0),
        (FOLDED, "folded by the shape: left as it is", 300.0),
    ] {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_go_from_the_first_to_the_last() {
        assert_eq!(ramp(1.0), RAMP[0]);
        assert_eq!(ramp(MOST), RAMP[3]);
        assert_eq!(ramp(f64::INFINITY), RAMP[3]);
        assert_eq!(ramp(MOST.powf(1.0 / 3.0)), RAMP[1]);
    }

    #[test]
    fn every_grid_point_is_in_one_of_the_triangles_that_cover_the_map() {
        let corner = |x: f64, y: f64| Vector2::new(x, y);
        // The diagonal passes no centre.
        let [a, b, c, d] =
            [(0.0, 0.0), (1.0, 0.01), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner(x, y));
        let count = |uvs| grid_points(&uvs).len();
        let all = count([a, b, c]) + count([a, c, d]);
        let cells = (GRID * GRID) as usize;
        assert!(all <= cells && all >= cells - 2 * GRID as usize, "{all}");
        assert_eq!(count([a, a, c]), 0);
    }
}
