//! The body's section with each square between two cells: its connected regions.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use petgraph::unionfind::UnionFind;
use ruga_mesh::FaceId;

use crate::face_cutting::{Coincidence, Corner, Fragment, Side};
use crate::grid::{CellFace, Grid, across, below};
use crate::moments::Section;
use crate::solid_intervals::{End, Interval, pierced_edge};

/// A connected part of the body's section with a square between two cells.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(crate) square: CellFace,
    pub(crate) section: Section,
    /// Mesh faces whose cuts are on its outline.
    pub(crate) faces: Vec<FaceId>,
    /// Intervals on its outline, by index.
    pub(crate) intervals: Vec<usize>,
}

/// Joins cuts and intervals to closed outlines, and outlines with their holes to regions.
///
/// ```text
/// o-----o-----+     o  grid corner or pierced edge     an outline that runs counter-clockwise
/// |     |cut  |        intervals on the border         encloses a region, one that runs
/// |solid \____|        cuts inside                     clockwise is a hole in a region
/// o-----------o
/// ```
pub(crate) fn face_regions(
    fragments: &[Fragment],
    intervals: &[Interval],
    grid: &Grid,
) -> Result<Vec<Region>, Coincidence> {
    let mut outlines: BTreeMap<CellFace, Vec<Piece>> = BTreeMap::new();
    for fragment in fragments {
        add_cuts(fragment, &mut outlines);
    }
    for (index, interval) in intervals.iter().enumerate() {
        add_interval(index, interval, grid, &mut outlines);
    }
    let mut regions = Vec::new();
    for (square, pieces) in &outlines {
        let failed = || Coincidence(grid.corner(square.at));
        let corner = grid.corner(square.at);
        let [u, v] = across(square.axis);
        let origin = Vector2::new(corner[u], corner[v]);
        let loops = closed_loops(pieces, &origin).ok_or_else(failed)?;
        let first = regions.len();
        let (outer, holes): (Vec<_>, Vec<_>) = loops.iter().partition(|l| l.section.area > 0.0);
        for outline in &outer {
            regions.push(region(*square, outline, pieces));
        }
        for hole in holes {
            let owner = owner(hole, &outer, pieces).ok_or_else(failed)?;
            let hole = region(*square, hole, pieces);
            let whole = &mut regions[first + owner];
            whole.section.add(&hole.section);
            whole.faces.extend(hole.faces);
            whole.intervals.extend(hole.intervals);
        }
    }
    Ok(regions)
}

/// A directed piece of an outline, the body to its left seen against the axis of the square.
#[derive(Clone, Copy, Debug)]
struct Piece {
    ends: [End; 2],
    /// In-plane coordinates of the ends, m.
    points: [Vector2<f64>; 2],
    source: Source,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    Cut(FaceId),
    Interval(usize),
}

/// The cuts of a fragment on the lower squares of its cell: each cut is one fragment's only there.
///
/// Counter-clockwise around the outward normal, a fragment above the plane has the body to its
/// left on the cut.
fn add_cuts(fragment: &Fragment, outlines: &mut BTreeMap<CellFace, Vec<Piece>>) {
    let count = fragment.sides.len();
    for (i, side) in fragment.sides.iter().enumerate() {
        let &Side::Cut(plane) = side else { continue };
        if plane.index != fragment.cell[plane.axis] {
            continue;
        }
        let [u, v] = across(plane.axis);
        let corners = [i, (i + 1) % count];
        let end = |corner: Corner| match corner {
            Corner::OnEdge(edge, _) => Some(End::Crossed(edge)),
            Corner::OnLine(planes) => {
                let edge = pierced_edge(planes, fragment.cell);
                Some(End::Pierced(edge, fragment.face))
            }
            Corner::Vertex(_) => None,
        };
        let ends = corners.map(|c| end(fragment.corners[c]));
        // A cut never ends at a vertex: that is a coincidence which cutting has refused.
        let [Some(start), Some(stop)] = ends else {
            continue;
        };
        let at = fragment.cell;
        let axis = plane.axis;
        outlines
            .entry(CellFace { at, axis })
            .or_default()
            .push(Piece {
                ends: [start, stop],
                points: corners
                    .map(|c| Vector2::new(fragment.positions[c][u], fragment.positions[c][v])),
                source: Source::Cut(fragment.face),
            });
    }
}

/// An interval bounds the sections of the four squares around its edge.
fn add_interval(
    index: usize,
    interval: &Interval,
    grid: &Grid,
    outlines: &mut BTreeMap<CellFace, Vec<Piece>>,
) {
    let edge = interval.edge;
    let corner = grid.corner(edge.at);
    for axis in across(edge.axis) {
        let [u, v] = across(axis);
        let other = 3 - axis - edge.axis;
        let point = |coordinate: f64| {
            let mut point = corner;
            point[edge.axis] = coordinate;
            Vector2::new(point[u], point[v])
        };
        let forward = Piece {
            ends: interval.ends,
            points: interval.coordinates.map(point),
            source: Source::Interval(index),
        };
        // Counter-clockwise: along u on the lower side, along v on the upper one.
        let runs_forward_on_lower_side = edge.axis == u;
        for (at, is_lower_side) in [(Some(edge.at), true), (below(edge.at, other), false)] {
            let Some(at) = at else { continue };
            let piece = if is_lower_side == runs_forward_on_lower_side {
                forward
            } else {
                forward.reversed()
            };
            outlines
                .entry(CellFace { at, axis })
                .or_default()
                .push(piece);
        }
    }
}

impl Piece {
    fn reversed(&self) -> Self {
        let ([start, stop], [from, to]) = (self.ends, self.points);
        Self {
            ends: [stop, start],
            points: [to, from],
            source: self.source,
        }
    }

    /// Whether a ray from `point` along the first axis passes this piece.
    fn is_passed(&self, point: Vector2<f64>) -> bool {
        let [a, b] = self.points;
        (a.y > point.y) != (b.y > point.y) && {
            let share = (point.y - a.y) / (b.y - a.y);
            a.x + (b.x - a.x) * share > point.x
        }
    }
}

struct Loop {
    pieces: Vec<usize>,
    /// Positive area when it runs counter-clockwise.
    section: Section,
}

/// Groups the pieces of one square; `None` when an end is not the start of exactly one piece.
fn closed_loops(pieces: &[Piece], origin: &Vector2<f64>) -> Option<Vec<Loop>> {
    let mut starts: Vec<(End, usize)> = by_end(pieces, 0);
    let mut stops: Vec<(End, usize)> = by_end(pieces, 1);
    starts.sort_unstable();
    stops.sort_unstable();
    let mut groups = UnionFind::new(pieces.len());
    for (i, (start, stop)) in starts.iter().zip(&stops).enumerate() {
        let repeats = i > 0 && starts[i - 1].0 == start.0;
        if start.0 != stop.0 || repeats {
            return None;
        }
        groups.union(start.1, stop.1);
    }
    let mut loops: BTreeMap<usize, Loop> = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        let empty = || Loop {
            pieces: Vec::new(),
            section: Section::default(),
        };
        let outline = loops.entry(groups.find(i)).or_insert_with(empty);
        outline.pieces.push(i);
        outline
            .section
            .add_segment(&piece.points.map(|p| p - origin));
    }
    Some(loops.into_values().collect())
}

fn by_end(pieces: &[Piece], end: usize) -> Vec<(End, usize)> {
    let ends = pieces.iter().enumerate();
    ends.map(|(i, piece)| (piece.ends[end], i)).collect()
}

fn region(square: CellFace, outline: &Loop, pieces: &[Piece]) -> Region {
    let (mut faces, mut intervals) = (Vec::new(), Vec::new());
    for &piece in &outline.pieces {
        match pieces[piece].source {
            Source::Cut(face) => faces.push(face),
            Source::Interval(index) => intervals.push(index),
        }
    }
    Region {
        square,
        section: outline.section,
        faces,
        intervals,
    }
}

/// The smallest outline around a hole.
fn owner(hole: &Loop, outer: &[&Loop], pieces: &[Piece]) -> Option<usize> {
    let point = pieces[*hole.pieces.first()?].points[0];
    let is_around = |outline: &Loop| {
        let passed = outline
            .pieces
            .iter()
            .filter(|&&p| pieces[p].is_passed(point));
        passed.count() % 2 == 1
    };
    let around = outer.iter().enumerate().filter(|(_, o)| is_around(o));
    around
        .min_by(|a, b| a.1.section.area.total_cmp(&b.1.section.area))
        .map(|(i, _)| i)
}
