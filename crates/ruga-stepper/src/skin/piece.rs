//! A part of the driver's surface, whose faces can be split at their edges.

use nalgebra::{Vector2, Vector3};
use ruga_blend::{BaseSurface, Driver};
use ruga_mesh::{EdgeId, FaceId, FaceOrigin, Id, MaterialPoint, PerFace, TriMesh, VertexId};

use crate::skin::fans::one_fan_per_vertex;

/// Part of a surface: places on the driver, and texture coordinates per corner.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) mesh: TriMesh,
    /// The driver's place under every vertex.
    pub(crate) points: Vec<MaterialPoint>,
    /// Place of every face in a face of the driver.
    pub(crate) origins: PerFace<FaceOrigin>,
    /// Texture coordinates of every face's corners.
    pub(crate) uvs: Vec<[Vector2<f64>; 3]>,
}

/// What a split has made.
pub(crate) struct Split {
    /// The new vertices, which follow the old ones.
    pub(crate) born: Vec<NewVertex>,
    /// The old face that every face is a part of, ascending.
    pub(crate) parents: Vec<FaceId>,
}

/// A vertex on an edge of the mesh before.
pub(crate) struct NewVertex {
    /// The ends of that edge.
    pub(crate) ends: [VertexId; 2],
    /// Fraction of the way from the first end to the second.
    pub(crate) fraction: f64,
}

impl Piece {
    /// All of a subdivided surface, with one fan of faces around every vertex.
    pub(crate) fn of(base: &BaseSurface) -> Self {
        let (mesh, copied) = one_fan_per_vertex(base.mesh());
        let base_points = base.vertex_points();
        Self {
            mesh,
            points: copied.iter().map(|v| base_points[v.index()]).collect(),
            origins: base.origins().clone(),
            uvs: base.uvs().as_slice().to_vec(),
        }
    }

    /// Positions of the vertices on the driver's flat facets at rest, m.
    pub(crate) fn flat_positions(&self, driver: &Driver) -> Vec<Vector3<f64>> {
        let place = |point: &MaterialPoint| point.interpolate(driver.topology(), driver.rest());
        self.points.iter().map(place).collect()
    }

    /// Gives every edge with a fraction in `places` a vertex at that part of the way between its two
    /// vertices, and splits the faces beside it; `positions` (m) gets those of the new vertices.
    ///
    /// ```text
    ///       2               2               2
    ///      / \             /|\             / \
    ///     X---X           / | \           X---X
    ///    / `.  \         /  |  \         / \ / \
    ///   0----`--1       0---X---1       0---X---1
    /// ```
    pub(crate) fn split(
        &mut self,
        places: &[Option<f64>],
        positions: &mut Vec<Vector3<f64>>,
    ) -> Split {
        let (born, numbers) = self.add_vertices(places, positions);
        let (mut faces, mut origins, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
        let mut parents = Vec::new();
        for face in self.mesh.faces().ids() {
            let places = self.places_in(face, &numbers, places);
            let vertex = |at: usize| places[at].0;
            let length = |[a, b]: [usize; 2]| {
                let [a, b] = [a, b].map(|at| positions[vertex(at) as usize]);
                (b - a).norm()
            };
            let cut = std::array::from_fn(|edge| vertex(3 + edge) != u32::MAX);
            let (origin, own) = (&self.origins[face], &self.uvs[face.index()]);
            for child in &children(cut, length) {
                faces.push(child.map(vertex));
                let weights = child.map(|at| places[at].1);
                origins.push(FaceOrigin {
                    face: origin.face,
                    corners: weights.map(|weights| origin.lift(weights)),
                });
                uvs.push(weights.map(|weights| blend(own, weights)));
                parents.push(face);
            }
        }
        let mesh = TriMesh::new(positions.len(), faces);
        self.mesh = mesh.expect("neighbours are cut at the same vertices");
        self.origins = origins.into();
        self.uvs = uvs;
        Split { born, parents }
    }

    /// A vertex on every edge that is split: what they are, and the number of each edge's.
    fn add_vertices(
        &mut self,
        places: &[Option<f64>],
        positions: &mut Vec<Vector3<f64>>,
    ) -> (Vec<NewVertex>, Vec<Option<u32>>) {
        let mut born = Vec::new();
        let mut numbers = Vec::with_capacity(places.len());
        for (id, place) in self.mesh.edges().ids().zip(places) {
            let number = positions.len() as u32;
            numbers.push(place.map(|_| number));
            let Some(fraction) = *place else { continue };
            let edge = self.mesh.edges()[id];
            let face = edge.faces[0].expect("an edge has a face to its left");
            let corner = edge_corner(&self.mesh, face, id);
            // `vertices` runs the way in which the first face runs the edge.
            let mut weights = [0.0; 3];
            weights[corner] = 1.0 - fraction;
            weights[(corner + 1) % 3] = fraction;
            self.points.push(self.origins[face].place(weights));
            let [a, b] = edge.vertices.map(|v| positions[v.index()]);
            positions.push(a.lerp(&b, fraction));
            born.push(NewVertex {
                ends: edge.vertices,
                fraction,
            });
        }
        (born, numbers)
    }

    /// Vertex and weights of a face's three corners, then of the new vertices on its edges.
    fn places_in(
        &self,
        face: FaceId,
        numbers: &[Option<u32>],
        places: &[Option<f64>],
    ) -> [(u32, [f64; 3]); 6] {
        let corners = self.mesh.faces()[face];
        let edges = self.mesh.face_edges(face);
        std::array::from_fn(|at| {
            let mut weights = [0.0; 3];
            if at < 3 {
                weights[at] = 1.0;
                return (corners[at].0, weights);
            }
            let corner = at - 3;
            let edge = edges[corner];
            let (Some(vertex), Some(fraction)) = (numbers[edge.index()], places[edge.index()])
            else {
                return (u32::MAX, weights);
            };
            let is_along = self.mesh.edges()[edge].vertices[0] == corners[corner];
            let fraction = if is_along { fraction } else { 1.0 - fraction };
            weights[corner] = 1.0 - fraction;
            weights[(corner + 1) % 3] = fraction;
            (vertex, weights)
        })
    }
}

/// The mean of three texture coordinates with weights that sum to one.
pub(crate) fn blend(uvs: &[Vector2<f64>; 3], weights: [f64; 3]) -> Vector2<f64> {
    uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2]
}

/// The corner of a face at which one of its edges begins.
pub(crate) fn edge_corner(mesh: &TriMesh, face: FaceId, edge: EdgeId) -> usize {
    let corner = mesh.face_edges(face).iter().position(|&e| e == edge);
    corner.expect("a face has the edges that have the face")
}

/// The parts of a face whose edges are `cut`: corners are 0 to 2, the cut of edge `i` is `3 + i`.
/// Of the two diagonals of a quadrilateral the one with the lesser `length` is taken.
fn children(cut: [bool; 3], length: impl Fn([usize; 2]) -> f64) -> Vec<[usize; 3]> {
    let next = |i: usize| (i + 1) % 3;
    let count = cut.iter().filter(|cut| **cut).count();
    let Some(first) = cut.iter().position(|&is_cut| is_cut) else {
        return vec![[0, 1, 2]];
    };
    if count == 1 {
        let (b, apex) = (next(first), next(next(first)));
        return vec![[first, 3 + first, apex], [3 + first, b, apex]];
    }
    let Some(whole) = cut.iter().position(|&is_cut| !is_cut) else {
        return vec![[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
    };
    // The apex is opposite the whole edge from `a` to `b`; both other edges are cut.
    let (a, b) = (whole, next(whole));
    let apex = next(b);
    let (left, right) = (3 + apex, 3 + b);
    let mut parts = vec![[apex, left, right]];
    // The shorter diagonal leaves the larger least angle.
    if length([left, b]) <= length([a, right]) {
        parts.extend([[left, a, b], [left, b, right]]);
    } else {
        parts.extend([[left, a, right], [a, b, right]]);
    }
    parts
}
