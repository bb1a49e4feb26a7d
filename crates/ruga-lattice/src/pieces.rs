//! The connected pieces of the body in each cell, and which of them hang together across cells.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use petgraph::unionfind::UnionFind;
use ruga_mesh::{EdgeId, FaceId, PerFace, TriMesh, face_normals};

use crate::face_cutting::{Coincidence, Fragment, Side, cut_faces};
use crate::face_regions::{Region, face_regions};
use crate::grid::{CellFace, Grid, GridEdge, Index, across, below};
use crate::moments::Moments;
use crate::solid_intervals::{Interval, solid_intervals};

/// A connected part of the body within one cell.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) cell: Index,
    pub(crate) moments: Moments,
}

/// Two pieces that touch across a square: the one below it along `axis`, and the one above.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) pieces: [usize; 2],
    pub(crate) axis: usize,
}

/// A body taken apart along a grid.
#[derive(Clone, Debug)]
pub(crate) struct Dissection {
    /// Sorted by cell.
    pub(crate) pieces: Vec<Piece>,
    pub(crate) links: Vec<Link>,
    pub(crate) fragments: Vec<Fragment>,
    /// The piece that each fragment bounds.
    pub(crate) piece_of_fragment: Vec<usize>,
}

/// Takes the body inside a closed surface apart (RK 5.1).
///
/// Cells, the squares between them and the grid's edges are treated alike, from the edges up: the
/// body's section with each is known by its border. So it is never triangulated.
pub(crate) fn dissect(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    grid: &Grid,
) -> Result<Dissection, Coincidence> {
    let normals = face_normals(mesh, positions);
    let fragments = cut_faces(mesh, positions, grid)?;
    let intervals = solid_intervals(&fragments, &normals, grid)?;
    let regions = face_regions(&fragments, &intervals, grid)?;

    let mut borders = Borders::new(&fragments, &regions, grid);
    borders.join_along_mesh_edges();
    borders.join_along_cuts()?;
    borders.join_along_intervals(&intervals);
    borders.join_hollows(&normals)?;
    Ok(borders.into_dissection(fragments.clone()))
}

/// The surfaces that bound pieces: fragments, and both sides of each region.
struct Borders<'a> {
    fragments: &'a [Fragment],
    regions: &'a [Region],
    grid: &'a Grid,
    fragment_of: BTreeMap<(Index, FaceId), usize>,
    groups: UnionFind<usize>,
}

/// The two sides of a region.
#[derive(Clone, Copy)]
enum Facing {
    /// It is the upper end of the cell below.
    Below,
    /// It is the lower end of the cell above.
    Above,
}

impl<'a> Borders<'a> {
    fn new(fragments: &'a [Fragment], regions: &'a [Region], grid: &'a Grid) -> Self {
        let keys = fragments.iter().enumerate();
        Self {
            fragments,
            regions,
            grid,
            fragment_of: keys.map(|(i, f)| ((f.cell, f.face), i)).collect(),
            groups: UnionFind::new(fragments.len() + 2 * regions.len()),
        }
    }

    fn side(&self, region: usize, facing: Facing) -> usize {
        self.fragments.len() + 2 * region + facing as usize
    }

    /// A mesh edge has one part in a cell: the fragments of its faces there meet at it.
    fn join_along_mesh_edges(&mut self) {
        let mut first_at: BTreeMap<(EdgeId, Index), usize> = BTreeMap::new();
        for (i, fragment) in self.fragments.iter().enumerate() {
            for side in &fragment.sides {
                if let &Side::Edge(edge) = side {
                    let first = *first_at.entry((edge, fragment.cell)).or_insert(i);
                    self.groups.union(first, i);
                }
            }
        }
    }

    fn join_along_cuts(&mut self) -> Result<(), Coincidence> {
        let failed = |at| Coincidence(self.grid.corner(at));
        for (r, region) in self.regions.iter().enumerate() {
            let square = region.square;
            let lower = below(square.at, square.axis).ok_or(failed(square.at))?;
            for &face in &region.faces {
                for (cell, facing) in [(lower, Facing::Below), (square.at, Facing::Above)] {
                    let fragment = self.fragment_of.get(&(cell, face));
                    let fragment = *fragment.ok_or(failed(square.at))?;
                    self.groups.union(fragment, self.side(r, facing));
                }
            }
        }
        Ok(())
    }

    /// In each cell around an edge, the two squares that meet there are joined along its intervals.
    fn join_along_intervals(&mut self, intervals: &[Interval]) {
        let mut region_at: BTreeMap<(usize, CellFace), usize> = BTreeMap::new();
        for (r, region) in self.regions.iter().enumerate() {
            for &interval in &region.intervals {
                region_at.insert((interval, region.square), r);
            }
        }
        for (index, interval) in intervals.iter().enumerate() {
            for [first, second] in squares_around(interval.edge) {
                let find = |(square, facing): (CellFace, Facing)| {
                    let region = region_at.get(&(index, square))?;
                    Some(self.side(*region, facing))
                };
                if let (Some(first), Some(second)) = (find(first), find(second)) {
                    self.groups.union(first, second);
                }
            }
        }
    }

    /// The wall of a hollow within a cell touches nothing; a ray from it finds the piece around.
    fn join_hollows(&mut self, normals: &PerFace<Vector3<f64>>) -> Result<(), Coincidence> {
        let moments = self.moments();
        let sides = self.fragments.len()..self.fragments.len() + 2 * self.regions.len();
        let open: BTreeSet<usize> = sides.map(|side| self.groups.find(side)).collect();
        let is_hollow = |group: usize| {
            let is_negative = moments.get(&group).is_some_and(|m| m.volume < 0.0);
            // A closed wall within a cell goes around a hollow if its volume is negative, and
            // around a small body otherwise. Groups with a side of a region are bounded by the cell
            // too.
            is_negative && !open.contains(&group)
        };
        let mut tips: BTreeMap<usize, (usize, Vector3<f64>)> = BTreeMap::new();
        for (i, fragment) in self.fragments.iter().enumerate() {
            let group = self.groups.find(i);
            if is_hollow(group) {
                for &position in &fragment.positions {
                    let tip = tips.entry(group).or_insert((i, position));
                    // From its furthest vertex along x a wall is never met again by the ray.
                    if position.x > tip.1.x {
                        *tip = (i, position);
                    }
                }
            }
        }
        // All found before any is joined, so that a group keeps its name while it is asked for.
        let mut joins = Vec::with_capacity(tips.len());
        for (group, (fragment, tip)) in tips {
            let cell = self.fragments[fragment].cell;
            let around = self.beyond(group, cell, &tip, normals);
            joins.push((group, around.ok_or(Coincidence(tip))?));
        }
        for (group, around) in joins {
            self.groups.union(group, around);
        }
        Ok(())
    }

    /// First border that a ray along x from the tip of a hollow meets: one of the same piece.
    fn beyond(
        &self,
        group: usize,
        cell: Index,
        tip: &Vector3<f64>,
        normals: &PerFace<Vector3<f64>>,
    ) -> Option<usize> {
        let in_cell = self
            .fragments
            .iter()
            .enumerate()
            .filter(|(_, f)| f.cell == cell);
        // The hollow's own wall is left out, which the ray touches at its start.
        let others = in_cell.filter(|&(i, _)| self.groups.find(i) != group);
        let hits = others.filter_map(|(i, fragment)| {
            let normal = normals[fragment.face];
            let reach = normal.dot(&(fragment.positions[0] - tip)) / normal.x;
            let hit = tip + Vector3::x() * reach;
            (reach > 0.0 && contains_across_x(fragment, &hit)).then_some((reach, i))
        });
        if let Some((_, fragment)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) {
            return Some(fragment);
        }
        // Nothing on the way to the cell's end.
        let mut at = cell;
        at[0] += 1;
        let end = CellFace { at, axis: 0 };
        let exit = tip.yz();
        let is_left = |region: &Region| region.square == end && region.contains(&exit);
        let left = self.regions.iter().position(is_left)?;
        Some(self.side(left, Facing::Below))
    }

    /// Moments of the solid within each group of borders.
    fn moments(&self) -> BTreeMap<usize, Moments> {
        let mut moments: BTreeMap<usize, Moments> = BTreeMap::new();
        for (i, fragment) in self.fragments.iter().enumerate() {
            let corner = self.grid.corner(fragment.cell);
            let group = moments.entry(self.groups.find(i)).or_default();
            for triangle in fragment.triangles() {
                group.add_triangle(&triangle.map(|p| p - corner));
            }
        }
        for (r, region) in self.regions.iter().enumerate() {
            for facing in [Facing::Below, Facing::Above] {
                let group = self.groups.find(self.side(r, facing));
                let group = moments.entry(group).or_default();
                // Moments are fluxes along x from the cell's lower end. Squares at that end and
                // across the other axes have none.
                if region.square.axis == 0 && matches!(facing, Facing::Below) {
                    group.add_upper_end(self.grid.size.x, &region.section);
                }
            }
        }
        moments
    }

    fn cell_of_side(&self, region: usize, facing: Facing) -> Index {
        let square = self.regions[region].square;
        match facing {
            Facing::Above => square.at,
            // No region lies on the grid's outside.
            Facing::Below => below(square.at, square.axis).unwrap_or(square.at),
        }
    }

    fn into_dissection(self, fragments: Vec<Fragment>) -> Dissection {
        let moments = self.moments();
        let mut cells: BTreeMap<usize, Index> = BTreeMap::new();
        for (i, fragment) in self.fragments.iter().enumerate() {
            cells.insert(self.groups.find(i), fragment.cell);
        }
        for r in 0..self.regions.len() {
            for facing in [Facing::Below, Facing::Above] {
                let group = self.groups.find(self.side(r, facing));
                cells.insert(group, self.cell_of_side(r, facing));
            }
        }
        // x runs slowest, as it does among an element's nodes.
        let mut order: Vec<(Index, usize)> = cells.into_iter().map(|(g, c)| (c, g)).collect();
        order.sort_unstable();
        let number: BTreeMap<usize, usize> =
            order.iter().enumerate().map(|(i, o)| (o.1, i)).collect();
        let piece = |border: usize| number[&self.groups.find(border)];
        let links = self.regions.iter().enumerate().map(|(r, region)| Link {
            pieces: [Facing::Below, Facing::Above].map(|facing| piece(self.side(r, facing))),
            axis: region.square.axis,
        });
        Dissection {
            links: links.collect(),
            piece_of_fragment: (0..self.fragments.len()).map(piece).collect(),
            pieces: (order.iter())
                .map(|&(cell, group)| Piece {
                    cell,
                    moments: moments[&group],
                })
                .collect(),
            fragments,
        }
    }
}

type SquareSide = (CellFace, Facing);

/// For each of the four cells around an edge the two squares of it that meet there.
fn squares_around(edge: GridEdge) -> Vec<[SquareSide; 2]> {
    let [a, b] = across(edge.axis);
    let mut around = Vec::with_capacity(4);
    for (beyond_a, facing_a) in [
        (Some(edge.at), Facing::Above),
        (below(edge.at, a), Facing::Below),
    ] {
        for (beyond_b, facing_b) in [
            (Some(edge.at), Facing::Above),
            (below(edge.at, b), Facing::Below),
        ] {
            // The square across `a` lies on the cell's side of `b`, and the other way round.
            if let (Some(at_a), Some(at_b)) = (beyond_b, beyond_a) {
                let across_a = CellFace { at: at_a, axis: a };
                let across_b = CellFace { at: at_b, axis: b };
                around.push([(across_a, facing_a), (across_b, facing_b)]);
            }
        }
    }
    around
}

/// Whether a point of a fragment's plane lies inside it, seen along x.
fn contains_across_x(fragment: &Fragment, point: &Vector3<f64>) -> bool {
    let count = fragment.positions.len();
    let mut passed = false;
    for i in 0..count {
        let [a, b] = [i, (i + 1) % count].map(|k| fragment.positions[k]);
        if (a.y > point.y) != (b.y > point.y) {
            let share = (point.y - a.y) / (b.y - a.y);
            passed ^= a.z + (b.z - a.z) * share > point.z;
        }
    }
    passed
}
