//! A flat patch of forearm skin, 10 cm square, with the three motions of Li 2014, figure 5-1.
//!
//! The patch lies in the xy plane, `+z` outward, the arm along y.

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendError, BlendShape};

use super::finish;

/// Side of the patch, m.
const SIDE: f64 = 0.1;

/// Columns of triangles: edges of 6.7 mm, which three levels of Loop subdivision make 0.83 mm.
const COLUMNS: u32 = 15;

/// Strips between rows, even so that bottom and top look alike; 4 % less than equilateral.
const STRIPS: u32 = 18;

/// Room left around the patch in the texture.
const MARGIN: f64 = 0.02;

/// The patch, as its file holds it.
pub(super) fn mesh() -> Result<ArtistMesh, BlendError> {
    let places: Vec<Vector2<f64>> = (0..=STRIPS).flat_map(row).collect();
    let shape = |name: &str, displacement: fn(Vector2<f64>) -> Vector3<f64>| BlendShape {
        name: name.to_owned(),
        position_deltas: places.iter().map(|p| displacement(*p)).collect(),
        normal_deltas: None,
    };
    finish(ArtistMesh {
        name: "Forearm".to_owned(),
        positions: places.iter().map(|p| p.push(0.0)).collect(),
        normals: None,
        uvs: Some(places.iter().map(|p| texture_coordinate(*p)).collect()),
        triangles: triangles(),
        shapes: vec![
            shape("compress", compress),
            shape("twist", twist),
            shape("pinch", pinch),
        ],
    })
}

/// Even rows have a vertex per column; odd ones are shifted by half a cell and end on the border.
fn row(index: u32) -> Vec<Vector2<f64>> {
    let y = f64::from(index) / f64::from(STRIPS) - 0.5;
    let at = |column: f64| SIDE * Vector2::new(column / f64::from(COLUMNS) - 0.5, y);
    let middle = (0..COLUMNS).map(|i| at(f64::from(i) + 0.5));
    if index.is_multiple_of(2) {
        (0..=COLUMNS).map(|i| at(f64::from(i))).collect()
    } else {
        let (left, right) = (at(0.0), at(f64::from(COLUMNS)));
        std::iter::once(left).chain(middle).chain([right]).collect()
    }
}

fn triangles() -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut start = 0;
    for strip in 0..STRIPS {
        // Vertices of the even row of this strip, and of the odd one, which has one more.
        let odd_above = strip.is_multiple_of(2);
        let (even, odd, next) = if odd_above {
            let above = start + COLUMNS + 1;
            (start, above, above)
        } else {
            let above = start + COLUMNS + 2;
            (above, start, above)
        };
        let mut add = |[a, b, c]: [u32; 3]| {
            triangles.push(if odd_above { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..=COLUMNS {
            add([even + i, odd + i + 1, odd + i]);
            if i < COLUMNS {
                add([even + i, even + i + 1, odd + i + 1]);
            }
        }
        start = next;
    }
    triangles
}

/// V points down, so that the map is not mirrored.
fn texture_coordinate(place: Vector2<f64>) -> Vector2<f64> {
    let scale = (1.0 - 2.0 * MARGIN) / SIDE;
    Vector2::new(0.5 + scale * place.x, 0.5 - scale * place.y)
}

/// The place along the arm (m from the middle) that has this V; the inverse of
/// [`texture_coordinate`].
pub(super) fn place_along(v: f64) -> f64 {
    (0.5 - v) * SIDE / (1.0 - 2.0 * MARGIN)
}

/// Shortens the patch across the arm, the same width along it: by 12 % in the middle, fading to
/// nothing over the last 2 cm, so that the patch joins the skin around it without a kink.
fn compress(place: Vector2<f64>) -> Vector3<f64> {
    const STRAIN: f64 = 0.12;
    /// Half width of the evenly compressed middle and width of the fade on both sides, m.
    const EVEN: f64 = 0.03;
    const FADE: f64 = 0.02;
    let reach = place.x.abs();
    let t = ((reach - EVEN) / FADE).clamp(0.0, 1.0);
    // The integral of `1 - smoothstep`.
    let faded = FADE * (t - t.powi(3) + 0.5 * t.powi(4));
    let way = STRAIN * (reach.min(EVEN) + faded);
    Vector3::new(-way.copysign(place.x), 0.0, 0.0)
}

/// Slides the two ends of the patch sideways against each other, as when the arm turns: a line
/// along the arm turns by 12 degrees in the middle, which compresses the skin at 45 degrees to it.
///
/// Shear alone is half as effective as it looks, because it stretches the other diagonal as much:
/// `e1 + nu e2` is about `e1 / 2`. The ends come nearer as well, as those of a wrung towel do.
fn twist(place: Vector2<f64>) -> Vector3<f64> {
    const SHEAR: f64 = 0.2126;
    const APPROACH: f64 = 0.04;
    /// Length of the half wave of the shear, m: the ends of the patch still shear by 43 %.
    const HALF_WAVE: f64 = 0.14;
    let wave = std::f64::consts::PI / HALF_WAVE;
    let slide = (wave * place.y).sin() / wave;
    Vector3::new(SHEAR * slide, -APPROACH * slide, 0.0)
}

/// Two fingers gather the skin between them and pull it up a little: compression between them,
/// stretching behind each.
fn pinch(place: Vector2<f64>) -> Vector3<f64> {
    /// Each finger from the middle, m. Equal to `REACH`, it gives the most even compression.
    const FINGER: f64 = 0.024;
    /// Way of each finger, m.
    const WAY: f64 = 0.0027;
    /// Standard deviation of what a finger drags along: in the direction of its way, across, m.
    const REACH: [f64; 2] = [0.024, 0.018];
    /// Height and standard deviation of the lift, m.
    const LIFT: [f64; 2] = [0.004, 0.018];
    let bell = |x: f64, deviation: f64| (-0.5 * (x / deviation).powi(2)).exp();
    let drag = |from: f64| bell(place.x - from, REACH[0]) * bell(place.y, REACH[1]);
    Vector3::new(
        WAY * (drag(-FINGER) - drag(FINGER)),
        0.0,
        LIFT[0] * bell(place.norm(), LIFT[1]),
    )
}
