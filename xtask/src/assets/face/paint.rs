//! Painted images of the face: where each kind of skin is, how thick skin is, and where it ages.

use nalgebra::{Vector2, Vector3};
use ruga_blend::ArtistMesh;
use ruga_mesh::barycentric;

use super::openings::MOUTH;
use super::solid::{EYE, Point};
use crate::assets::paint::smooth_step;

/// Texels along a side: 1.6 mm each.
pub(in crate::assets) const TEXELS: usize = 256;

/// Grey images over the texture, the top row first.
pub(in crate::assets) struct Painted {
    /// Name and texels.
    pub(in crate::assets) images: [(&'static str, Vec<u8>); 5],
}

/// Paints the zones' masks, which add up to white at most, the thickness of the skin, and where it ages.
pub(in crate::assets) fn paint(mesh: &ArtistMesh) -> Painted {
    let places = places(mesh);
    let image = |value: fn(Point) -> f64| -> Vec<u8> {
        let texel = |place: &Option<Point>| place.map_or(0, |p| (255.0 * value(p)) as u8);
        places.iter().map(texel).collect()
    };
    Painted {
        images: [
            ("forehead.png", image(forehead)),
            ("eyes.png", image(|p| eyes(p) * (1.0 - forehead(p)))),
            (
                "cheeks.png",
                image(|p| cheeks(p) * (1.0 - eyes(p)) * (1.0 - forehead(p))),
            ),
            ("thickness.png", image(thickness)),
            ("age.png", image(age)),
        ],
    }
}

/// Forehead and glabella, as far as the hairline and the temples.
fn forehead(p: Point) -> f64 {
    let p = Point::new(p.x.abs(), p.y, p.z);
    window(p.y, [0.009, 0.017], [0.092, 0.100]) * smooth_step(p.z, [0.010, 0.025])
}

/// Around the eyes, the temples, and the bridge of the nose.
fn eyes(p: Point) -> f64 {
    let p = Point::new(p.x.abs(), p.y, p.z);
    window(p.y, [-0.032, -0.022], [0.030, 0.040]) * smooth_step(p.z, [-0.002, 0.012])
}

/// Cheeks, the skin around the lips, and chin. Lips are softer and wrinkle otherwise: as thick as cheeks they had pits.
fn cheeks(p: Point) -> f64 {
    let face = window(p.y, [-0.125, -0.112], [0.0, 0.010]) * smooth_step(p.z, [0.004, 0.020]);
    let lips = Vector2::new(p.x / 0.026, (p.y - MOUTH) / 0.011).norm();
    face * smooth_step(lips, [0.6, 1.2])
}

/// Thin on the lids, thick on cheeks and chin: share of the range that a scene gives.
fn thickness(p: Point) -> f64 {
    let p = Point::new(p.x.abs(), p.y, p.z);
    let lids = fading(p, [0.0315, 0.001, 0.068], 0.024);
    let cheek = fading(p, [0.040, -0.048, 0.052], 0.040);
    let chin = fading(p, [0.0, -0.095, 0.070], 0.035);
    0.5 * (1.0 - lids) + 0.5 * cheek.max(chin)
}

/// Where an old face wrinkles by itself: forehead, outward of the eyes, lightly below them, and beside nose and mouth.
///
/// Edges are softer than a wavelength of the skin that is there, so that wrinkles run out instead of ending.
fn age(p: Point) -> f64 {
    let p = Point::new(p.x.abs(), p.y, p.z);
    let temples = 1.0 - smooth_step(p.x, [0.040, 0.078]);
    let forehead =
        window(p.y, [0.016, 0.040], [0.056, 0.094]) * temples * smooth_step(p.z, [0.02, 0.04]);
    // Skin slides smoothly over the eyeball as far as the rim of its socket.
    let off_lids = smooth_step((p - EYE).norm(), [0.0145, 0.0225]);
    let outward = beside(
        p,
        [[0.052, 0.002, 0.062], [0.066, -0.003, 0.047]],
        [0.003, 0.022],
    );
    let below = beside(
        p,
        [[0.024, -0.016, 0.078], [0.046, -0.016, 0.070]],
        [0.002, 0.013],
    );
    let eyes = outward.max(0.72 * below) * off_lids;
    // From beside the wing of the nose to below the corner of the mouth.
    let cheek = beside(
        p,
        [[0.036, -0.044, 0.072], [0.046, -0.078, 0.058]],
        [0.001, 0.026],
    );
    forehead.max(eyes).max(cheek)
}

/// 1 next to a line between two places, 0 from the second distance on.
fn beside(p: Point, line: [[f64; 3]; 2], distances: [f64; 2]) -> f64 {
    let [from, to] = line.map(Point::from);
    let along = to - from;
    let share = (p - from).dot(&along) / along.norm_squared();
    1.0 - smooth_step((p - from - along * share.clamp(0.0, 1.0)).norm(), distances)
}

fn fading(p: Point, centre: [f64; 3], radius: f64) -> f64 {
    let q = (p - Point::from(centre)).norm() / radius;
    let rest = (1.0 - q * q).max(0.0);
    rest * rest
}

/// From 0 to 1 over the first two numbers, back to 0 over the other two.
fn window(at: f64, rise: [f64; 2], fall: [f64; 2]) -> f64 {
    smooth_step(at, rise) * (1.0 - smooth_step(at, fall))
}

/// For each texel the place on the head that it shows; around a chart, that of the next texel in it.
fn places(mesh: &ArtistMesh) -> Vec<Option<Point>> {
    let mut places = vec![None; TEXELS * TEXELS];
    for triangle in &mesh.triangles {
        let uvs = triangle.map(|id| {
            mesh.uvs
                .as_ref()
                .map_or(Vector2::zeros(), |uvs| uvs[id as usize])
                * TEXELS as f64
        });
        let corners = triangle.map(|id| mesh.positions[id as usize]);
        let low = uvs[0].inf(&uvs[1]).inf(&uvs[2]);
        let high = uvs[0].sup(&uvs[1]).sup(&uvs[2]);
        for row in low.y as usize..=(high.y as usize).min(TEXELS - 1) {
            for column in low.x as usize..=(high.x as usize).min(TEXELS - 1) {
                let at = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
                let Some(shares) = barycentric(uvs, at) else {
                    continue;
                };
                if shares.iter().all(|share| *share >= -1e-9) {
                    let place: Vector3<f64> = (0..3).map(|i| corners[i] * shares[i]).sum();
                    places[row * TEXELS + column] = Some(place);
                }
            }
        }
    }
    grown(grown(places))
}

/// Texels beside painted ones take the mean of what these show.
fn grown(places: Vec<Option<Point>>) -> Vec<Option<Point>> {
    let at = |row: usize, column: usize| {
        if row < TEXELS && column < TEXELS {
            places[row * TEXELS + column]
        } else {
            None
        }
    };
    let grow = |index: usize| {
        let (row, column) = (index / TEXELS, index % TEXELS);
        places[index].or_else(|| {
            let beside = [
                at(row, column.wrapping_sub(1)),
                at(row, column + 1),
                at(row.wrapping_sub(1), column),
                at(row + 1, column),
            ];
            let count = beside.iter().flatten().count();
            (count > 0).then(|| beside.iter().flatten().sum::<Point>() / count as f64)
        })
    };
    (0..TEXELS * TEXELS).map(grow).collect()
}
