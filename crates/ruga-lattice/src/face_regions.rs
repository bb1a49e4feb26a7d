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
    /// The outlines around it and its holes, in-plane coordinates (m).
    outlines: Vec<[Vector2<f64>; 2]>,
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
    let mut outlines: BTreeMap<CellFace, Vec<Part>> = BTreeMap::new();
    for fragment in fragments {
        add_cuts(fragment, &mut outlines);
    }
    for (index, interval) in intervals.iter().enumerate() {
        add_interval(index, interval, grid, &mut outlines);
    }
    let mut regions = Vec::new();
    for (square, parts) in &outlines {
        let failed = || Coincidence(grid.corner(square.at));
        let corner = grid.corner(square.at);
        let [u, v] = across(square.axis);
        // From the square's own corner, for the sake of digits and because moments count from
        // there.
        let origin = Vector2::new(corner[u], corner[v]);
        let loops = closed_loops(parts, &origin).ok_or_else(failed)?;
        let first = regions.len();
        let (outer, holes): (Vec<_>, Vec<_>) = loops.iter().partition(|l| l.section.area > 0.0);
        for outline in &outer {
            regions.push(region(*square, outline, parts));
        }
        for hole in holes {
            let owner = owner(hole, &outer, parts).ok_or_else(failed)?;
            let hole = region(*square, hole, parts);
            let whole = &mut regions[first + owner];
            whole.section.add(&hole.section);
            whole.outlines.extend(hole.outlines);
            whole.faces.extend(hole.faces);
            whole.intervals.extend(hole.intervals);
        }
    }
    Ok(regions)
}

impl Region {
    /// Whether a point of the square, in-plane coordinates (m), lies in it.
    pub(crate) fn contains(&self, point: &Vector2<f64>) -> bool {
        passed(self.outlines.iter(), point)
    }
}

/// A directed part of an outline, the body to its left seen against the axis of the square.
#[derive(Clone, Copy, Debug)]
struct Part {
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
fn add_cuts(fragment: &Fragment, outlines: &mut BTreeMap<CellFace, Vec<Part>>) {
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
            .push(Part {
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
    outlines: &mut BTreeMap<CellFace, Vec<Part>>,
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
        let forward = Part {
            ends: interval.ends,
            points: interval.coordinates.map(point),
            source: Source::Interval(index),
        };
        // Counter-clockwise: along u on the lower side, along v on the upper one.
        let runs_forward_on_lower_side = edge.axis == u;
        for (at, is_lower_side) in [(Some(edge.at), true), (below(edge.at, other), false)] {
            let Some(at) = at else { continue };
            let part = if is_lower_side == runs_forward_on_lower_side {
                forward
            } else {
                forward.reversed()
            };
            outlines
                .entry(CellFace { at, axis })
                .or_default()
                .push(part);
        }
    }
}

impl Part {
    fn reversed(&self) -> Self {
        let ([start, stop], [from, to]) = (self.ends, self.points);
        Self {
            ends: [stop, start],
            points: [to, from],
            source: self.source,
        }
    }
}

/// Whether a ray from `point` along the first axis passes an odd number of segments.
fn passed<'a>(segments: impl Iterator<Item = &'a [Vector2<f64>; 2]>, point: &Vector2<f64>) -> bool {
    let is_passed = |[a, b]: &&[Vector2<f64>; 2]| {
        // Of a segment one end belongs to it and the other does not: a corner at the height of the
        // ray is passed once.
        (a.y > point.y) != (b.y > point.y) && {
            let share = (point.y - a.y) / (b.y - a.y);
            a.x + (b.x - a.x) * share > point.x
        }
    };
    segments.filter(is_passed).count() % 2 == 1
}

struct Loop {
    parts: Vec<usize>,
    /// Positive area when it runs counter-clockwise.
    section: Section,
}

/// Groups the parts of one square; `None` when an end is not the start of exactly one part.
fn closed_loops(parts: &[Part], origin: &Vector2<f64>) -> Option<Vec<Loop>> {
    let mut starts: Vec<(End, usize)> = by_end(parts, 0);
    let mut stops: Vec<(End, usize)> = by_end(parts, 1);
    starts.sort_unstable();
    stops.sort_unstable();
    let mut groups = UnionFind::new(parts.len());
    for (i, (start, stop)) in starts.iter().zip(&stops).enumerate() {
        let repeats = i > 0 && starts[i - 1].0 == start.0;
        // Every end is the start of one part and the stop of one other. Sorted, the two lists then
        // agree, and outlines need not be walked along.
        if start.0 != stop.0 || repeats {
            return None;
        }
        groups.union(start.1, stop.1);
    }
    let mut loops: BTreeMap<usize, Loop> = BTreeMap::new();
    for (i, part) in parts.iter().enumerate() {
        let empty = || Loop {
            parts: Vec::new(),
            section: Section::default(),
        };
        let outline = loops.entry(groups.find(i)).or_insert_with(empty);
        outline.parts.push(i);
        outline
            .section
            .add_segment(&part.points.map(|p| p - origin));
    }
    Some(loops.into_values().collect())
}

fn by_end(parts: &[Part], end: usize) -> Vec<(End, usize)> {
    let ends = parts.iter().enumerate();
    ends.map(|(i, part)| (part.ends[end], i)).collect()
}

fn region(square: CellFace, outline: &Loop, parts: &[Part]) -> Region {
    let (mut faces, mut intervals) = (Vec::new(), Vec::new());
    for &part in &outline.parts {
        match parts[part].source {
            Source::Cut(face) => faces.push(face),
            Source::Interval(index) => intervals.push(index),
        }
    }
    Region {
        square,
        section: outline.section,
        outlines: outline.parts.iter().map(|&p| parts[p].points).collect(),
        faces,
        intervals,
    }
}

/// The smallest outline around a hole.
fn owner(hole: &Loop, outer: &[&Loop], parts: &[Part]) -> Option<usize> {
    // Outlines do not cross: one point of a hole tells for all of it.
    let point = parts[*hole.parts.first()?].points[0];
    let is_around =
        |outline: &Loop| passed(outline.parts.iter().map(|&p| &parts[p].points), &point);
    let around = outer.iter().enumerate().filter(|(_, o)| is_around(o));
    around
        .min_by(|a, b| a.1.section.area.total_cmp(&b.1.section.area))
        .map(|(i, _)| i)
}
