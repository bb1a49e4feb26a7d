//! The remesh: split, collapse, relax, and what comes out.

use ruga_mesh::{MaterialPoint, PerEdge, PerVertex, SparseRows, TriMesh};

use crate::collapse::collapse_short_edges;
use crate::counts::Counts;
use crate::flip::flip_around;
use crate::half_edges::HalfEdges;
use crate::patch::Patch;
use crate::relax::relax_new_vertices;
use crate::sizing::setting;
use crate::touched::Touched;
use crate::{Metric, RemeshError, SizeLimits, Sizing, Surface, SurfaceMesh, Transfer};

/// Rounds of the closing loop; one that changes nothing ends it, and two are usual.
const MAX_CLOSING_ROUNDS: usize = 8;

/// Sweeps over the new vertices. More give rounder triangles, slowly: the mean shape is 0.96 of
/// equilateral after four and 0.97 after eight, at a tenth of the whole time for each.
const RELAXATIONS: usize = 4;

/// Interpolation weights below this are rounding: they are dropped, so that a new border vertex
/// depends on border vertices alone.
const LEAST_WEIGHT: f64 = 1e-9;

/// Share of edges under half the wanted length, among those that nothing forces, up to which a
/// remesh counts as converged. Ten times what an ordinary remesh leaves: a few edges stay because
/// their collapse would make a neighbour too long or turn a face over.
const MOST_SHORT: f64 = 0.02;

/// Short edges that are allowed in any case; the share of a small mesh is one or two edges.
const FEW_SHORT: f64 = 2.0;

/// Settings of a remesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemeshSettings {
    /// Limits that the sizing is held to first.
    pub limits: SizeLimits,
    /// Largest turn of a border or feature at a vertex that may still be removed, radians, in
    /// 0..π/2; default 0.35 (20 degrees). A sharper vertex is a corner and survives. A smaller
    /// value keeps a curved border's area better (a turn of 0.35 cuts 2 %), at more vertices.
    pub corner_angle: f64,
    /// Refuse a sizing that asks for more vertices than this. Default two million, some 2 GB in
    /// the solver's factor. On a surface so crumpled that its normals say nothing about its faces
    /// the estimate may be far too low: there splitting stops at twice as many new vertices.
    pub max_vertices: usize,
}

impl Default for RemeshSettings {
    fn default() -> Self {
        Self {
            limits: SizeLimits::default(),
            corner_angle: 0.35,
            max_vertices: 2_000_000,
        }
    }
}

/// A mesh that follows a sizing, and how to get there.
#[derive(Clone, Debug)]
pub struct Remeshed {
    /// The new mesh: surviving vertices in their old order, then new ones.
    pub mesh: SurfaceMesh,
    /// New per-vertex values from old ones.
    pub transfer: Transfer,
    /// The limited sizing at the new vertices.
    pub sizing: Sizing,
    /// Report of what was done and how well the metric is met.
    pub report: RemeshReport,
}

/// Report of what a remesh did and what it left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemeshReport {
    /// Edges split.
    pub splits: usize,
    /// Edges flipped.
    pub flips: usize,
    /// Edges collapsed.
    pub collapses: usize,
    /// Moves of new vertices.
    pub moves: usize,
    /// True when no pass ran into its bound, no edge is too long, and of the edges that
    /// [`Self::short_unforced`] counts there are at most two and one in fifty. If not, the mesh is
    /// sound, but less well shaped, coarser where the surface had no place for a new vertex, or
    /// finer where vertices could not be removed.
    pub converged: bool,
    /// Edges of the new mesh.
    pub edges: usize,
    /// Edges with a metric length over 1.5.
    pub too_long: usize,
    /// Edges with a metric length under 0.5; borders, features and fixed vertices force some.
    pub too_short: usize,
    /// Too short edges that no border, feature or fixed vertex forces: one end at least is free.
    pub short_unforced: usize,
    /// Shortest and longest metric length.
    pub metric_lengths: [f64; 2],
}

impl RemeshReport {
    /// Share of edges with a metric length in 0.5..=1.5.
    pub fn share_met(&self) -> f64 {
        1.0 - (self.too_long + self.too_short) as f64 / self.edges.max(1) as f64
    }
}

/// Makes a mesh follow a sizing by splitting, flipping and collapsing edges (Narain et al. 2012)
/// and by moving new vertices along the surface.
///
/// Every pass is bounded, and no pass undoes another: no flip or collapse makes an edge that would
/// be split, so splitting ends first; collapses only remove. A mesh that follows the sizing within
/// the hysteresis (metric lengths in 0.63..=1.48, Delaunay to 3 degrees) comes back unchanged.
/// The result depends on nothing but the input.
///
/// # Errors
/// Arrays that do not fit, settings out of range, bad tensors or positions, vertices with several
/// fans of faces, or a sizing that asks for more than `max_vertices`.
pub fn remesh(
    mesh: &SurfaceMesh,
    sizing: &Sizing,
    surface: &dyn Surface,
    settings: &RemeshSettings,
) -> Result<Remeshed, RemeshError> {
    let limited = sizing.limited(mesh, surface, &settings.limits)?;
    // Before anything is built: a sizing in the wrong unit asks for billions.
    let estimate = limited.vertex_estimate(mesh)?;
    if estimate > settings.max_vertices {
        return Err(RemeshError::TooManyVertices {
            estimate,
            limit: settings.max_vertices,
        });
    }
    follow(Patch::new(mesh, &limited, surface)?, settings)
}

/// Makes a mesh follow a metric that is asked at every new vertex, instead of interpolating what
/// was asked at the old ones.
///
/// So a coarse mesh gets there in one go. What the metric wants between vertices is seen as far as
/// `max_edge` makes it split there. Shortest and longest edge and the aspect are held as by [`remesh`];
/// grading is left to the metric, and the number of vertices is not foretold: splitting stops at twice
/// `max_vertices` new ones. A new vertex where the metric gives no tensor takes an interpolated one.
///
/// # Errors
/// As [`remesh`]; [`RemeshError::Tensor`] for an old vertex where the metric gives no tensor.
pub fn remesh_to_metric(
    mesh: &SurfaceMesh,
    metric: &Metric<'_>,
    surface: &dyn Surface,
    settings: &RemeshSettings,
) -> Result<Remeshed, RemeshError> {
    let limits = SizeLimits {
        grading: f64::INFINITY,
        ..settings.limits
    };
    let limited = Sizing::from_metric(mesh, metric).limited(mesh, surface, &limits)?;
    let mut patch = Patch::new(mesh, &limited, surface)?;
    // Answers at new vertices are held to what those at the old ones were.
    patch.ask(metric, limits.within(mesh));
    follow(patch, settings)
}

/// The passes, on a patch that knows its sizing.
fn follow(mut patch: Patch<'_>, settings: &RemeshSettings) -> Result<Remeshed, RemeshError> {
    setting("corner_angle", settings.corner_angle, "0 to 1.57", |v| {
        (0.0..=1.57).contains(&v)
    })?;
    let mut counts = Counts::default();
    let corner = settings.corner_angle.cos();
    // A long edge may be no more than the wrong diagonal, and a flip leaves one vertex fewer than a
    // split.
    flip_everywhere(&mut patch, &mut counts);
    // Twice the limit and beyond the old mesh, which may be finer than what is asked for now.
    let most = settings.max_vertices.saturating_mul(2);
    let most = most.saturating_add(patch.old.mesh.vertex_count());
    let mut converged = crate::split::split_long_edges(&mut patch, &mut counts, most);
    if counts.splits > 0 {
        patch.renumber();
    }
    // Moves shorten some edges and lengthen others, so each sweep goes with collapses before it and
    // splits after.
    for _ in 0..RELAXATIONS {
        converged &= collapse_short_edges(&mut patch, corner, &mut counts);
        relax_new_vertices(&mut patch, &mut counts);
        // Where the surface had no place for a middle it may have one after the moves.
        converged &= crate::split::split_long_edges(&mut patch, &mut counts, most);
    }
    converged &= close(&mut patch, corner, &mut counts);
    let made = finish(&patch, counts, converged);
    if made.report.short_unforced as f64 <= most_short(made.report.edges) {
        return Ok(made);
    }
    // Only then do old vertices move: values that are carried over stay exact where they can.
    patch.let_ends_meet();
    converged &= close(&mut patch, corner, &mut counts);
    Ok(finish(&patch, counts, converged))
}

/// Short edges that nothing forces, of so many, up to which a remesh has converged.
fn most_short(edges: usize) -> f64 {
    (MOST_SHORT * edges as f64).max(FEW_SHORT)
}

/// Collapses and flips over the whole mesh until neither finds anything to do.
fn close(patch: &mut Patch, corner: f64, counts: &mut Counts) -> bool {
    for _ in 0..MAX_CLOSING_ROUNDS {
        let before = *counts;
        let ended = collapse_short_edges(patch, corner, counts);
        let left = flip_everywhere(patch, counts);
        if *counts == before {
            return ended && left == 0;
        }
    }
    false
}

fn flip_everywhere(patch: &mut Patch, counts: &mut Counts) -> usize {
    let edges = patch.topology.edges().collect();
    flip_around(patch, edges, &mut Touched::new(), counts)
}

fn finish(patch: &Patch, counts: Counts, converged: bool) -> Remeshed {
    let mut kept: Vec<u32> = (0..patch.topology.vertex_slots() as u32)
        .filter(|&v| patch.topology.is_alive_vertex(v))
        .collect();
    // A stable sort: new vertices come after the survivors, and keep the order along the curve that
    // makes neighbours near in memory.
    kept.sort_by_key(|&v| patch.old_vertex(v).map_or(u32::MAX, |old| old.0));
    let (mesh, features) = compact_mesh(&patch.topology, &kept);
    let mesh = SurfaceMesh {
        mesh,
        points: take(&kept, |v| patch.points[v as usize]),
        positions: take(&kept, |v| patch.position(v)),
        features,
        fixed: take(&kept, |v| patch.is_fixed(v)),
    };
    Remeshed {
        mesh,
        transfer: transfer(patch, &kept),
        sizing: Sizing {
            tensors: take(&kept, |v| patch.tensor(v).matrix()),
        },
        report: report(patch, counts, converged),
    }
}

fn take<T>(kept: &[u32], value: impl Fn(u32) -> T) -> PerVertex<T> {
    kept.iter().map(|&v| value(v)).collect()
}

/// The surviving faces with their vertices numbered anew, and which edges are features.
fn compact_mesh(topology: &HalfEdges, kept: &[u32]) -> (TriMesh, PerEdge<bool>) {
    let mut number = vec![u32::MAX; topology.vertex_slots()];
    for (new, &v) in kept.iter().enumerate() {
        number[v as usize] = new as u32;
    }
    let slots: Vec<u32> = (0..topology.face_slots() as u32)
        .filter(|&f| topology.face(f).is_some())
        .collect();
    let faces = slots
        .iter()
        .filter_map(|&f| topology.face(f))
        .map(|face| face.map(|v| number[v as usize]))
        .collect();
    let mesh = TriMesh::new(kept.len(), faces).expect("edits keep the mesh manifold");
    let mut features = PerEdge::filled(mesh.edges().len(), false);
    for (face, &slot) in mesh.faces().ids().zip(&slots) {
        for (corner, edge) in mesh.face_edges(face).into_iter().enumerate() {
            features[edge] |= topology.is_feature(3 * slot + corner as u32);
        }
    }
    (mesh, features)
}

fn transfer(patch: &Patch, kept: &[u32]) -> Transfer {
    let mut rows = SparseRows::default();
    let mut survivors = Vec::with_capacity(kept.len());
    for &v in kept {
        let survivor = patch.survivor(v);
        match survivor {
            Some(old) => rows.push_row(&mut [(old.0, 1.0)]),
            None => push_origin(&mut rows, patch.old, patch.origin(v)),
        }
        survivors.push(survivor);
    }
    Transfer {
        origins: take(kept, |v| patch.origin(v)),
        rows,
        survivors: survivors.into(),
    }
}

fn push_origin(rows: &mut SparseRows, old: &SurfaceMesh, origin: MaterialPoint) {
    let corners = old.mesh.faces()[origin.face];
    let mut terms: Vec<(u32, f64)> = corners
        .into_iter()
        .zip(origin.barycentric)
        .filter(|&(_, weight)| weight > LEAST_WEIGHT)
        .map(|(v, weight)| (v.0, weight))
        .collect();
    // Constants have to come over exactly: a rigid translation is one.
    let sum: f64 = terms.iter().map(|term| term.1).sum();
    terms.iter_mut().for_each(|term| term.1 /= sum);
    rows.push_row(&mut terms);
}

fn report(patch: &Patch, counts: Counts, converged: bool) -> RemeshReport {
    let mut result = RemeshReport {
        splits: counts.splits,
        flips: counts.flips,
        collapses: counts.collapses,
        moves: counts.moves,
        converged,
        edges: 0,
        too_long: 0,
        too_short: 0,
        short_unforced: 0,
        metric_lengths: [f64::INFINITY, 0.0],
    };
    for h in patch.topology.edges() {
        let length = patch.half_edge_length(h);
        result.edges += 1;
        // Wider than the hysteresis on both sides, so that what was left alone on purpose is not
        // counted.
        result.too_long += usize::from(length > 1.5);
        if length < 0.5 {
            result.too_short += 1;
            let ends = [patch.topology.tail(h), patch.topology.head(h)];
            result.short_unforced += usize::from(ends.iter().any(|&v| patch.is_free(v)));
        }
        let [shortest, longest] = result.metric_lengths;
        result.metric_lengths = [shortest.min(length), longest.max(length)];
    }
    let is_fine = result.short_unforced as f64 <= most_short(result.edges);
    result.converged &= result.too_long == 0 && is_fine;
    result
}

#[cfg(test)]
mod tests {
    use ruga_mesh::FaceId;

    use super::*;

    #[test]
    fn dropped_weights_leave_a_sum_of_one() {
        let mesh = TriMesh::new(3, vec![[0, 1, 2]]).expect("one face");
        let old = SurfaceMesh {
            points: mesh
                .faces()
                .ids()
                .flat_map(|f| (0..3).map(move |c| MaterialPoint::at_corner(f, c)))
                .collect(),
            positions: PerVertex::filled(3, nalgebra::Vector3::zeros()),
            features: PerEdge::filled(3, false),
            fixed: PerVertex::filled(3, false),
            mesh,
        };
        let mut rows = SparseRows::default();
        let origin = MaterialPoint {
            face: FaceId(0),
            barycentric: [0.3, 1e-12, 0.7],
        };
        push_origin(&mut rows, &old, origin);
        assert_eq!(rows.row(0).map(|term| term.0).collect::<Vec<_>>(), [0, 2]);
    }
}
