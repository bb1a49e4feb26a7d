//! Where the vertices of the lattice lie on the head, and evenly so.

use nalgebra::Vector2;

use super::lattice::{Lattice, Part, RINGS, Site, Slit};
use super::openings::Openings;
use super::solid::{Point, first_skin, normal, onto_skin};

/// From here the lattice is projected onto the skin, m.
const MIDDLE: Point = Point::new(0.0, -0.024, 0.0);

/// Angle between the direction of the face and the front hexagon's rim, rad: behind the ears.
const RIM: f64 = 2.0;

/// Share of the mean spacing of rings that they have in the middle of the face.
const FINE: f64 = 0.50;

/// Sweeps that even out triangles, and the way of each towards the mean of the neighbours.
const SWEEPS: usize = 40;
const WAY: f64 = 0.6;

/// Positions of all vertices of the lattice, symmetric to the last bit.
pub(super) fn positions(lattice: &Lattice, openings: &Openings) -> Vec<Point> {
    let mirror = lattice.mirror();
    let pinned: Vec<Option<Point>> = lattice
        .sites
        .iter()
        .map(|site| openings.position(*site))
        .collect();
    let mut positions: Vec<Point> = lattice
        .sites
        .iter()
        .zip(&pinned)
        .map(|(site, pinned)| pinned.unwrap_or_else(|| projected(*site)))
        .collect();
    let neighbours = lattice.neighbours();
    for _ in 0..SWEEPS {
        let before = positions.clone();
        for (id, site) in lattice.sites.iter().enumerate() {
            if pinned[id].is_none() && site.twice_column >= 0 {
                positions[id] = evened(before[id], neighbours[id].iter().map(|n| before[*n]));
                if site.twice_column == 0 {
                    positions[id].x = 0.0;
                }
            }
        }
        mirror_left(&lattice.sites, &mirror, &mut positions);
    }
    positions
}

/// A vertex moved along the skin towards the mean of its neighbours.
fn evened(place: Point, neighbours: impl ExactSizeIterator<Item = Point>) -> Point {
    let count = neighbours.len() as f64;
    let mean = neighbours.sum::<Point>() / count;
    let normal = normal(place);
    let way = (mean - place) * WAY;
    onto_skin(place + way - normal * normal.dot(&way))
}

/// Gives the right side of the head what the left side has.
fn mirror_left(sites: &[Site], mirror: &[usize], positions: &mut [Point]) {
    for (id, site) in sites.iter().enumerate() {
        if site.twice_column < 0 {
            let other = positions[mirror[id]];
            positions[id] = Point::new(-other.x, other.y, other.z);
        }
    }
}

/// The skin in the direction that a place in a hexagon stands for.
fn projected(site: Site) -> Point {
    let flat = disc(site);
    let share = flat.norm();
    let angle = match site.part {
        Part::Back => {
            let outermost = RIM + 0.10;
            std::f64::consts::PI - share * (std::f64::consts::PI - outermost)
        }
        _ => RIM * share * (FINE + (1.0 - FINE) * share),
    };
    let around = if share > 0.0 {
        flat / share
    } else {
        Vector2::x()
    };
    let direction = Point::new(angle.sin() * around.x, angle.sin() * around.y, angle.cos());
    // What trigonometry gives may differ in its last bits from machine to machine.
    let direction = direction.map(|c| f64::from(c as f32)).normalize();
    let mut skin = first_skin(MIDDLE, direction);
    if site.twice_column == 0 {
        skin.x = 0.0;
    }
    skin
}

/// A hexagon as a disc of radius 1: as it is in the middle, its rim a circle.
pub(super) fn disc(site: Site) -> Vector2<f64> {
    let rings = f64::from(match site.part {
        Part::Back => RINGS / 2,
        _ => RINGS,
    });
    let place = site.place();
    let length = place.norm();
    if length == 0.0 {
        return place;
    }
    let ring = f64::from(site.ring());
    let round = (ring / rings) * (ring / rings);
    place * ((length * (1.0 - round) + ring * round) / (length * rings))
}

/// The slit along the row next to where corners shall be, `x` of both in ascending order.
pub(super) fn slit_at(corners: [Point; 2]) -> Slit {
    let middle = (corners[0] + corners[1]) * 0.5;
    let site = |row: i32, twice_column: i32| Site {
        part: Part::Front,
        row,
        twice_column,
    };
    let reach = RINGS / 2;
    let nearest = |to: Point, sites: &mut dyn Iterator<Item = Site>| {
        let far = |s: &Site| (projected(*s) - to).norm_squared();
        sites.min_by(|a, b| far(a).total_cmp(&far(b)))
    };
    let in_row = |row: i32| (-reach..=reach).map(move |c| site(row, 2 * c + row.rem_euclid(2)));
    let row = nearest(middle, &mut (-reach..=reach).flat_map(in_row)).map_or(0, |s| s.row);
    let ends = corners.map(|to| nearest(to, &mut in_row(row)).map_or(0, |s| s.twice_column));
    Slit {
        row,
        twice_columns: ends,
    }
}
