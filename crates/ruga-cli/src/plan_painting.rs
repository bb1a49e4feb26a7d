//! What a plan says of the skin in colours and strokes, on the mesh's texture layout.

use std::path::Path;

use nalgebra::Vector2;
use ruga_blend::Driver;
use ruga_material::UvTile;
use ruga_scene::{Scene, SceneError, ScenePlan};
use ruga_stepper::{LayerPlan, LayerSpec, PlannedFace, PlannedSurface, Treatment};

use crate::canvas::{Canvas, Colour, INK};
use crate::error::CliError;

/// Strain over the critical one at which the ramp of colours ends.
pub(crate) const MOST: f64 = 5.0;

/// Width of lines over the side of a square.
const LINE: f64 = 1.5 / 600.0;

/// Width over which colours go on beyond their triangles, over the side of a square: filtered at a seam, a picture
/// shows no other colour.
const PADDING: f64 = 6.0 / 1024.0;

/// Why a body has no picture.
const ON_A_BODY: &str = "the strain of a sheet, or of skin on a soft body, is known only when it is simulated; a picture shows layers on a posed mesh";

/// Skin that is not simulated.
const SMOOTH: Colour = [232, 232, 232];

/// Simulated skin that does not wrinkle.
const MARGIN: Colour = [198, 219, 239];

/// Folds of the artist.
const FOLDED: Colour = [20, 20, 20];

/// Compression beyond what is simulated.
const CAPPED: Colour = [136, 65, 157];

/// Colours from where skin begins to wrinkle up to [`MOST`] critical strains.
pub(crate) const RAMP: [Colour; 4] = [[255, 237, 160], [254, 178, 76], [240, 89, 40], [177, 0, 38]];

/// Lines along which skin folds.
const CREASES: Colour = [0, 80, 200];

/// Words at both ends of the ramp.
pub(crate) const RAMP_ENDS: [&str; 2] = ["begins to wrinkle", "5 times that"];

/// Colours beside the ramp, that of the bare mesh first, and what they mean.
pub(crate) const COLOURS: [(Colour, &str); 4] = [
    (SMOOTH, "not simulated"),
    (MARGIN, "simulated, smooth"),
    (CAPPED, "beyond 15 %: shallower"),
    (FOLDED, "folded by the shape: left as it is"),
];

/// What is to be known beside the colours.
const NOTE: &str = "Colours: compression, from where the skin begins to wrinkle. Lines run as the wrinkles will, one wavelength apart.";

/// What is to be known beside the colours of a scene.
pub(crate) fn note(scene: &Scene) -> String {
    match scene.layers.iter().any(|layer| !layer.creases.is_empty()) {
        true => format!("{NOTE} Blue lines are creases."),
        false => NOTE.to_owned(),
    }
}

/// Error that says why the file `path` is not written.
pub(crate) fn refusal(path: &Path, reason: &str) -> CliError {
    CliError::NoPicture {
        path: path.to_owned(),
        reason: reason.to_owned(),
    }
}

/// Refuses names that do not end in `extension`, lower case, as `files`, such as "pictures are PNG files", do.
///
/// # Errors
/// [`CliError::NoPicture`].
pub(crate) fn check_name(path: &Path, files: &str, extension: &str) -> Result<(), CliError> {
    let end = path.extension().unwrap_or_default();
    match end.eq_ignore_ascii_case(extension) {
        true => Ok(()),
        false => {
            let reason = format!("{files}, with a name that ends in `.{extension}`");
            Err(refusal(path, &reason))
        }
    }
}

/// The surfaces of a plan's zones, for a picture in the file `path`.
///
/// # Errors
/// A plan of a soft body.
pub(crate) fn surfaces<'a>(
    path: &Path,
    scene: &Scene,
    plan: &'a ScenePlan,
) -> Result<Vec<PlannedSurface<'a>>, CliError> {
    let mut surfaces = Vec::new();
    for zone in &plan.zones {
        let surface = zone.plan.surface().map_err(|source| SceneError::Model {
            scene: scene.path.clone(),
            source: Box::new(source),
        })?;
        surfaces.push(surface.ok_or_else(|| refusal(path, ON_A_BODY))?);
    }
    Ok(surfaces)
}

/// Wavelengths and area of a layer in words.
pub(crate) fn layer_note(layer: &LayerPlan) -> String {
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
    format!("{}: waves of {waves} mm on {area:.0} cm2", layer.name)
}

/// Part of a canvas that shows the texture layout of a tile.
pub(crate) struct Square {
    pub(crate) tile: UvTile,
    /// Its upper left corner, pixels.
    pub(crate) origin: Vector2<f64>,
    /// Its side, pixels.
    pub(crate) side: f64,
    /// Places along a side at which it is shown how wrinkles run.
    pub(crate) grid: f64,
}

impl Square {
    /// Paints the triangles of a mesh.
    pub(crate) fn paint_layout(&self, canvas: &mut Canvas, layout: &[[Vector2<f64>; 3]]) {
        for uvs in layout.iter().filter_map(|uvs| self.local(uvs)) {
            canvas.triangle(uvs.each_ref().map(|uv| self.place(uv)), SMOOTH);
        }
    }

    /// Paints what is done on faces, and how wrinkles run.
    pub(crate) fn paint(&self, canvas: &mut Canvas, faces: &[PlannedFace]) {
        for (corners, colour) in self.painted(faces) {
            canvas.triangle(corners, colour);
        }
        let width = LINE * self.side;
        let wrinkled = faces.iter().filter(|face| wrinkles(face));
        let wrinkled = wrinkled.filter_map(|face| Some((face, self.local(&face.uvs)?)));
        for (face, uvs) in wrinkled {
            for uv in grid_points(&uvs, self.grid) {
                // One wavelength apart; waves that a square cannot show get one line.
                let across = face.across * self.side;
                let Some(along) = face.along.try_normalize(0.0) else {
                    continue;
                };
                let half = 0.35 * self.side / self.grid * along;
                let sides: &[f64] = match across.norm() < 2.0 * width {
                    true => &[0.0],
                    false => &[-0.5, 0.5],
                };
                for side in sides {
                    let middle = self.place(&uv) + across * *side;
                    canvas.stroke([middle - half, middle + half], width, INK);
                }
            }
        }
    }

    /// Draws the creases of a layer where they were drawn on the `driver`.
    pub(crate) fn draw_creases(&self, canvas: &mut Canvas, layer: &LayerSpec, driver: &Driver) {
        let lines = layer.creases.iter().map(|crease| &crease.line);
        for segment in lines.flat_map(|line| line.segments()) {
            let [a, b, c] = &driver.uvs()[segment.face];
            let ends = [segment.from, segment.to]
                .map(|[u, v, w]| self.tile.local(&(a * u + b * v + c * w)));
            if ends.iter().all(is_shown) {
                let ends = ends.each_ref().map(|uv| self.place(uv));
                canvas.stroke(ends, LINE * self.side, CREASES);
            }
        }
    }

    /// Paints the surroundings of faces, before they are painted themselves.
    pub(crate) fn pad(&self, canvas: &mut Canvas, faces: &[PlannedFace]) {
        for ([a, b, c], colour) in self.painted(faces) {
            for side in [[a, b], [b, c], [c, a]] {
                canvas.stroke(side, PADDING * self.side, colour);
            }
        }
    }

    /// Corners of the faces that are painted, and their colours.
    fn painted(&self, faces: &[PlannedFace]) -> impl Iterator<Item = ([Vector2<f64>; 3], Colour)> {
        faces.iter().filter_map(|face| {
            let local = self.local(&face.uvs)?;
            let corners = local.each_ref().map(|uv| self.place(uv));
            Some((corners, colour(face)?))
        })
    }

    /// The corners of a triangle in the tile, if it lies there.
    pub(crate) fn local(&self, uvs: &[Vector2<f64>; 3]) -> Option<[Vector2<f64>; 3]> {
        let local = uvs.each_ref().map(|uv| self.tile.local(uv));
        local.iter().all(is_shown).then_some(local)
    }

    fn place(&self, uv: &Vector2<f64>) -> Vector2<f64> {
        self.origin + uv * self.side
    }
}

/// Whether a place relative to a tile is in it.
fn is_shown(uv: &Vector2<f64>) -> bool {
    uv.iter().all(|value| (0.0..=1.0).contains(value))
}

/// Whether a face wrinkles.
pub(crate) fn wrinkles(face: &PlannedFace) -> bool {
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
pub(crate) fn ramp(ratio: f64) -> Colour {
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

/// Texture coordinates in a triangle at which it is shown how wrinkles run: the centres of a grid of so many cells
/// along a side.
fn grid_points(uvs: &[Vector2<f64>; 3], grid: f64) -> Vec<Vector2<f64>> {
    let [a, b, c] = uvs;
    let (low, high) = (a.inf(b).inf(c) * grid, a.sup(b).sup(c) * grid);
    let cells = |axis: usize| (low[axis].floor() as u32)..(high[axis].ceil() as u32);
    let area = (b - a).perp(&(c - a));
    let is_in = |p: &Vector2<f64>| {
        let sides = [(a, b), (b, c), (c, a)];
        sides
            .iter()
            .all(|(from, to)| (*to - *from).perp(&(p - *from)) * area > 0.0)
    };
    let centre = |x: u32, y: u32| Vector2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) / grid;
    let all = cells(1).flat_map(|y| cells(0).map(move |x| centre(x, y)));
    all.filter(is_in).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: f64 = 16.0;

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
        let count = |uvs| grid_points(&uvs, GRID).len();
        let all = count([a, b, c]) + count([a, c, d]);
        let cells = (GRID * GRID) as usize;
        assert!(all <= cells && all >= cells - 2 * GRID as usize, "{all}");
        assert_eq!(count([a, a, c]), 0);
    }
}
