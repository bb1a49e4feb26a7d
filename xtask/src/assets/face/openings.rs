//! Edges of the lids and lips: curves on the skin, and the strips that turn inward from them.

use super::lattice::{Part, Site, Slit};
use super::solid::{EYE, Point, first_skin};
use super::surface::slit_at;

/// Half the length of the opening between the lids, m, and how far its outer corner is higher.
pub(super) const HALF_EYE: f64 = 0.0134;
const RISE: f64 = 0.0010;

/// Height of the upper lid's edge and depth of the lower one's in the middle, m.
const UPPER_LID: f64 = 0.0061;
const LOWER_LID: f64 = 0.0046;

/// Half the length of the mouth, its middle, and half the width it is open at rest, m.
pub(super) const HALF_MOUTH: f64 = 0.0245;
pub(super) const MOUTH: f64 = -0.0702;
const PARTED: f64 = 0.0003;

/// The slits of the lattice: the left eye, the right one, and the mouth.
pub(super) struct Openings {
    left_eye: Slit,
    mouth: Slit,
}

impl Openings {
    pub(super) fn new() -> Self {
        let corner = |t: f64| lid(t, 0.0);
        Self {
            left_eye: slit_at([-1.0, 1.0].map(corner)),
            mouth: slit_at([-1.0, 1.0].map(|t| lip(t, 0.0))),
        }
    }

    pub(super) fn slits(&self) -> [Slit; 3] {
        [self.left_eye, self.left_eye.mirrored(), self.mouth]
    }

    /// The vertex at the edge of a slit beside one at the inner edge of its strip.
    pub(super) fn outer(&self, site: Site) -> Option<Site> {
        let turns = self.slits().into_iter().flat_map(Slit::turns);
        turns
            .filter(|[_, inner]| *inner == site)
            .map(|[outer, _]| outer)
            .next()
    }

    /// Where a vertex of a slit, a strip or a lip's ridge is; other vertices are free.
    pub(super) fn position(&self, site: Site) -> Option<Point> {
        let mirrored = site.mirrored();
        let is_on = |slit: &Slit, site: Site| {
            let [from, to] = slit.twice_columns;
            site.part != Part::Back
                && slit.row == site.row
                && (from..=to).contains(&site.twice_column)
        };
        if is_on(&self.left_eye, site) {
            Some(eye_vertex(self.left_eye, site))
        } else if is_on(&self.left_eye, mirrored) {
            let left = eye_vertex(self.left_eye, mirrored);
            Some(Point::new(-left.x, left.y, left.z))
        } else if is_on(&self.mouth, site) {
            Some(mouth_vertex(self.mouth, site))
        } else {
            lip_ridge(self.mouth, site)
        }
    }
}

/// Heights of the left eye's lower and upper lid where `x` is between its corners.
pub(super) fn lids_at(x: f64) -> Option<[f64; 2]> {
    let t = (x - EYE.x) / HALF_EYE;
    (t.abs() < 1.0).then(|| [-1.0, 1.0].map(|side| lid_height(t, side)))
}

/// -1 below a slit, 1 above; 0 at its corners.
fn side(slit: Slit, site: Site) -> f64 {
    if slit.twice_columns.contains(&site.twice_column) {
        return 0.0;
    }
    match site.part {
        Part::Below | Part::InnerBelow => -1.0,
        _ => 1.0,
    }
}

fn is_inner(site: Site) -> bool {
    matches!(site.part, Part::InnerAbove | Part::InnerBelow)
}

fn eye_vertex(slit: Slit, site: Site) -> Point {
    let edge = lid(slit.share(site.twice_column), side(slit, site));
    if !is_inner(site) {
        return edge;
    }
    // Back along the eyeball, which the lid's inner edge touches.
    let inward = EYE - edge;
    edge + Point::new(0.15 * inward.x, 0.12 * inward.y, -0.0024)
}

/// The edge of the left upper lid (`side` 1) or lower lid (-1); `t` from -1 at the nose to 1.
fn lid(t: f64, side: f64) -> Point {
    from_front(EYE.x + HALF_EYE * t, lid_height(t, side))
}

fn lid_height(t: f64, side: f64) -> f64 {
    let arch = 1.0 - t * t;
    // The upper lid is highest towards the nose, the lower one deepest away from it.
    let height = if side > 0.0 {
        UPPER_LID * arch * (1.0 - 0.22 * t)
    } else {
        -LOWER_LID * arch * (1.0 + 0.25 * t)
    };
    EYE.y + RISE * t + side.abs() * height
}

fn mouth_vertex(slit: Slit, site: Site) -> Point {
    let side = side(slit, site);
    let edge = lip(slit.share(site.twice_column), side);
    if !is_inner(site) {
        return edge;
    }
    edge + Point::new(0.0, 0.0006 * side, -0.0045)
}

/// The rows next to the mouth lie on the ridges of the lips, which they would miss otherwise.
fn lip_ridge(slit: Slit, site: Site) -> Option<Point> {
    /// Height of the upper lip's ridge and depth of the lower one's below the mouth, m.
    const UPPER: f64 = 0.0046;
    const LOWER: f64 = 0.0056;
    /// Share of the mouth along which there is a ridge.
    const LENGTH: f64 = 0.85;
    let t = slit.share(site.twice_column);
    let height = match site.row - slit.row {
        1 => UPPER,
        -1 => -LOWER,
        _ => return None,
    };
    if site.part != Part::Front || t.abs() > LENGTH {
        return None;
    }
    let y = MOUTH + height * (1.0 - 0.4 * t * t);
    Some(from_front(0.96 * HALF_MOUTH * t, y))
}

/// The edge of the upper lip (`side` 1) or lower lip (-1); `t` from -1 to 1.
fn lip(t: f64, side: f64) -> Point {
    let arch = 1.0 - t * t;
    // A low M, as the upper lip hangs in the middle.
    let bow = -0.0009 * arch * arch * arch + 0.0010 * t * t * arch;
    from_front(HALF_MOUTH * t, MOUTH + bow + side * PARTED * arch.sqrt())
}

/// The skin as the eye sees it that looks at the face.
fn from_front(x: f64, y: f64) -> Point {
    first_skin(Point::new(x, y, 0.13), -Point::z())
}
