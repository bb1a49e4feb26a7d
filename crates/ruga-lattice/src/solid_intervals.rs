//! The parts of the grid's edges that lie inside the body.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, FaceId, PerFace};

use crate::face_cutting::{CLEARANCE, Coincidence, Corner, Fragment};
use crate::grid::{Grid, GridEdge, Index, Plane, across};

/// A point where the outline of the body's section with a plane turns from one piece to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum End {
    /// A corner of the grid.
    Grid(Index),
    /// Where a face passes through an edge of the grid.
    Pierced(GridEdge, FaceId),
    /// Where a mesh edge crosses a plane.
    Crossed(EdgeId),
}

/// A part of a grid edge inside the body, from its lower to its upper end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) edge: GridEdge,
    pub(crate) ends: [End; 2],
    /// Coordinates of the ends along the edge, m.
    pub(crate) coordinates: [f64; 2],
}

/// Walks along every line of the grid and counts the faces it passes.
///
/// `normals` of the faces must agree with the count: in through a face, out through the next.
pub(crate) fn solid_intervals(
    fragments: &[Fragment],
    normals: &PerFace<Vector3<f64>>,
    grid: &Grid,
) -> Result<Vec<Interval>, Coincidence> {
    let piercings = piercings(fragments);
    let mut intervals = Vec::new();
    for axis in 0..3 {
        let [first, second] = across(axis);
        // Lines on the grid's outside pass the body by.
        for i in 1..grid.counts[first] {
            for j in 1..grid.counts[second] {
                let mut at = [0; 3];
                (at[first], at[second]) = (i, j);
                let line = GridEdge { at, axis };
                walk(line, &piercings, normals, grid, &mut intervals)?;
            }
        }
    }
    Ok(intervals)
}

type Piercings = BTreeMap<GridEdge, Vec<(f64, FaceId)>>;

/// The faces that pass through each edge of the grid, sorted along it.
fn piercings(fragments: &[Fragment]) -> Piercings {
    let mut piercings = Piercings::new();
    for fragment in fragments {
        for (corner, position) in fragment.corners.iter().zip(&fragment.positions) {
            if let &Corner::OnLine(planes) = corner {
                let edge = pierced_edge(planes, fragment.cell);
                let list = piercings.entry(edge).or_default();
                list.push((position[edge.axis], fragment.face));
            }
        }
    }
    for list in piercings.values_mut() {
        list.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Each of the cells around the edge has a fragment with this corner.
        list.dedup();
    }
    piercings
}

/// The edge on the line of two planes that a cell has.
pub(crate) fn pierced_edge([first, second]: [Plane; 2], cell: Index) -> GridEdge {
    let axis = 3 - first.axis - second.axis;
    let mut at = cell;
    at[first.axis] = first.index;
    at[second.axis] = second.index;
    GridEdge { at, axis }
}

fn walk(
    line: GridEdge,
    piercings: &Piercings,
    normals: &PerFace<Vector3<f64>>,
    grid: &Grid,
    intervals: &mut Vec<Interval>,
) -> Result<(), Coincidence> {
    let axis = line.axis;
    let clearance = CLEARANCE * grid.size[axis];
    // Where the body was entered, while inside it.
    let mut entered: Option<(End, f64)> = None;
    let mut last = f64::NEG_INFINITY;
    for index in 0..grid.counts[axis] {
        let mut edge = line;
        edge.at[axis] = index;
        let coordinate = |index| grid.coordinate(Plane { axis, index });
        // Intervals end at corners of the grid even inside the body, because a square knows only
        // its own four edges.
        if entered.is_some() {
            entered = Some((End::Grid(edge.at), coordinate(index)));
        }
        for &(place, face) in piercings.get(&edge).map_or(&[][..], |list| list) {
            let goes_in = normals[face][axis] < 0.0;
            // Two faces that near have no certain order, and a normal that contradicts the count
            // means that a face was missed or met twice.
            if place - last <= clearance || goes_in == entered.is_some() {
                let mut point = grid.corner(edge.at);
                point[axis] = place;
                return Err(Coincidence(point));
            }
            last = place;
            let here = (End::Pierced(edge, face), place);
            entered = match entered {
                None => Some(here),
                Some(start) => {
                    intervals.push(interval(edge, start, here));
                    None
                }
            };
        }
        if let Some(start) = entered {
            let mut end = edge.at;
            end[axis] += 1;
            let end = (End::Grid(end), coordinate(index + 1));
            intervals.push(interval(edge, start, end));
        }
    }
    // A line ends outside the surface's box, and so outside the body.
    match entered {
        None => Ok(()),
        Some(_) => Err(Coincidence(grid.corner(line.at))),
    }
}

fn interval(edge: GridEdge, start: (End, f64), end: (End, f64)) -> Interval {
    Interval {
        edge,
        ends: [start.0, end.0],
        coordinates: [start.1, end.1],
    }
}
