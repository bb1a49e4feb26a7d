//! Blend shapes of the head: where muscles draw the skin.
//!
//! Each is a sum of smooth displacements that end at a distance. Displaced skin is put back onto the head:
//! it slides. A displacement `A` that ends at a radius `R` compresses the skin by `1.54 A / R` at most,
//! from which the sizes below follow: some 20 % where wrinkles shall be.

use super::lattice::{Lattice, Part, Site};
use super::openings::{self, Openings};
use super::solid::{EYE, Point, onto_skin};
use crate::assets::paint::smooth_step;

/// The left side's shapes of pairs, and whole shapes, in ARKit's names.
const PAIRS: [(&str, Displacement); 7] = [
    ("browDown", brow_down),
    ("browOuterUp", brow_outer_up),
    ("eyeBlink", eye_blink),
    ("eyeSquint", eye_squint),
    ("noseSneer", nose_sneer),
    ("mouthSmile", mouth_smile),
    ("mouthFrown", mouth_frown),
];
const WHOLE: [(&str, Displacement); 3] = [
    ("browInnerUp", brow_inner_up),
    ("mouthPucker", mouth_pucker),
    ("jawOpen", jaw_open),
];

/// From a place on the skin to its way, m.
type Displacement = fn(Place) -> Point;

/// A place on the skin; above or below the line between the lips decides for the jaw.
#[derive(Clone, Copy)]
struct Place {
    point: Point,
    is_lower_lip: bool,
}

/// Name and displacements of every vertex of the lattice, shape by shape.
pub(super) fn shapes(
    lattice: &Lattice,
    openings: &Openings,
    positions: &[Point],
) -> Vec<(String, Vec<Point>)> {
    let places = places(lattice, openings, positions);
    let mirror = lattice.mirror();
    let all = |displacement: Displacement| -> Vec<Point> {
        places.iter().map(|place| displacement(*place)).collect()
    };
    let mut shapes = Vec::new();
    for (name, displacement) in WHOLE {
        shapes.push((name.to_owned(), symmetric(&all(displacement), &mirror)));
    }
    for (name, displacement) in PAIRS {
        let left = all(displacement);
        let right = mirror.iter().map(|id| mirrored(left[*id])).collect();
        shapes.push((format!("{name}Left"), left));
        shapes.push((format!("{name}Right"), right));
    }
    shapes
}

/// Inner edges of strips move as the edges of lids and lips do.
fn places(lattice: &Lattice, openings: &Openings, positions: &[Point]) -> Vec<Place> {
    let place = |(id, site): (usize, &Site)| {
        let outer = openings.outer(*site).map_or(id, |outer| lattice.id(outer));
        Place {
            point: positions[outer],
            is_lower_lip: lattice.sites[outer].part == Part::Below,
        }
    };
    lattice.sites.iter().enumerate().map(place).collect()
}

/// The mean of a displacement and its mirror image, the same on both sides to the last bit.
fn symmetric(values: &[Point], mirror: &[usize]) -> Vec<Point> {
    let mean = |(value, other): (&Point, &usize)| (value + mirrored(values[*other])) * 0.5;
    values.iter().zip(mirror).map(mean).collect()
}

fn mirrored(p: Point) -> Point {
    Point::new(-p.x, p.y, p.z)
}

/// 1 at a centre, 0 from an ellipsoid around it on, its slope 1.54 over the radius at most.
fn bump(p: Point, centre: [f64; 3], radii: [f64; 3]) -> f64 {
    let q = (p - Point::from(centre)).component_div(&Point::from(radii));
    let rest = (1.0 - q.norm_squared()).max(0.0);
    rest * rest
}

/// The way of skin that is drawn so far and stays on the head.
fn slide(place: Place, way: Point) -> Point {
    if way == Point::zeros() {
        return way;
    }
    // Lips and lids are drawn back into their grooves otherwise.
    let landed = onto_skin(place.point + way);
    landed - onto_skin(place.point)
}

/// Brows up in the middle: the forehead is compressed upwards, over its whole height.
fn brow_inner_up(place: Place) -> Point {
    raised(
        place,
        bump(place.point, [0.0, 0.04, 0.07], [0.066, 0.2, 0.2]),
        0.0050,
    )
}

fn brow_outer_up(place: Place) -> Point {
    raised(
        place,
        bump(place.point, [0.047, 0.04, 0.05], [0.036, 0.2, 0.2]),
        0.0038,
    )
}

/// Skin raised by `height` (m) at the brow, less and less up to the hairline.
fn raised(place: Place, share: f64, height: f64) -> Point {
    const BROW: [f64; 2] = [0.004, 0.027];
    const FOREHEAD: [f64; 2] = [0.020, 0.086];
    let y = place.point.y;
    let profile = smooth_step(y, BROW) * (1.0 - smooth_step(y, FOREHEAD));
    slide(place, Point::y() * (height * share * profile))
}

/// Brow down and towards the other one: the glabella is gathered.
fn brow_down(place: Place) -> Point {
    let share = bump(place.point, [0.021, 0.023, 0.072], [0.036, 0.031, 0.06]);
    slide(place, Point::new(-0.0019, -0.0019, 0.0) * share)
}

/// The upper lid down to the lower one.
fn eye_blink(place: Place) -> Point {
    /// Height over which skin above the lid follows, m.
    const REACH: f64 = 0.017;
    let p = place.point;
    let Some([lower, upper]) = openings::lids_at(p.x) else {
        return Point::zeros();
    };
    if p.y < upper - 1e-4 || p.z < 0.04 {
        return Point::zeros();
    }
    let share = 1.0 - smooth_step(p.y, [upper, upper + REACH]);
    // Less towards the corners, where triangles between the lids would collapse.
    let t = (p.x - EYE.x) / openings::HALF_EYE;
    let closed = 0.90 - 0.34 * t * t;
    slide(place, Point::y() * ((lower - upper) * closed * share))
}

/// Skin beside the eye closed like a fan, cheek and lower lid up.
fn eye_squint(place: Place) -> Point {
    let p = place.point;
    let lid = bump(p, [0.032, -0.013, 0.070], [0.021, 0.014, 0.03]);
    let cheek = bump(p, [0.044, -0.026, 0.060], [0.024, 0.022, 0.03]);
    let way = fan_closed(p) + Point::y() * (0.0014 * lid + 0.0022 * cheek);
    slide(place, way)
}

/// The way of skin that turns about the outer corner of the eye towards the line straight outwards: the
/// muscle around the eye squeezes it across its rays, so that folds run along them.
fn fan_closed(p: Point) -> Point {
    /// Compression across the rays, at most.
    const SQUEEZE: f64 = 0.17;
    /// Distances from the corner between which skin begins to turn, m.
    const BEGINS: [f64; 2] = [0.002, 0.010];
    let outwards = Point::new(0.65, 0.0, -0.76);
    let from_corner = p - Point::new(EYE.x + openings::HALF_EYE, EYE.y, EYE.z);
    let [out, up] = [from_corner.dot(&outwards), from_corner.y];
    let reach = bump(p, [0.064, EYE.y, 0.038], [0.030, 0.032, 0.044]);
    let share = reach * smooth_step(out, BEGINS);
    // For small angles the sine stands for the angle.
    let turn = -SQUEEZE * share * up / (out * out + up * up).sqrt().max(1e-6);
    (Point::y() * out - outwards * up) * turn
}

/// Skin beside the nose up.
fn nose_sneer(place: Place) -> Point {
    let share = bump(place.point, [0.013, -0.031, 0.085], [0.019, 0.026, 0.035]);
    slide(place, Point::new(-0.0004, 0.0026, 0.0) * share)
}

/// The corner of the mouth out and up, the cheek before it.
fn mouth_smile(place: Place) -> Point {
    let p = place.point;
    let corner = bump(p, [0.025, -0.069, 0.070], [0.040, 0.037, 0.050]);
    let cheek = bump(p, [0.043, -0.040, 0.058], [0.028, 0.026, 0.035]);
    let way =
        Point::new(0.0033, 0.0025, -0.0011) * corner + Point::new(0.0003, 0.0014, 0.0) * cheek;
    slide(place, way)
}

/// The corner of the mouth down.
fn mouth_frown(place: Place) -> Point {
    let share = bump(place.point, [0.026, -0.070, 0.070], [0.028, 0.029, 0.04]);
    slide(place, Point::new(0.0006, -0.0030, 0.0) * share)
}

/// Both corners of the mouth inward and the lips forward.
fn mouth_pucker(place: Place) -> Point {
    let p = place.point;
    let around = bump(p, [0.0, -0.070, 0.075], [0.075, 0.046, 0.07]);
    let lips = bump(p, [0.0, -0.070, 0.080], [0.036, 0.026, 0.04]);
    Point::new(-0.155 * p.x * around, 0.0, 0.0032 * lips)
}

/// The lower jaw turned about the axis through its joints.
fn jaw_open(place: Place) -> Point {
    /// Height of the axis and its distance from the ears, m; angle, rad.
    const JOINT: [f64; 2] = [-0.018, 0.006];
    const ANGLE: f64 = 0.12;
    /// Heights between which the cheek is stretched, m.
    const CHEEK: [f64; 2] = [-0.100, -0.040];
    /// Depths and heights between which the skin under the chin goes along, m.
    const THROAT: [f64; 2] = [-0.020, 0.070];
    const NECK: [f64; 2] = [-0.135, -0.100];
    /// Half the length of the mouth, and how far from it lips go with one jaw alone, m.
    const MOUTH: f64 = openings::HALF_MOUTH;
    const LIPS: f64 = 0.030;
    let p = place.point;
    let cheek = 1.0 - smooth_step(p.y, CHEEK);
    let along = (1.0 - (p.x / MOUTH) * (p.x / MOUTH)).max(0.0);
    let across =
        (1.0 - ((p.y - openings::MOUTH) / LIPS) * ((p.y - openings::MOUTH) / LIPS)).max(0.0);
    let lips = if p.z > 0.03 {
        along * across * across
    } else {
        0.0
    };
    let is_below = place.is_lower_lip || p.y < openings::MOUTH - 0.001;
    let share = if is_below {
        cheek + (1.0 - cheek) * lips
    } else {
        cheek * (1.0 - lips)
    };
    let share = share * smooth_step(p.z, THROAT) * smooth_step(p.y, NECK);
    // A turn by a rational half angle.
    let half = 0.5 * ANGLE * share;
    let (sin, cos) = (
        2.0 * half / (1.0 + half * half),
        (1.0 - half * half) / (1.0 + half * half),
    );
    let [y, z] = [p.y - JOINT[0], p.z - JOINT[1]];
    Point::new(0.0, cos * y - sin * z - y, sin * y + cos * z - z)
}
