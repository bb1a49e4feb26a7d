//! Sheets of springs as they are seen: paper that chars and glows, with a grid printed on it, under a lamp.

use std::path::Path;

use nalgebra::{Rotation3, Vector2, Vector3};
use ruga_io::IoError;
use ruga_validation::canvas::Canvas;
use ruga_validation::light::Light;
use ruga_validation::spring_sheet::Remnant;

/// One side of the sheet, the other, what has burnt, printed lines, and light of what is hot.
const FRONT: Light = Light::new(0.80, 0.74, 0.60);
const BACK: Light = Light::new(0.36, 0.52, 0.66);
const CHAR: Light = Light::new(0.05, 0.042, 0.04);
const PRINT: Light = Light::new(0.30, 0.20, 0.14);
const GLOW: Light = Light::new(1.0, 0.25, 0.03);

/// Spheres and floors.
pub(crate) const GREY: Light = Light::new(0.55, 0.56, 0.58);

const LAMP: Vector3<f64> = Vector3::new(-0.45, 0.62, 0.65);

/// Width of a printed line, in squares of the grid.
const LINE: f64 = 0.08;

/// Temperatures between which a sheet begins to glow and glows fully (K).
const GLOWS: [f64; 2] = [700.0, 1300.0];

/// Share of mass at which paper is black.
const BLACK: f64 = 0.65;

/// Bands around a drawn sphere from pole to pole.
const BANDS: usize = 24;

/// What a triangle shows.
#[derive(Clone, Copy)]
enum Look {
    /// Paper: places on the printed grid in squares and share of mass, and temperatures (K), of its corners.
    Paper([Vector3<f64>; 3], [f64; 3]),
    /// One colour.
    Plain(Light),
}

/// Everything that is seen at one moment.
#[derive(Clone, Default)]
pub(crate) struct Scene {
    triangles: Vec<([Vector3<f64>; 3], Look)>,
}

impl Scene {
    /// What is left of a sheet. `marks` has, at the points of `seen`, the place on the grid in squares and the share of
    /// mass, `heat` the temperature (K) in its first coordinate.
    pub(crate) fn sheet(seen: &Remnant, marks: &Remnant, heat: &Remnant) -> Self {
        let triangles = seen.faces.iter().map(|face| {
            let ids = face.map(|p| p as usize);
            let look = Look::Paper(ids.map(|p| marks.points[p]), ids.map(|p| heat.points[p].x));
            (ids.map(|p| seen.points[p]), look)
        });
        Self {
            triangles: triangles.collect(),
        }
    }

    /// Adds a triangle of paper: its corners (m), places on the grid in squares with the share of mass, temperatures (K).
    pub(crate) fn add_paper(
        &mut self,
        corners: [Vector3<f64>; 3],
        marks: [Vector3<f64>; 3],
        heat: [f64; 3],
    ) {
        self.triangles.push((corners, Look::Paper(marks, heat)));
    }

    /// Adds a sphere.
    pub(crate) fn with_sphere(mut self, centre: Vector3<f64>, radius: f64, colour: Light) -> Self {
        let turn = std::f64::consts::PI / BANDS as f64;
        let at = |i: usize, j: usize| {
            let (polar, around) = (turn * i as f64, turn * j as f64);
            let way = Vector3::new(
                polar.sin() * around.cos(),
                polar.sin() * around.sin(),
                polar.cos(),
            );
            centre + way * radius
        };
        for i in 0..BANDS {
            for j in 0..2 * BANDS {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                self.triangles.push(([a, b, c], Look::Plain(colour)));
                self.triangles.push(([a, c, d], Look::Plain(colour)));
            }
        }
        self
    }

    /// Adds a square of floor of so much to either side (m) below a point.
    pub(crate) fn with_floor(mut self, middle: Vector3<f64>, half: f64) -> Self {
        let at = |x: f64, y: f64| middle + Vector3::new(x, y, 0.0) * half;
        let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        let look = Look::Plain(Light::repeat(0.8));
        self.triangles.push(([a, b, c], look));
        self.triangles.push(([a, c, d], look));
        self
    }
}

/// How scenes are turned before they are looked at along -z, rad: about z, then about x.
#[derive(Clone, Copy)]
pub(crate) struct View {
    pub(crate) turn: f64,
    pub(crate) nod: f64,
}

/// Draws rows of so many scenes, `pitch` (m) from one to the next and from row to row.
pub(crate) fn draw(
    path: &Path,
    scenes: &[Scene],
    (columns, pitch): (usize, [f64; 2]),
    view: View,
) -> Result<(), IoError> {
    let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), view.nod)
        * Rotation3::from_axis_angle(&Vector3::z_axis(), view.turn);
    let mut all = Vec::new();
    for (i, scene) in scenes.iter().enumerate() {
        let [column, row] = [i % columns, i / columns].map(|n| n as f64);
        let shift = Vector3::new(pitch[0] * column, -pitch[1] * row, 0.0);
        let turned = scene.triangles.iter();
        all.extend(turned.map(|(corners, look)| (corners.map(|p| rotation * p + shift), *look)));
    }
    let places: Vec<Vector2<f64>> = all
        .iter()
        .flat_map(|(corners, _)| corners.map(|p| p.xy()))
        .collect();
    let mut canvas = Canvas::around(places.iter(), 1500);
    for (corners, look) in &all {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else {
            continue;
        };
        canvas.triangle(*corners, |shares| match look {
            Look::Paper(marks, heat) => {
                let mark = marks[0] * shares[0] + marks[1] * shares[1] + marks[2] * shares[2];
                let hot = (0..3).map(|i| heat[i] * shares[i]).sum();
                paper(normal, mark, hot)
            }
            Look::Plain(colour) => *colour * brightness(normal),
        });
    }
    canvas.write(path)
}

fn paper(normal: Vector3<f64>, mark: Vector3<f64>, temperature: f64) -> Light {
    let side = if normal.z > 0.0 { FRONT } else { BACK };
    let beside = |x: f64| (x - x.round()).abs();
    let is_line = beside(mark.x).min(beside(mark.y)) < 0.5 * LINE;
    let fresh = if is_line { PRINT } else { side };
    let charred = ((1.0 - mark.z) / (1.0 - BLACK)).clamp(0.0, 1.0);
    let glow = ((temperature - GLOWS[0]) / (GLOWS[1] - GLOWS[0])).clamp(0.0, 1.0);
    fresh.lerp(&CHAR, charred) * brightness(normal) + GLOW * (0.8 * glow)
}

/// Thin sheets let some light through, so that no side is black.
fn brightness(normal: Vector3<f64>) -> f64 {
    let facing = if normal.z > 0.0 { normal } else { -normal };
    0.28 + 0.85 * facing.dot(&LAMP.normalize()).max(0.0)
}
