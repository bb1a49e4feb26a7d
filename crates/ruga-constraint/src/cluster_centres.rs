//! Centres of constraint functions, spread over a region.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use nalgebra::Vector3;
use ruga_mesh::{Id, PerVertex, TriMesh, VertexId, vertex_areas};

use crate::ConstraintError;
use crate::region_graph::{RegionGraph, Voronoi, ticks};
use crate::rows::{check_length, check_mesh, check_vertex};

/// Settings of how centres are spread over a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterSettings {
    /// Most rounds of moving every centre to the middle of its cell; 0 keeps the greedy choice.
    /// The default, 30, is where cells stop moving on meshes of 10 to 30 edges per spacing; at most
    /// 1000.
    pub relaxations: u32,
    /// Connected pieces of the region below this area get no centre; in squares of the local
    /// spacing, not negative. The default, 0.05, leaves out specks a quarter of a spacing wide.
    pub smallest_piece: f64,
}

impl Default for ClusterSettings {
    fn default() -> Self {
        Self {
            relaxations: 30,
            smallest_piece: 0.05,
        }
    }
}

/// Rounds after which cells that still move go round in circles.
const MAX_RELAXATIONS: u32 = 1000;

impl ClusterSettings {
    fn check(&self) -> Result<(), ConstraintError> {
        let refuse = |setting, value, accepted| {
            Err(ConstraintError::BadSetting {
                setting,
                value,
                accepted,
            })
        };
        if self.relaxations > MAX_RELAXATIONS {
            let value = f64::from(self.relaxations);
            return refuse("relaxations", value, "0 to 1000");
        }
        if !(self.smallest_piece.is_finite() && self.smallest_piece >= 0.0) {
            let accepted = "0 or more squares of the spacing";
            return refuse("smallest_piece", self.smallest_piece, accepted);
        }
        Ok(())
    }
}

/// Spreads centres over `candidates` so that their mean spacing is the asked one.
///
/// Greedy farthest points (Li 2014, ch. 4; Rémillard and Kry 2013, sec. 3) with lengths in units of the
/// local spacing, then Lloyd's relaxation. Both papers stop at a covering radius, under which the
/// spacing comes out anywhere from 1.3 to 1.7 radii. Here the *number* is fixed instead: a hex
/// lattice of spacing `s` has one point per `(√3/2) s²`, so each connected piece of the region
/// gets `(2/√3) ∫ dA/s²` centres, rounded, and at least one.
///
/// Ties go to the lowest vertex; equal means within 1e-9, so that the choice survives the rounding
/// of a translated or rotated mesh.
///
/// # Shapes and units
/// `positions` (m) and `spacing` (m) per vertex; `candidates` in any order. Centres come piece by
/// piece, in the order in which they were found.
///
/// # Errors
/// [`ConstraintError`] for an empty mesh or region, arrays that don't fit, a candidate that is no
/// vertex, positions that aren't finite, a spacing that isn't positive, settings outside their
/// ranges, and [`TooManyCentres`](ConstraintError::TooManyCentres) where the spacing asks for a thousand
/// times as many as there are candidates. Where it asks for more, but less than that, every candidate
/// becomes a centre.
pub fn cluster_centres(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    spacing: &PerVertex<f64>,
    candidates: &[VertexId],
    settings: &ClusterSettings,
) -> Result<Vec<VertexId>, ConstraintError> {
    check_mesh(mesh, positions)?;
    check_length("spacings", mesh.vertex_count(), spacing.len())?;
    settings.check()?;
    let mut is_candidate = PerVertex::filled(mesh.vertex_count(), false);
    for &vertex in candidates {
        check_vertex(mesh, vertex)?;
        check_spacing(vertex, spacing[vertex])?;
        // Vertices without faces have no surface to be centres of.
        is_candidate[vertex] = !mesh.vertex_faces(vertex).is_empty();
    }
    if candidates.is_empty() {
        return Err(ConstraintError::EmptyRegion);
    }
    let areas = vertex_areas(mesh, positions);
    check_count(&is_candidate, &areas, spacing)?;
    let region = Region {
        positions,
        spacing,
        areas,
        graph: RegionGraph::new(mesh, positions, spacing, &is_candidate),
    };
    let mut voronoi = Voronoi::new(mesh.vertex_count());
    // The border counts as a centre that is there already, so that greedy choice begins inside.
    let border = border_of(mesh, &is_candidate);
    region
        .graph
        .add_sources(&mut voronoi, border, ticks(BORDER_HEAD_START));
    let mut centres = Vec::new();
    for piece in region.pieces(&is_candidate) {
        region.choose(&piece, settings, &mut voronoi, &mut centres);
    }
    for _ in 0..settings.relaxations {
        if !region.relax(&is_candidate, &mut voronoi, &mut centres) {
            break;
        }
    }
    Ok(centres)
}

/// Distance by which the border counts as farther than it is, in spacings.
///
/// Points of a hex lattice are at most .577 spacings from the nearest centre; half a spacing from
/// the border is as good a place as that. Greedy centres would else line the border, too close.
const BORDER_HEAD_START: f64 = 0.077;

/// Candidates at the end of the surface or next to vertices that are no candidates.
fn border_of<'a>(
    mesh: &'a TriMesh,
    is_candidate: &'a PerVertex<bool>,
) -> impl Iterator<Item = (VertexId, u32)> + 'a {
    let is_on_border = mesh.border_vertices();
    let is_outermost = move |vertex: VertexId| {
        let corners = mesh.vertex_faces(vertex).iter();
        let mut corners = corners.flat_map(|&face| mesh.faces()[face]);
        is_on_border[vertex] || corners.any(|v| !is_candidate[v])
    };
    is_candidate
        .ids()
        .filter(move |&v| is_candidate[v] && is_outermost(v))
        .map(|v| (v, u32::MAX))
}

fn check_spacing(vertex: VertexId, spacing: f64) -> Result<(), ConstraintError> {
    if spacing.is_finite() && spacing > 0.0 {
        return Ok(());
    }
    Err(ConstraintError::BadSpacing { vertex, spacing })
}

/// Refuses a spacing that would take more centres than there are places for them, before anything is
/// computed for it.
fn check_count(
    is_candidate: &PerVertex<bool>,
    areas: &[f64],
    spacing: &PerVertex<f64>,
) -> Result<(), ConstraintError> {
    let candidates = is_candidate.iter().filter(|pair| *pair.1);
    let (mut vertices, mut area) = (0, 0.0);
    for (vertex, _) in candidates {
        vertices += 1;
        area += areas[vertex.index()] / spacing[vertex].powi(2);
    }
    // A sum of NaN, of areas that overflow, is not small enough either.
    let wanted = (area * CENTRES_PER_AREA).round();
    let is_possible = wanted <= MOST_PER_VERTEX * vertices.max(1) as f64;
    if is_possible {
        return Ok(());
    }
    Err(ConstraintError::TooManyCentres { wanted, vertices })
}

/// Centres wanted per vertex up to which each vertex is one: patches that are meshed too coarsely, but
/// not spacings in another unit.
const MOST_PER_VERTEX: f64 = 1e3;

/// Points of a hex lattice per square of its spacing.
const CENTRES_PER_AREA: f64 = 1.154_700_538_379_251_5;

struct Region<'a> {
    positions: &'a [Vector3<f64>],
    spacing: &'a PerVertex<f64>,
    areas: Vec<f64>,
    graph: RegionGraph,
}

impl Region<'_> {
    /// The candidates, one list per connected piece.
    fn pieces(&self, is_candidate: &PerVertex<bool>) -> Vec<Vec<VertexId>> {
        let mut pieces: BTreeMap<u32, Vec<VertexId>> = BTreeMap::new();
        for (vertex, _) in is_candidate.iter().filter(|pair| *pair.1) {
            let piece = self.graph.piece(vertex);
            pieces.entry(piece).or_default().push(vertex);
        }
        pieces.into_values().collect()
    }

    /// Adds the greedy centres of one piece.
    fn choose(
        &self,
        piece: &[VertexId],
        settings: &ClusterSettings,
        voronoi: &mut Voronoi,
        centres: &mut Vec<VertexId>,
    ) {
        let area: f64 = piece.iter().map(|&v| self.relative_area(v)).sum();
        if area < settings.smallest_piece {
            return;
        }
        let count = (area * CENTRES_PER_AREA).round().max(1.0) as usize;
        let entry = |voronoi: &Voronoi, v: VertexId| (voronoi.distance[v.index()], Reverse(v));
        let mut farthest: BinaryHeap<_> = piece.iter().map(|&v| entry(voronoi, v)).collect();
        let first = centres.len();
        while centres.len() < first + count
            && let Some((distance, Reverse(vertex))) = farthest.pop()
        {
            // Distances only shrink: an entry that is out of date goes back with its new one.
            let current = entry(voronoi, vertex);
            if current.0 < distance {
                farthest.push(current);
            } else {
                let number = centres.len() as u32;
                self.graph.add_sources(voronoi, [(vertex, number)], 0);
                centres.push(vertex);
            }
        }
    }

    /// Area of a vertex in squares of its spacing.
    fn relative_area(&self, vertex: VertexId) -> f64 {
        self.areas[vertex.index()] / self.spacing[vertex].powi(2)
    }

    /// One round of Lloyd's algorithm; says whether a centre moved.
    ///
    /// The energy `Σ ∫ (d/s)² dA/s²` makes cells grow with the spacing: each vertex weighs
    /// `area/s⁴`.
    fn relax(
        &self,
        is_candidate: &PerVertex<bool>,
        voronoi: &mut Voronoi,
        centres: &mut [VertexId],
    ) -> bool {
        // Without the border: the middle of a cell keeps its distance from it by itself.
        *voronoi = Voronoi::new(is_candidate.len());
        let sources = centres.iter().copied().zip(0..);
        self.graph.add_sources(voronoi, sources, 0);
        let mut cells = vec![Vec::new(); centres.len()];
        for (vertex, _) in is_candidate.iter().filter(|pair| *pair.1) {
            // Pieces too small for a centre have no owner, and no cell.
            if let Some(cell) = cells.get_mut(voronoi.owner[vertex.index()] as usize) {
                cell.push(vertex);
            }
        }
        let mut has_moved = false;
        for (centre, cell) in centres.iter_mut().zip(&cells) {
            let own_spacing = self.spacing[*centre];
            let weight =
                |v: VertexId| self.areas[v.index()] * (own_spacing / self.spacing[v]).powi(4);
            // A mean in space lies off a curved surface, and centres are vertices.
            let moved = self.nearest(cell, self.middle(cell, weight));
            has_moved |= moved != *centre;
            *centre = moved;
        }
        has_moved
    }

    /// Weighted mean of positions; of their plain mean where nothing weighs.
    fn middle(&self, vertices: &[VertexId], weight: impl Fn(VertexId) -> f64) -> Vector3<f64> {
        // Relative to the cell, so that a mesh far from the origin keeps its digits.
        let origin = self.positions[vertices[0].index()];
        let mut total = 0.0;
        let mut sum = Vector3::zeros();
        for &vertex in vertices {
            let w = weight(vertex);
            sum += (self.positions[vertex.index()] - origin) * w;
            total += w;
        }
        if total > 0.0 {
            origin + sum / total
        } else {
            origin
        }
    }

    fn nearest(&self, vertices: &[VertexId], place: Vector3<f64>) -> VertexId {
        let distance = |v: VertexId| (self.positions[v.index()] - place).norm() / self.spacing[v];
        // In ticks: vertices that only rounding tells apart are equal, and the lowest is taken.
        let best = vertices.iter().min_by_key(|&&v| (ticks(distance(v)), v));
        *best.expect("a piece or cell holds at least one vertex")
    }
}
