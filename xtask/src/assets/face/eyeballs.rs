//! The fronts of two eyeballs, which no shape moves.

use nalgebra::Vector2;

use super::solid::{EYE, EYEBALL, Point};

/// Rings from the pupil to where the head hides the rest, and vertices of each.
const RINGS: u32 = 5;
const AROUND: u32 = 16;

/// Tangent of half the angle at the last ring.
const LAST: f64 = 0.75;

/// Centre (V down) and radius of the left eyeball in the texture; the right one is its mirror image.
const CHART: ([f64; 2], f64) = ([0.90, 0.90], 0.06);

/// Half an eyeball.
pub(super) struct Eyeball {
    pub(super) positions: Vec<Point>,
    pub(super) uvs: Vec<Vector2<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The left eyeball and the right one.
pub(super) fn eyeballs() -> [Eyeball; 2] {
    let left = left();
    let right = Eyeball {
        positions: left
            .positions
            .iter()
            .map(|p| Point::new(-p.x, p.y, p.z))
            .collect(),
        uvs: left
            .uvs
            .iter()
            .map(|uv| Vector2::new(1.0 - uv.x, uv.y))
            .collect(),
        triangles: left
            .triangles
            .iter()
            .map(|[a, b, c]| [*a, *c, *b])
            .collect(),
    };
    [left, right]
}

fn left() -> Eyeball {
    let mut eye = Eyeball {
        positions: vec![EYE + Point::z() * EYEBALL],
        uvs: vec![CHART.0.into()],
        triangles: Vec::new(),
    };
    for ring in 1..=RINGS {
        for step in 0..AROUND {
            // Stereographic projection, from the back of the eye.
            let share = f64::from(ring) / f64::from(RINGS);
            let flat = on_circle(step) * (LAST * share);
            let square = flat.norm_squared();
            let on_ball = Point::new(2.0 * flat.x, 2.0 * flat.y, 1.0 - square) / (1.0 + square);
            eye.positions.push(EYE + on_ball * EYEBALL);
            let place = on_circle(step) * (CHART.1 * share);
            eye.uvs
                .push(Vector2::new(CHART.0[0] + place.x, CHART.0[1] - place.y));
        }
    }
    let id = |ring: u32, step: u32| match ring {
        0 => 0,
        _ => 1 + (ring - 1) * AROUND + step % AROUND,
    };
    for ring in 0..RINGS {
        for step in 0..AROUND {
            let [a, b] = [id(ring, step), id(ring, step + 1)];
            let [c, d] = [id(ring + 1, step), id(ring + 1, step + 1)];
            if ring > 0 {
                eye.triangles.push([a, d, b]);
            }
            eye.triangles.push([a, c, d]);
        }
    }
    eye
}

/// One of `AROUND` points of a circle of radius 1, nearly evenly apart: a rational quarter, turned.
fn on_circle(step: u32) -> Vector2<f64> {
    let quarter = AROUND / 4;
    // tan(angle / 2) runs from 0 to 1 within a quarter turn.
    let share = f64::from(step % quarter) / f64::from(quarter);
    let t = share * (0.79 + 0.21 * share);
    let place = Vector2::new(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
    match step / quarter % 4 {
        0 => place,
        1 => Vector2::new(-place.y, place.x),
        2 => -place,
        _ => Vector2::new(place.y, -place.x),
    }
}
