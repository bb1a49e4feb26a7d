//! Marching triangles: cuts a mesh along the zero line of a level and keeps the positive side.
//!
//! The level is given at vertices and linear in every face, as in Losasso, Irving, Guendelman and Fedkiw,
//! *Melting and burning solids into liquids and gases*, 2006, and in section 6 of Jeong, Kim, Kim 2011,
//! *Shrinkage, wrinkling and ablation of burning cloth and paper*.

use std::ops::{Add, Mul};

use ruga_mesh::{FaceId, Id, PerFace, PerVertex, TriMesh, VertexFan, VertexId};

use crate::RemeshError;

/// Share of a face's area above which snapping keeps it where it has drawn all three corners to the line.
const MOSTLY_LEFT: f64 = 0.5;

/// The part of a mesh where a level is positive.
///
/// ```
/// use ruga_mesh::{PerVertex, TriMesh};
/// use ruga_remesh::{LevelCut, shares_left};
///
/// // A unit square, of which three quarters are left of x = 0.75.
/// let square = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
/// let x = [0.0, 1.0, 1.0, 0.0];
/// let level: PerVertex<f64> = x.into_iter().map(|x| 0.75 - x).collect();
/// let cut = LevelCut::new(&square, &level, 0.0)?;
/// assert_eq!(cut.mesh.face_count(), 3);
/// assert!(cut.vertices.iter().all(|(_, point)| point.value(&x) <= 0.75));
/// let left: f64 = shares_left(&square, &level)?.iter().map(|(_, share)| share * 0.5).sum();
/// assert!((left - 0.75).abs() < 1e-15);
/// # Ok::<(), ruga_remesh::RemeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LevelCut {
    /// The mesh of what is left, without unused vertices; vertices in the order in which its faces use them.
    ///
    /// It is manifold: where parts touch in a point, each has a vertex of its own there.
    pub mesh: TriMesh,
    /// Place of every vertex on the given mesh.
    pub vertices: PerVertex<CutPoint>,
    /// The face of the given mesh that each face is a part of, or all of; ascending.
    pub parents: PerFace<FaceId>,
}

/// A place on an edge of a mesh, or at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPoint {
    /// The end that is left and the end that is gone; for a vertex of the given mesh that vertex twice.
    pub ends: [VertexId; 2],
    /// Fraction of the way from the first end to the second, 0 to 1; for a vertex of the given mesh 0.
    pub fraction: f64,
}

impl CutPoint {
    fn at_vertex(vertex: VertexId) -> Self {
        Self {
            ends: [vertex; 2],
            fraction: 0.0,
        }
    }

    /// The linear interpolation of vertex values of the given mesh, as positions.
    ///
    /// # Panics
    /// When `values` has no entry for one of the ends.
    pub fn value<T>(&self, values: &[T]) -> T
    where
        T: Copy + Add<Output = T> + Mul<f64, Output = T>,
    {
        let [start, end] = self.ends.map(|v| values[v.index()]);
        start * (1.0 - self.fraction) + end * self.fraction
    }
}

impl LevelCut {
    /// Keeps the part of `mesh` where `level`, of any unit, is positive.
    ///
    /// A vertex of level zero lies on the line: faces around it with a positive corner stay, others go.
    /// Quadrilaterals get the diagonal that makes the larger least area.
    ///
    /// # Snapping
    /// A crossing nearer to a vertex than the share `snap` of its edge, 0 to 0.5, makes the level of that
    /// vertex zero in all faces around it; 0 keeps the exact line, with the slivers that it makes. The height
    /// of a face over its longest edge, relative to that edge, is then at least `snap (1 - snap)` times that
    /// of its parent: with 0.02, above 1 % where the parent has 52 %.
    ///
    /// What this changes lies in the faces around such vertices. A face goes if all its positive corners are
    /// drawn to the line, as the tip of a spike; but one that has all three corners on the line stays as a
    /// whole if more than half of it was left.
    ///
    /// # Errors
    /// [`RemeshError::Length`] and [`RemeshError::Level`] for the level, [`RemeshError::Setting`] for `snap`,
    /// [`RemeshError::Mesh`] where vertices and edges together are more than [`TriMesh::MAX_COUNT`].
    pub fn new(mesh: &TriMesh, level: &PerVertex<f64>, snap: f64) -> Result<Self, RemeshError> {
        check_level(mesh, level)?;
        if !(0.0..=0.5).contains(&snap) {
            return Err(RemeshError::Setting {
                name: "snap",
                value: snap,
                accepted: "0 to 0.5",
            });
        }
        let snapped = snapped(mesh, level, snap);
        let (mut faces, mut parents) = (Vec::new(), Vec::new());
        for (face, corners) in mesh.faces().iter() {
            let levels = corners.map(|v| snapped[v]);
            let parts = if levels == [0.0; 3] {
                let is_left = share_left(corners.map(|v| level[v])) > MOSTLY_LEFT;
                Vec::from_iter(is_left.then_some([0, 1, 2]))
            } else {
                parts_left(levels)
            };
            // Vertices come first, then a number per edge, since an edge is crossed once at most.
            let edges = mesh.face_edges(face);
            let number = |place: usize| match place.checked_sub(3) {
                None => corners[place].0,
                Some(edge) => (mesh.vertex_count() + edges[edge].index()) as u32,
            };
            parents.extend(parts.iter().map(|_| face));
            faces.extend(parts.iter().map(|part| part.map(number)));
        }
        let touching = TriMesh::new(mesh.vertex_count() + mesh.edges().len(), faces)?;
        let point = |number: VertexId| match number.index().checked_sub(mesh.vertex_count()) {
            None => CutPoint::at_vertex(number),
            Some(edge) => crossing_of(mesh.edges().as_slice()[edge].vertices, &snapped),
        };
        let (mesh, origins) = separated(&touching)?;
        Ok(Self {
            mesh,
            vertices: origins.into_iter().map(point).collect(),
            parents: parents.into(),
        })
    }
}

/// Share of every face's area where `level`, linear in it, is positive; exact, without snapping.
///
/// With one positive corner it is the product, over the two others, of `a / (a - b)` with the levels `a` of
/// that corner and `b` of the other; with one negative corner it is one less such a product.
///
/// # Errors
/// [`RemeshError::Length`] and [`RemeshError::Level`].
pub fn shares_left(mesh: &TriMesh, level: &PerVertex<f64>) -> Result<PerFace<f64>, RemeshError> {
    check_level(mesh, level)?;
    let faces = mesh.faces().iter();
    Ok(faces
        .map(|(_, corners)| share_left(corners.map(|v| level[v])))
        .collect())
}

fn check_level(mesh: &TriMesh, level: &PerVertex<f64>) -> Result<(), RemeshError> {
    if level.len() != mesh.vertex_count() {
        return Err(RemeshError::Length {
            what: "level",
            got: level.len(),
            expected: mesh.vertex_count(),
        });
    }
    match level.iter().find(|(_, value)| !value.is_finite()) {
        Some((vertex, &value)) => Err(RemeshError::Level { vertex, value }),
        None => Ok(()),
    }
}

/// Fraction of the way from one end of an edge to the other at which the level changes its sign.
fn crossing([from, to]: [f64; 2]) -> Option<f64> {
    // The sign of a product would underflow, and a difference of levels overflow.
    let is_crossed = from.min(to) < 0.0 && from.max(to) > 0.0;
    is_crossed.then(|| 1.0 / (1.0 - to / from))
}

/// Where the line crosses the edge between two vertices that it passes between.
fn crossing_of(mut ends: [VertexId; 2], level: &PerVertex<f64>) -> CutPoint {
    if level[ends[0]] < 0.0 {
        ends.reverse();
    }
    let fraction = crossing(ends.map(|v| level[v]));
    CutPoint {
        ends,
        fraction: fraction.expect("faces are cut where the level changes its sign"),
    }
}

/// Levels with zero at the vertices that a crossing is near to.
fn snapped(mesh: &TriMesh, level: &PerVertex<f64>, snap: f64) -> PerVertex<f64> {
    let mut snapped = level.clone();
    for (_, edge) in mesh.edges().iter() {
        // Crossings are those of the given level, or the order of edges would decide.
        let Some(fraction) = crossing(edge.vertices.map(|v| level[v])) else {
            continue;
        };
        let [start, end] = edge.vertices;
        if fraction < snap {
            snapped[start] = 0.0;
        } else if 1.0 - fraction < snap {
            snapped[end] = 0.0;
        }
    }
    snapped
}

/// The triangles that are left of a face: corners are 0 to 2, the crossing of edge `i` is `3 + i`.
///
/// ```text
///       +               -               -               0
///      / \             / \             / \             / \
///     X---X           X---X           /   X           /   \
///    / gone\         / `.  \         / .'  \         / left\
///   -       -       +----`--+       0-------+       0-------+
/// ```
fn parts_left(levels: [f64; 3]) -> Vec<[usize; 3]> {
    let along = |i: usize| crossing([levels[i], levels[(i + 1) % 3]]);
    let stays = |i: usize| (levels[i] >= 0.0).then_some(i);
    let outline = (0..3).flat_map(|i| [stays(i), along(i).map(|_| 3 + i)]);
    let outline: Vec<usize> = outline.flatten().collect();
    match outline[..] {
        [a, b, c] => vec![[a, b, c]],
        [_, _, _, _] => quadrilateral(levels),
        // A point or an edge on the line.
        _ => Vec::new(),
    }
}

/// The two triangles that are left of a face with one negative corner and two positive ones.
fn quadrilateral(levels: [f64; 3]) -> Vec<[usize; 3]> {
    let gone = usize::from(levels[1] < 0.0) + 2 * usize::from(levels[2] < 0.0);
    let [a, b] = [(gone + 1) % 3, (gone + 2) % 3];
    let [near_a, near_b] = [3 + gone, 3 + b];
    let [from_a, from_b] = [a, b].map(|corner| crossing([levels[corner], levels[gone]]));
    // Relative to the face the parts have the areas `from_a` and `(1 - from_a) from_b`, or those with a and b
    // exchanged, of which the last is the least when `from_a` is the lesser fraction.
    if from_a <= from_b {
        vec![[a, b, near_a], [b, near_b, near_a]]
    } else {
        vec![[a, b, near_b], [a, near_b, near_a]]
    }
}

fn share_left(mut levels: [f64; 3]) -> f64 {
    levels.sort_by(f64::total_cmp);
    let [low, middle, high] = levels;
    // An edge from a positive corner to one on the line is left as a whole.
    let left = |from, to| crossing([from, to]).unwrap_or(1.0);
    if high <= 0.0 {
        0.0
    } else if middle <= 0.0 {
        left(high, middle) * left(high, low)
    } else {
        // Not one less what is gone, which would round away a small rest.
        let [a, b] = [left(middle, low), left(high, low)];
        a + b * (1.0 - a)
    }
}

/// The mesh with a vertex for every fan of faces, and the vertex that each was.
fn separated(mesh: &TriMesh) -> Result<(TriMesh, Vec<VertexId>), RemeshError> {
    let fans = VertexFan::all(mesh);
    let mut faces = vec![[0; 3]; mesh.face_count()];
    for (fan, number) in fans.iter().zip(0..) {
        for &(face, corner) in &fan.faces {
            faces[face.index()][corner] = number;
        }
    }
    let origins: Vec<VertexId> = fans.iter().map(|fan| fan.vertex).collect();
    Ok((TriMesh::new(origins.len(), faces)?, origins))
}
