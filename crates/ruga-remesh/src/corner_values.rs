//! Values at corners of faces, such as texture coordinates, through a remesh.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{EdgeId, FaceId, Id, MaterialPoint, PerFace, VertexId};

use crate::closest::{closest_on_edge, closest_on_face};
use crate::{SurfaceMesh, Transfer};

impl Transfer {
    /// Values at the corners of the new faces, such as texture coordinates, from `values` at those of
    /// the old ones.
    ///
    /// Along [`features`](SurfaceMesh::features) the values may jump, as texture coordinates do at
    /// seams: a new face takes those of its own side. Everywhere else they are continuous, and
    /// interpolated linearly.
    ///
    /// # Panics
    /// When the meshes are not those of the remesh, or there are not as many values as old faces.
    pub fn corner_values(
        &self,
        old: &SurfaceMesh,
        new: &SurfaceMesh,
        values: &PerFace<[Vector2<f64>; 3]>,
    ) -> PerFace<[Vector2<f64>; 3]> {
        let places: Vec<MaterialPoint> = (new.positions.ids())
            .map(|vertex| self.place_on_old(vertex, old, new))
            .collect();
        let faces = new.mesh.faces().as_slice().iter();
        faces
            .map(|corners| {
                // Corners may lie on a seam; the middle says on which side the face is.
                let middle = corners
                    .map(|v| new.positions[v])
                    .iter()
                    .sum::<Vector3<f64>>()
                    / 3.0;
                corners.map(|v| value_beside(old, places[v.index()], middle, values))
            })
            .collect()
    }

    /// Place of a new vertex on the old mesh; one on a seam lies on the old seam, not beside it.
    fn place_on_old(
        &self,
        vertex: VertexId,
        old: &SurfaceMesh,
        new: &SurfaceMesh,
    ) -> MaterialPoint {
        let origin = self.origins[vertex];
        let mut edges =
            (new.mesh.vertex_faces(vertex).iter()).flat_map(|&face| new.mesh.face_edges(face));
        let is_on_seam = edges
            .any(|edge| is_seam(new, edge) && new.mesh.edges()[edge].vertices.contains(&vertex));
        if self.survivors[vertex].is_some() || !is_on_seam {
            return origin;
        }
        // A vertex born on a seam was moved onto the surface's curve, off the chord between the old
        // vertices. The closest place on the old faces may then lie beside the seam, where it would
        // take the values of one side for both.
        let corners = old.mesh.faces()[origin.face];
        let near = corners.iter().flat_map(|&v| old.mesh.vertex_faces(v));
        let seams = near.flat_map(|&face| {
            let edges = old.mesh.face_edges(face).into_iter().enumerate();
            edges.filter_map(move |(corner, edge)| is_seam(old, edge).then_some((face, corner)))
        });
        let target = new.positions[vertex];
        seams
            .map(|(face, corner)| {
                closest_on_edge(&old.mesh, old.positions.as_slice(), face, corner, target)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(origin, |(_, place)| place)
    }
}

/// Says whether an edge is a feature with a face on both sides.
fn is_seam(mesh: &SurfaceMesh, edge: EdgeId) -> bool {
    mesh.features[edge] && !mesh.mesh.edges()[edge].is_border()
}

/// The value at a place, as the face there has it that lies closest to `middle`.
fn value_beside(
    old: &SurfaceMesh,
    place: MaterialPoint,
    middle: Vector3<f64>,
    values: &PerFace<[Vector2<f64>; 3]>,
) -> Vector2<f64> {
    let corners = old.mesh.faces()[place.face];
    let weights = corners.into_iter().zip(place.barycentric);
    // A place at a vertex or on an edge is in several faces, and across a seam these disagree.
    let weights: Vec<(VertexId, f64)> = weights.filter(|(_, weight)| *weight > 0.0).collect();
    let shares = |face: &FaceId| {
        let corners = old.mesh.faces()[*face];
        weights.iter().all(|(vertex, _)| corners.contains(vertex))
    };
    let distance =
        |face: FaceId| closest_on_face(&old.mesh, old.positions.as_slice(), face, middle).0;
    // Every face at the place has the first of its vertices, so those around that are enough.
    let around = old.mesh.vertex_faces(weights[0].0).iter().copied();
    let face = around
        .filter(shares)
        .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
        .expect("the face of the place is one of those around its corner");
    let corners = old.mesh.faces()[face].into_iter().zip(values[face]);
    let value = |vertex: VertexId| {
        let mut corners = corners.clone();
        let found = corners.find(|corner| corner.0 == vertex);
        found.expect("the face has the vertices of the place").1
    };
    weights
        .iter()
        .map(|&(vertex, weight)| value(vertex) * weight)
        .sum()
}
