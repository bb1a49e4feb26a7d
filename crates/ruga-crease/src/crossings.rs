//! Places where crease lines meet.

use ruga_mesh::{FaceId, Id, MaterialPoint, TriMesh};

use crate::walk::is_same;
use crate::{LineSegment, TracedLine};

/// Share of a segment beyond its ends that still counts as the segment: rounding where segments meet on an
/// edge of the surface.
const BEYOND: f64 = 1e-9;

/// Sine of an angle in barycentric coordinates below which segments are parallel.
const PARALLEL: f64 = 1e-9;

/// A place where two lines meet, or one meets itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCrossing {
    /// The lines, the lower number first; equal for a line that crosses itself.
    pub lines: [usize; 2],
    /// Arc lengths along them (m).
    pub at: [f64; 2],
    /// The place.
    pub place: MaterialPoint,
}

/// All crossings of some lines inside faces that they share, exact in barycentric coordinates; in order of the lines and of
/// the place along the first. Lines that touch or end on each other cross there; stretches along which they
/// lie on each other do not count.
pub fn line_crossings(lines: &[TracedLine], mesh: &TriMesh) -> Vec<LineCrossing> {
    let mut of_face: Vec<Vec<(usize, usize)>> = vec![Vec::new(); mesh.face_count()];
    for (line, traced) in lines.iter().enumerate() {
        for (i, segment) in traced.segments().iter().enumerate() {
            of_face[segment.face.index()].push((line, i));
        }
    }
    let mut found: Vec<LineCrossing> = Vec::new();
    let filled = of_face.iter().enumerate().filter(|(_, all)| all.len() > 1);
    for (face, all) in filled {
        for (i, &first) in all.iter().enumerate() {
            for &second in &all[i + 1..] {
                let pair = [first, second].map(|(line, at)| (line, &lines[line], at));
                found.extend(crossing(FaceId::from_index(face), pair));
            }
        }
    }
    found.sort_by(|a, b| {
        let order = a.lines.cmp(&b.lines);
        order
            .then(a.at[0].total_cmp(&b.at[0]))
            .then(a.at[1].total_cmp(&b.at[1]))
    });
    // On an edge or in a vertex all faces there have found it.
    found.dedup_by(|b, a| {
        let is_near = |side: usize| {
            let length = lines[a.lines[side]].length();
            let apart = (a.at[side] - b.at[side]).abs();
            apart.min((length - apart).abs()) < 1e-7 * length
        };
        let is_one = (is_near(0) && is_near(1)) || is_same(mesh, &a.place, &b.place);
        a.lines == b.lines && is_one
    });
    found
}

/// The crossing of two segments in one face, if it is one.
fn crossing(face: FaceId, pair: [(usize, &TracedLine, usize); 2]) -> Option<LineCrossing> {
    let [(first_line, first, i), (second_line, second, j)] = pair;
    if first_line == second_line && are_neighbours(first, i, j) {
        return None;
    }
    let segments = [&first.segments()[i], &second.segments()[j]];
    let [s, t] = meet(segments)?;
    let at = [(segments[0], s), (segments[1], t)]
        .map(|(segment, share)| segment.start + segment.length * share.clamp(0.0, 1.0));
    let place = segments[0].place(s.clamp(0.0, 1.0));
    Some(LineCrossing {
        lines: [first_line, second_line],
        at,
        place: MaterialPoint { face, ..place },
    })
}

fn are_neighbours(line: &TracedLine, i: usize, j: usize) -> bool {
    let count = line.segments().len();
    let apart = i.abs_diff(j);
    apart <= 1 || (line.is_closed() && apart + 1 == count)
}

/// Shares of the way along two segments of one face at which they meet.
pub(crate) fn meet([a, b]: [&LineSegment; 2]) -> Option<[f64; 2]> {
    meet_in_face([[a.from, a.to], [b.from, b.to]])
}

/// Place where two segments in one face, given by their ends, meet: fractions along each.
pub(crate) fn meet_in_face([[p, q], [r, s]]: [[[f64; 3]; 2]; 2]) -> Option<[f64; 2]> {
    // Two of the coordinates are affine ones.
    let part = |from: [f64; 3], to: [f64; 3]| [to[1] - from[1], to[2] - from[2]];
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let (along, other, gap) = (part(p, q), part(r, s), part(p, r));
    let area = cross(along, other);
    let size = along[0].hypot(along[1]) * other[0].hypot(other[1]);
    // Of segments on one straight line rounding alone would decide where they meet.
    if area.abs() <= PARALLEL * size {
        return None;
    }
    let (first, second) = (cross(gap, other) / area, cross(gap, along) / area);
    let is_within = |share: f64| (-BEYOND..=1.0 + BEYOND).contains(&share);
    (is_within(first) && is_within(second)).then_some([first, second])
}
