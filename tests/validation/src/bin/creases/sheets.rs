//! Sheets as they are seen: triangles with a grid printed on them, under a lamp.

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use ruga_io::IoError;
use ruga_validation::canvas::Canvas;
use ruga_validation::light::Light;

/// One side of the sheet, the other, and the printed lines.
const FRONT: Light = Light::new(0.80, 0.74, 0.60);
const BACK: Light = Light::new(0.36, 0.52, 0.66);
const PRINT: Light = Light::new(0.30, 0.20, 0.14);

const LAMP: Vector3<f64> = Vector3::new(-0.45, 0.62, 0.65);

/// Width of a printed line, in squares of the grid.
const LINE: f64 = 0.07;

/// A triangle in space, and where it is on the flat sheet.
pub(crate) type Seen = ([Vector3<f64>; 3], [Vector2<f64>; 3]);

/// How a sheet is turned before it is looked at along -z, rad: about z, then about x. The sheet begins with its mean
/// plane across the eye and its longest way along x.
#[derive(Clone, Copy)]
pub(crate) struct View {
    pub(crate) turn: f64,
    pub(crate) nod: f64,
}

/// Draws triangles, with `squares` of the grid to a unit of the flat sheet.
pub(crate) fn draw(
    path: &Path,
    triangles: &[Seen],
    squares: f64,
    view: View,
) -> Result<(), IoError> {
    let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), view.nod)
        * Rotation3::from_axis_angle(&Vector3::z_axis(), view.turn)
        * facing(triangles);
    let turned: Vec<Seen> = triangles
        .iter()
        .map(|(corners, flat)| (corners.map(|p| rotation * p), *flat))
        .collect();
    draw_turned(path, &turned, squares)
}

/// Draws triangles as they are seen along -z.
pub(crate) fn draw_turned(path: &Path, triangles: &[Seen], squares: f64) -> Result<(), IoError> {
    let places: Vec<Vector2<f64>> = triangles
        .iter()
        .flat_map(|(corners, _)| corners.map(|p| p.xy()))
        .collect();
    let mut canvas = Canvas::around(places.iter(), 900);
    for (corners, flat) in triangles {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else {
            continue;
        };
        canvas.triangle(*corners, |shares| {
            let at = flat[0] * shares[0] + flat[1] * shares[1] + flat[2] * shares[2];
            lit(normal, at * squares)
        });
    }
    canvas.write(path)
}

/// Turns the mean plane of a sheet, front up, across the eye.
fn facing(triangles: &[Seen]) -> Rotation3<f64> {
    let corners = || triangles.iter().flat_map(|(corners, _)| corners);
    let mean = corners().sum::<Vector3<f64>>() / (3 * triangles.len()) as f64;
    let spread = corners().map(|p| (p - mean) * (p - mean).transpose());
    let spread: Matrix3<f64> = spread.sum();
    let axes = spread.symmetric_eigen();
    let axis = |i: usize| axes.eigenvectors.column(i).into_owned();
    let normals = triangles.iter();
    let front: Vector3<f64> = normals.map(|([a, b, c], _)| (b - a).cross(&(c - a))).sum();
    let up = axis(axes.eigenvalues.imin());
    let up = up * up.dot(&front).signum();
    // The longest way, along which x grows on the flat sheet.
    let ends = |way: &Vector3<f64>| -> f64 {
        let all = triangles.iter().flat_map(|(p, flat)| p.iter().zip(flat));
        all.map(|(p, flat)| (p - mean).dot(way) * flat.x).sum()
    };
    let along = axis(axes.eigenvalues.imax());
    let along = along * ends(&along).signum();
    let rows = [along, up.cross(&along), up].map(|axis| axis.transpose());
    Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows))
}

fn lit(normal: Vector3<f64>, at: Vector2<f64>) -> Light {
    let is_front = normal.z > 0.0;
    let facing = if is_front { normal } else { -normal };
    let paper = if is_front { FRONT } else { BACK };
    let beside = |x: f64| (x - x.round()).abs();
    let is_line = beside(at.x).min(beside(at.y)) < 0.5 * LINE;
    let albedo = if is_line { PRINT } else { paper };
    // Thin sheets let some light through, so that no side is black.
    let light = 0.28 + 0.85 * facing.dot(&LAMP.normalize()).max(0.0);
    albedo * light
}
