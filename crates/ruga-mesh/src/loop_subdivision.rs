//! Loop subdivision with border creases, and its limit surface.
//!
//! Loop, *Smooth subdivision surfaces based on triangles*, 1987, with the crease and limit rules
//! of Hoppe et al., *Piecewise smooth surface reconstruction*, 1994. The scheme is linear: the same
//! rows apply to a rest shape, to a blend shape's deltas and to a posed shape.

use std::f64::consts::TAU;

use crate::{
    FaceId, Id, MaterialPoint, PerFace, PerVertex, SparseRows, TriMesh, VertexFan, VertexId,
};

/// Place of a subdivided face in the coarse mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceOrigin {
    /// The face of the coarse mesh.
    pub face: FaceId,
    /// Barycentric coordinates, in the coarse face, of the three corners.
    pub corners: [[f64; 3]; 3],
}

impl FaceOrigin {
    /// Barycentric coordinates in the coarse face of a point given in the fine face.
    pub fn lift(&self, barycentric: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            (0..3)
                .map(|corner| barycentric[corner] * self.corners[corner][i])
                .sum()
        })
    }

    /// The place of the coarse mesh under a point given in the fine face.
    pub fn place(&self, barycentric: [f64; 3]) -> MaterialPoint {
        MaterialPoint {
            face: self.face,
            barycentric: self.lift(barycentric),
        }
    }
}

/// A mesh after some levels of Loop subdivision.
///
/// Fine face `f` of level `l` lies in face `f >> 2 (l - m)` of level `m`; the vertices of a level
/// are the first vertices of the next.
#[derive(Clone, Debug)]
pub struct Subdivision {
    /// The fine mesh.
    pub mesh: TriMesh,
    /// Fine control points from coarse ones.
    pub fine_from_coarse: SparseRows,
    /// Place of each fine face in the coarse mesh.
    pub origins: PerFace<FaceOrigin>,
    /// Sharp corners carried to the fine mesh.
    pub corners: PerVertex<bool>,
}

/// Position and tangents of the Loop limit surface at the vertices of a mesh.
#[derive(Clone, Debug)]
pub struct LimitRows {
    /// Limit positions from control points.
    pub position: SparseRows,
    /// First tangent; empty rows at corners, where the limit has no tangent plane.
    pub first_tangent: SparseRows,
    /// Second tangent; first cross second points outwards.
    pub second_tangent: SparseRows,
}

/// Subdivides `levels` times.
///
/// Borders are creases (uniform cubic B-splines). `corners` marks vertices that stay where they
/// are; vertices where two fans meet and vertices without faces stay too.
///
/// # Panics
/// When `corners` has not one entry per vertex, or the result would have more than
/// [`TriMesh::MAX_COUNT`] faces: each level makes four of one.
pub fn subdivide(mesh: &TriMesh, levels: u32, corners: &PerVertex<bool>) -> Subdivision {
    subdivide_while(mesh, levels, corners, &mut || true).expect("nothing ends it early")
}

/// Subdivides like [`subdivide`], as long as `goes_on`, which is asked after every level, agrees;
/// `None` when it does not.
///
/// # Panics
/// As [`subdivide`].
pub fn subdivide_while(
    mesh: &TriMesh,
    levels: u32,
    corners: &PerVertex<bool>,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Subdivision> {
    let mut result = undivided(mesh, levels, corners);
    for _ in 0..levels {
        result = subdivide_once(&result);
        if !goes_on() {
            return None;
        }
    }
    Some(result)
}

/// The mesh as it is before it is subdivided `levels` times.
fn undivided(mesh: &TriMesh, levels: u32, corners: &PerVertex<bool>) -> Subdivision {
    assert_eq!(
        corners.len(),
        mesh.vertex_count(),
        "one corner flag per vertex"
    );
    assert!(
        fits(mesh.face_count(), levels),
        "{} faces cannot be subdivided {levels} times",
        mesh.face_count()
    );
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Subdivision {
        mesh: mesh.clone(),
        fine_from_coarse: SparseRows::identity(mesh.vertex_count()),
        origins: mesh
            .faces()
            .ids()
            .map(|face| FaceOrigin {
                face,
                corners: unit,
            })
            .collect(),
        corners: corners.clone(),
    }
}

/// Whether a mesh may be subdivided so often: told before memory for it is asked for.
fn fits(faces: usize, levels: u32) -> bool {
    let factor = 4_usize.checked_pow(levels);
    let count = factor.and_then(|factor| faces.checked_mul(factor));
    faces == 0 || count.is_some_and(|count| count <= TriMesh::MAX_COUNT)
}

fn subdivide_once(coarse: &Subdivision) -> Subdivision {
    let mesh = &coarse.mesh;
    let mut rows = SparseRows::default();
    let mut terms = Vec::new();
    for vertex in PerVertex::<()>::filled(mesh.vertex_count(), ()).ids() {
        vertex_rule(mesh, vertex, coarse.corners[vertex], &mut terms);
        rows.push_row(&mut terms);
    }
    for (_, edge) in mesh.edges().iter() {
        let [tail, head] = edge.vertices.map(|v| v.0);
        terms.clear();
        match edge.apexes {
            [Some(left), Some(right)] => terms.extend([
                (tail, 0.375),
                (head, 0.375),
                (left.0, 0.125),
                (right.0, 0.125),
            ]),
            // Nothing from inside: the border's curve then depends on the border alone.
            _ => terms.extend([(tail, 0.5), (head, 0.5)]),
        }
        rows.push_row(&mut terms);
    }
    let (faces, origins) = split_faces(coarse);
    let vertex_count = mesh.vertex_count() + mesh.edges().len();
    let mut corners = coarse.corners.clone().into_vec();
    corners.resize(vertex_count, false);
    Subdivision {
        mesh: TriMesh::new(vertex_count, faces).expect("the 1-to-4 split of a mesh is a mesh"),
        fine_from_coarse: rows.after(&coarse.fine_from_coarse),
        origins,
        corners: corners.into(),
    }
}

/// Splits every face into three corner faces and the middle one, in this order.
///
/// ```text
///        2
///       / \
///     e2---e1
///     / \ / \
///    0---e0--1
/// ```
fn split_faces(coarse: &Subdivision) -> (Vec<[u32; 3]>, PerFace<FaceOrigin>) {
    let mesh = &coarse.mesh;
    let mut faces = Vec::with_capacity(4 * mesh.face_count());
    let mut origins = Vec::with_capacity(4 * mesh.face_count());
    let middle = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
    for (face, vertices) in mesh.faces().iter() {
        let [v0, v1, v2] = vertices.map(|v| v.0);
        let [e0, e1, e2] = mesh
            .face_edges(face)
            .map(|e| (mesh.vertex_count() + e.index()) as u32);
        faces.extend([[v0, e0, e2], [e0, v1, e1], [e2, e1, v2], [e0, e1, e2]]);
        let origin = coarse.origins[face];
        let [c0, c1, c2] = origin.corners;
        let (m0, m1, m2) = (middle(c0, c1), middle(c1, c2), middle(c2, c0));
        for corners in [[c0, m0, m2], [m0, c1, m1], [m2, m1, c2], [m0, m1, m2]] {
            origins.push(FaceOrigin {
                face: origin.face,
                corners,
            });
        }
    }
    (faces, origins.into())
}

/// Loop's weight of each of `valence` neighbours in the vertex rule.
fn neighbour_weight(valence: usize) -> f64 {
    let n = valence as f64;
    let c = 0.375 + 0.25 * (TAU / n).cos();
    (0.625 - c * c) / n
}

fn vertex_rule(mesh: &TriMesh, vertex: VertexId, is_corner: bool, terms: &mut Vec<(u32, f64)>) {
    terms.clear();
    let ring = if is_corner { None } else { mesh.ring(vertex) };
    match ring {
        Some(ring) if ring.closed => {
            let valence = ring.spokes.len();
            // The weights of Loop 1987: `limit_rows` and the sectors' eigenvalues belong to them.
            let weight = neighbour_weight(valence);
            terms.push((vertex.0, 1.0 - weight * valence as f64));
            terms.extend(ring.spokes.iter().map(|v| (v.0, weight)));
        }
        Some(ring) => {
            let (first, last) = border_neighbours(&ring);
            terms.extend([(vertex.0, 0.75), (first.0, 0.125), (last.0, 0.125)]);
        }
        None => terms.push((vertex.0, 1.0)),
    }
}

fn border_neighbours(ring: &VertexFan) -> (VertexId, VertexId) {
    (ring.spokes[0], ring.spokes[ring.spokes.len() - 1])
}

/// Limit positions and tangents at the vertices of `mesh`.
///
/// # Panics
/// When `corners` has not one entry per vertex.
pub fn limit_rows(mesh: &TriMesh, corners: &PerVertex<bool>) -> LimitRows {
    limit_rows_at(mesh, corners, &corners.ids().collect::<Vec<_>>())
}

/// Limit positions and tangents at the chosen vertices of `mesh`, in the order given.
///
/// # Panics
/// When `corners` has not one entry per vertex, or a vertex is none of the mesh's.
pub fn limit_rows_at(mesh: &TriMesh, corners: &PerVertex<bool>, chosen: &[VertexId]) -> LimitRows {
    assert_eq!(
        corners.len(),
        mesh.vertex_count(),
        "one corner flag per vertex"
    );
    let mut limit = LimitRows {
        position: SparseRows::default(),
        first_tangent: SparseRows::default(),
        second_tangent: SparseRows::default(),
    };
    let (mut position, mut first, mut second) = (Vec::new(), Vec::new(), Vec::new());
    for &vertex in chosen {
        position.clear();
        first.clear();
        second.clear();
        let ring = if corners[vertex] {
            None
        } else {
            mesh.ring(vertex)
        };
        match ring {
            Some(ring) if ring.closed => {
                interior_limit(vertex, &ring, &mut position, &mut first, &mut second);
            }
            Some(ring) => border_limit(vertex, &ring, &mut position, &mut first, &mut second),
            None => position.push((vertex.0, 1.0)),
        }
        limit.position.push_row(&mut position);
        limit.first_tangent.push_row(&mut first);
        limit.second_tangent.push_row(&mut second);
    }
    limit
}

type Terms = Vec<(u32, f64)>;

fn interior_limit(
    vertex: VertexId,
    ring: &VertexFan,
    position: &mut Terms,
    first: &mut Terms,
    second: &mut Terms,
) {
    let n = ring.spokes.len() as f64;
    // Left eigenvectors of the rules around the vertex: for eigenvalue one this weight, for the two
    // equal ones of the tangents a cosine and a sine. Spokes run counter-clockwise, so that cosine
    // cross sine points outwards.
    let weight = 1.0 / (n + 0.375 / neighbour_weight(ring.spokes.len()));
    position.push((vertex.0, 1.0 - n * weight));
    for (i, v) in ring.spokes.iter().enumerate() {
        let (sin, cos) = (TAU * i as f64 / n).sin_cos();
        position.push((v.0, weight));
        first.push((v.0, cos));
        second.push((v.0, sin));
    }
}

/// Limit of a border vertex; the ring runs counter-clockwise from border to border.
///
/// The second tangent is the left eigenvector across the border of this scheme's own subdivision
/// matrix, with eigenvalue `3/8 + cos(angle)/4`. The masks of Hoppe et al. 1994 belong to edge
/// rules that they change near irregular vertices, which we don't.
fn border_limit(
    vertex: VertexId,
    ring: &VertexFan,
    position: &mut Terms,
    first: &mut Terms,
    second: &mut Terms,
) {
    // The spokes turn from `start` over the inside to `end`: so `start - end` cross the inward
    // direction points outwards.
    let (start, end) = border_neighbours(ring);
    position.extend([
        (vertex.0, 4.0 / 6.0),
        (start.0, 1.0 / 6.0),
        (end.0, 1.0 / 6.0),
    ]);
    first.extend([(start.0, 1.0), (end.0, -1.0)]);
    let count = ring.spokes.len();
    // A single face has no inner neighbour: inwards is where the border curve bends to.
    if count == 2 {
        second.extend([(vertex.0, -2.0), (start.0, 1.0), (end.0, 1.0)]);
        return;
    }
    let angle = std::f64::consts::PI / (count - 1) as f64;
    // The sum of sin(i angle) over the inner neighbours.
    let inner = 1.0 / (0.5 * angle).tan();
    // From the eigenvalue equation in the column of `start`; the vertex makes the sum zero.
    let rim = (angle.sin() - inner) / (1.0 + 2.0 * angle.cos());
    second.extend([(start.0, rim), (end.0, rim), (vertex.0, -2.0 * rim - inner)]);
    for (i, v) in ring.spokes.iter().enumerate().take(count - 1).skip(1) {
        second.push((v.0, (i as f64 * angle).sin()));
    }
}
