//! Valleys of a relief on a surface: the lines along which it is most sharply bent upwards.

use std::collections::BTreeSet;

use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};
use ruga_mesh::{EdgeId, Id, TriMesh, VertexId, tangent_frame, vertex_normals};

/// A height on every vertex of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Relief<'a> {
    /// Triangles of the surface.
    pub mesh: &'a TriMesh,
    /// Vertices of the surface without the relief, m.
    pub positions: &'a [Vector3<f64>],
    /// Height above it along its normals, m.
    pub heights: &'a [f64],
}

/// A place of a valley: where it crosses an edge of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValleyPoint {
    /// Ends of the edge.
    pub vertices: [VertexId; 2],
    /// Share of the way from the first to the second.
    pub fraction: f64,
    /// Curvature across the valley, 1/m.
    pub curvature: f64,
}

/// The bottom of a valley, from edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Valley {
    /// Its places in order, at least two.
    pub points: Vec<ValleyPoint>,
    /// Whether it goes on from the last to the first.
    pub is_closed: bool,
}

/// The relief around a vertex.
#[derive(Clone, Copy)]
struct Bend {
    /// Largest curvature, 1/m.
    curvature: f64,
    /// Its direction on the surface.
    across: Vector3<f64>,
    /// Slope in that direction.
    slope: f64,
}

/// The valleys of a relief where its curvature across them is at least that of both ends of an edge in `least`
/// (1/m, > 0, one per vertex).
///
/// A valley is where the slope along the direction of largest curvature changes its sign while that curvature is
/// positive, as in Ohtake, Belyaev and Seidel 2004. Slope and curvature are those of a quadric through
/// the vertices within two edges, near ones weighing more: of waves with twelve vertices to a wavelength the
/// curvature comes out a tenth too small.
///
/// # Panics
/// When there is not one position, height and least curvature per vertex.
pub fn valleys(relief: &Relief<'_>, least: &[f64]) -> Vec<Valley> {
    let mesh = relief.mesh;
    for count in [relief.positions.len(), relief.heights.len(), least.len()] {
        assert_eq!(count, mesh.vertex_count(), "one entry per vertex");
    }
    let bends = bends(relief);
    let crossing = |edge: EdgeId| crossing(&bends, least, mesh.edges()[edge].vertices);
    let crossings: Vec<Option<ValleyPoint>> = mesh.edges().ids().map(crossing).collect();
    // Every face with two crossings joins them; one with three is a place where directions have no sense.
    let mut joined = vec![[None; 2]; crossings.len()];
    for face in mesh.faces().ids() {
        let edges = mesh.face_edges(face).into_iter();
        let crossed: Vec<EdgeId> = edges.filter(|e| crossings[e.index()].is_some()).collect();
        if let [a, b] = crossed[..] {
            for (from, to) in [(a, b), (b, a)] {
                let ends: &mut [Option<EdgeId>; 2] = &mut joined[from.index()];
                match ends[0] {
                    None => ends[0] = Some(to),
                    Some(_) => ends[1] = Some(to),
                }
            }
        }
    }
    chains(&joined)
        .into_iter()
        .map(|(edges, is_closed)| {
            let places = edges.into_iter().filter_map(|edge| crossings[edge]);
            Valley {
                points: places.collect(),
                is_closed,
            }
        })
        .collect()
}

/// Where a valley crosses the edge between two vertices.
fn crossing(bends: &[Option<Bend>], least: &[f64], vertices: [VertexId; 2]) -> Option<ValleyPoint> {
    let [a, b] = [bends[vertices[0].index()]?, bends[vertices[1].index()]?];
    // The direction of largest curvature has no sign of its own.
    let slope = b.slope * a.across.dot(&b.across).signum();
    if a.curvature <= 0.0 || b.curvature <= 0.0 || (a.slope < 0.0) == (slope < 0.0) {
        return None;
    }
    let fraction = a.slope / (a.slope - slope);
    let between = |of: [f64; 2]| of[0] + (of[1] - of[0]) * fraction;
    let curvature = between([a.curvature, b.curvature]);
    let least = between(vertices.map(|v| least[v.index()]));
    (curvature >= least).then_some(ValleyPoint {
        vertices,
        fraction,
        curvature,
    })
}

/// Chains of numbers that are joined to up to two others each, and whether they are closed; chains of one are left
/// out.
fn chains(joined: &[[Option<EdgeId>; 2]]) -> Vec<(Vec<usize>, bool)> {
    let next = |at: usize, from: Option<usize>| {
        let others = joined[at].iter().flatten().map(|edge| edge.index());
        others.filter(|other| Some(*other) != from).min()
    };
    let mut is_used = vec![false; joined.len()];
    let mut found = Vec::new();
    let degree = |at: usize| joined[at].iter().flatten().count();
    // From ends first: what is left then is closed.
    for is_closed in [false, true] {
        for start in 0..joined.len() {
            let begins = if is_closed { 2 } else { 1 };
            if is_used[start] || degree(start) != begins {
                continue;
            }
            let (mut chain, mut from, mut at) = (Vec::new(), None, Some(start));
            while let Some(edge) = at.filter(|&edge| !is_used[edge]) {
                is_used[edge] = true;
                chain.push(edge);
                at = next(edge, from);
                from = Some(edge);
            }
            if chain.len() > 1 {
                found.push((chain, is_closed));
            }
        }
    }
    found
}

/// Largest curvature of the relief at every vertex; `None` where too few vertices are around.
fn bends(relief: &Relief<'_>) -> Vec<Option<Bend>> {
    let (mesh, positions) = (relief.mesh, relief.positions);
    let normals = vertex_normals(mesh, positions);
    let mut beside = vec![BTreeSet::new(); mesh.vertex_count()];
    for (_, edge) in mesh.edges().iter() {
        let [a, b] = edge.vertices.map(Id::index);
        beside[a].insert(b);
        beside[b].insert(a);
    }
    let bend = |v: usize| {
        let mut around: BTreeSet<usize> = beside[v].clone();
        around.extend(beside[v].iter().flat_map(|&w| beside[w].iter().copied()));
        around.insert(v);
        let lengths = beside[v]
            .iter()
            .map(|&w| (positions[w] - positions[v]).norm());
        let edge = lengths.sum::<f64>() / beside[v].len() as f64;
        let frame = tangent_frame(normals[v], Vector3::x());
        let (mut matrix, mut right) = (SMatrix::<f64, 6, 6>::zeros(), SVector::<f64, 6>::zeros());
        for w in around {
            let way = (positions[w] - positions[v]) / edge;
            let (x, y) = (way.dot(&frame[0]), way.dot(&frame[1]));
            let weight = (-(x * x + y * y)).exp();
            let terms = SVector::<f64, 6>::from([1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y]);
            matrix += weight * terms * terms.transpose();
            right += weight * relief.heights[w] * terms;
        }
        let fit = matrix.cholesky()?.solve(&right);
        let second = Matrix2::new(fit[3], fit[4], fit[4], fit[5]) / (edge * edge);
        let eigen = second.symmetric_eigen();
        let largest = eigen.eigenvalues.imax();
        let direction = eigen.eigenvectors.column(largest);
        let gradient = Vector2::new(fit[1], fit[2]) / edge;
        let (curvature, slope) = (eigen.eigenvalues[largest], gradient.dot(&direction));
        let is_valley = curvature > -eigen.eigenvalues[1 - largest];
        (curvature.is_finite() && slope.is_finite() && is_valley).then(|| Bend {
            curvature,
            across: frame[0] * direction[0] + frame[1] * direction[1],
            slope,
        })
    };
    (0..mesh.vertex_count()).map(bend).collect()
}
