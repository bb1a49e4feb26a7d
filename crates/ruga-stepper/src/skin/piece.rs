//! A part of the driver's surface, whose faces can be split at their edges.

use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;
use ruga_blend::{BaseSurface, Driver};
use ruga_mesh::{
    BornVertex, EdgeId, FaceId, FaceOrigin, Id, MaterialPoint, PerFace, TriMesh, split_faces,
};

use crate::skin::fans::one_fan_per_vertex;

/// Parts of faces that a thread places at least.
const PARTS_AT_ONCE: usize = 1024;

/// Part of a surface: places on the driver.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) mesh: TriMesh,
    /// The driver's place under every vertex.
    pub(crate) points: Vec<MaterialPoint>,
    /// Place of every face in a face of the driver.
    pub(crate) origins: PerFace<FaceOrigin>,
}

/// What a split has made.
pub(crate) struct Split {
    /// The new vertices, which follow the old ones.
    pub(crate) born: Vec<BornVertex>,
    /// The old face that every face is a part of, ascending.
    pub(crate) parents: Vec<FaceId>,
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
        }
    }

    /// The part of the piece with these faces, ascending, and one fan of faces around every vertex.
    pub(crate) fn part(&self, faces: &[FaceId]) -> Self {
        let part = self.mesh.submesh(faces);
        let (mesh, copied) = one_fan_per_vertex(&part.mesh);
        let vertices = copied.iter().map(|v| part.vertices[*v]);
        Self {
            mesh,
            points: vertices.map(|v| self.points[v.index()]).collect(),
            origins: faces.iter().map(|face| self.origins[*face]).collect(),
        }
    }

    /// Positions of the vertices on the driver's flat facets at rest, m.
    pub(crate) fn flat_positions(&self, driver: &Driver) -> Vec<Vector3<f64>> {
        let place = |point: &MaterialPoint| point.interpolate(driver.topology(), driver.rest());
        self.points.iter().map(place).collect()
    }

    /// Splits edges as [`ruga_mesh::split_edges`] does; `positions` (m) gets those of the new vertices.
    pub(crate) fn split(
        &mut self,
        places: &[Option<f64>],
        positions: &mut Vec<Vector3<f64>>,
    ) -> Split {
        let placed = |part: &FaceOrigin| {
            let origin = &self.origins[part.face];
            FaceOrigin {
                face: origin.face,
                corners: part.corners.map(|weights| origin.lift(weights)),
            }
        };
        let split = split_faces(&self.mesh, places, positions, placed);
        let point = |vertex: &BornVertex| {
            let edge = self.mesh.edges()[vertex.edge];
            let face = edge.faces[0].expect("an edge has a face to its left");
            let corner = edge_corner(&self.mesh, face, vertex.edge);
            // `vertices` runs the way in which the first face runs the edge.
            let mut weights = [0.0; 3];
            weights[corner] = 1.0 - vertex.fraction;
            weights[(corner + 1) % 3] = vertex.fraction;
            self.origins[face].place(weights)
        };
        let points = split.born.par_iter().with_min_len(PARTS_AT_ONCE).map(point);
        self.points.par_extend(points);
        self.origins = split.origins.into();
        // The old mesh goes before the new one is made: an output mesh has millions of faces.
        self.mesh = TriMesh::new(0, Vec::new()).expect("a mesh without faces");
        let mesh = TriMesh::new(positions.len(), split.faces);
        self.mesh = mesh.expect("neighbours are cut at the same vertices");
        Split {
            born: split.born,
            parents: split.parents,
        }
    }
}

/// Texture coordinates of a face's corners, which has this `origin`.
pub(crate) fn uvs_of(driver: &Driver, origin: &FaceOrigin) -> [Vector2<f64>; 3] {
    let uvs = &driver.uvs()[origin.face];
    origin.corners.map(|weights| blend(uvs, weights))
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
