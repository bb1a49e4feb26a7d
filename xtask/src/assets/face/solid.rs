//! The head as a solid: a distance to its surface, negative inside, from smoothly joined balls.
//!
//! Metres; `+x` is the head's left, `+y` up, `+z` where it looks. The origin lies between the ears,
//! at the height of the eyes. Distances are bounds, exact enough to walk along. They are made by sums,
//! products, quotients and square roots alone, so that they are the same on every machine.

use nalgebra::Vector3;

pub(super) type Point = Vector3<f64>;

/// Centre of the left eyeball and its radius, m.
pub(super) const EYE: Point = Point::new(0.0312, 0.0, 0.0610);
pub(super) const EYEBALL: f64 = 0.0125;

/// Thickness of the lids on the eyeball, m.
const LID: f64 = 0.0018;

/// Where the neck ends, m.
const NECK_END: f64 = -0.142;

/// Distance from a point to the head's skin (m): eye openings and mouth closed.
pub(super) fn distance(p: Point) -> f64 {
    // Mirrored, so that both halves are the same to the last bit.
    let p = Point::new(p.x.abs(), p.y, p.z);
    let neck = neck(p);
    let skull = join(skull(p), neck, 0.022);
    let face = join(skull, jaw(p), 0.024);
    let face = carve(face, socket(p), 0.016);
    let face = join(face, lids(p), 0.006);
    let face = join(face, nose(p), 0.010);
    let face = join(face, lips(p), 0.006);
    let face = carve(face, dents(p), 0.006);
    let head = join(face, ear(p), 0.014);
    meet(head, NECK_END - p.y, 0.02)
}

/// Unit normal of the level of [`distance`] at a point.
pub(super) fn normal(p: Point) -> Point {
    const STEP: f64 = 1e-5;
    let along = |axis: Point| distance(p + axis * STEP) - distance(p - axis * STEP);
    Point::new(along(Point::x()), along(Point::y()), along(Point::z())).normalize()
}

/// The skin next to a point that lies near it.
pub(super) fn onto_skin(mut p: Point) -> Point {
    for _ in 0..12 {
        p -= normal(p) * distance(p);
    }
    p
}

/// The first skin on the way from a point, in a direction of length 1.
pub(super) fn first_skin(from: Point, direction: Point) -> Point {
    /// Share of the distance that is walked, since distances of ellipsoids are bounds.
    const CAREFUL: f64 = 0.6;
    let mut p = from;
    for _ in 0..160 {
        p += direction * (CAREFUL * distance(p).abs());
    }
    p
}

/// Brain case, cheekbones, brows.
fn skull(p: Point) -> f64 {
    let case = ellipsoid(p, [0.0, 0.027, -0.014], [0.0755, 0.081, 0.094]);
    let front = ellipsoid(p, [0.0, -0.034, 0.022], [0.0585, 0.076, 0.058]);
    let cheekbone = ellipsoid(p, [0.042, -0.022, 0.045], [0.024, 0.018, 0.024]);
    let brow = capsule(p, [0.010, 0.018, 0.0725], [0.042, 0.021, 0.055], 0.0085);
    let skull = join(case, front, 0.035);
    let skull = join(skull, cheekbone, 0.030);
    join(skull, brow, 0.018)
}

/// Lower jaw with the chin, and the flesh of the cheeks on it.
fn jaw(p: Point) -> f64 {
    let side = capsule(p, [0.043, -0.058, 0.004], [0.013, -0.096, 0.062], 0.012);
    let chin = ellipsoid(p, [0.0, -0.097, 0.0690], [0.017, 0.0135, 0.0145]);
    let cheek = ball(p, [0.031, -0.048, 0.046], 0.024);
    join(join(side, chin, 0.018), cheek, 0.026)
}

fn neck(p: Point) -> f64 {
    capsule(p, [0.0, -0.060, -0.026], [0.0, -0.180, -0.034], 0.049)
}

/// What lies deeper between brow, nose and cheek.
fn socket(p: Point) -> f64 {
    ellipsoid(p, [0.033, 0.001, 0.089], [0.021, 0.0135, 0.0195])
}

fn lids(p: Point) -> f64 {
    (p - EYE).norm() - EYEBALL - LID
}

fn nose(p: Point) -> f64 {
    let bridge = cone(
        p,
        [0.0, 0.010, 0.0775],
        [0.0, -0.036, 0.0935],
        0.0065,
        0.0095,
    );
    let tip = ball(p, [0.0, -0.0405, 0.0955], 0.0105);
    let wing = ellipsoid(p, [0.0105, -0.0445, 0.0835], [0.0070, 0.0075, 0.0100]);
    join(join(bridge, tip, 0.008), wing, 0.007)
}

/// Two rolls that meet at the corners of the mouth.
fn lips(p: Point) -> f64 {
    let upper = cone(
        p,
        [0.0040, -0.0650, 0.0825],
        [0.0205, -0.0692, 0.0700],
        0.0060,
        0.0050,
    );
    let lower = cone(
        p,
        [0.0, -0.0762, 0.0812],
        [0.0180, -0.0724, 0.0700],
        0.0068,
        0.0056,
    );
    upper.min(lower)
}

/// The groove between the lips, the one below the lower lip, and the philtrum.
fn dents(p: Point) -> f64 {
    let mouth = capsule(p, [0.0, -0.0702, 0.0897], [0.0235, -0.0706, 0.0755], 0.0014);
    let below = capsule(p, [0.0, -0.0850, 0.0855], [0.0110, -0.0845, 0.0825], 0.0056);
    let philtrum = capsule(p, [0.0, -0.053, 0.0895], [0.0, -0.0600, 0.0895], 0.0022);
    mouth.min(below).min(philtrum)
}

/// A leaf on the head, hollow in the middle.
fn ear(p: Point) -> f64 {
    // In the plane of the ear: back along its width, up its length, and out of it.
    let p = p - Point::new(0.0725, -0.012, -0.012);
    let back = 0.28 * p.x - 0.96 * p.z - 0.15 * p.y;
    let out = 0.96 * p.x + 0.28 * p.z;
    let p = Point::new(back, p.y, out);
    let leaf = ellipsoid(p, [0.003, 0.0, -0.0012], [0.0170, 0.030, 0.0080]);
    let hollow = ellipsoid(p, [0.001, 0.003, 0.0105], [0.0095, 0.0170, 0.0050]);
    carve(leaf, hollow, 0.006)
}

fn ball(p: Point, centre: [f64; 3], radius: f64) -> f64 {
    (p - Point::from(centre)).norm() - radius
}

/// Source of the bound: Quilez, *Ellipsoid SDF*: the implicit function over its gradient.
fn ellipsoid(p: Point, centre: [f64; 3], radii: [f64; 3]) -> f64 {
    let radii = Point::from(radii);
    let p = p - Point::from(centre);
    let once = p.component_div(&radii);
    let twice = once.component_div(&radii).norm();
    // At the centre the quotient is 0 / 0, and the distance the smallest radius.
    if twice < 1e-9 {
        return -radii.min();
    }
    once.norm() * (once.norm() - 1.0) / twice
}

fn capsule(p: Point, from: [f64; 3], to: [f64; 3], radius: f64) -> f64 {
    cone(p, from, to, radius, radius)
}

/// A segment with a radius that changes evenly along it.
fn cone(p: Point, from: [f64; 3], to: [f64; 3], start: f64, end: f64) -> f64 {
    let (from, to) = (Point::from(from), Point::from(to));
    let (way, p) = (to - from, p - from);
    let t = (p.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    (p - way * t).norm() - (start + (end - start) * t)
}

/// Union of two solids whose edge is rounded over `width` (m): a quadratic smooth minimum.
fn join(a: f64, b: f64, width: f64) -> f64 {
    let h = (1.0 - (a - b).abs() / width).max(0.0);
    a.min(b) - 0.25 * width * h * h
}

/// What both solids have in common, its edge rounded.
fn meet(a: f64, b: f64, width: f64) -> f64 {
    -join(-a, -b, width)
}

/// The first solid without the second, its edge rounded.
fn carve(a: f64, b: f64, width: f64) -> f64 {
    meet(a, -b, width)
}
