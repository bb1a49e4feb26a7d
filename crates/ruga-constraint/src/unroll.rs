//! Geodesic polar coordinates around a place.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{Id, TriMesh, VertexId, tangent_frame};

use crate::centre::Centre;

/// A surface to unroll.
pub(crate) struct Unrolling<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) positions: &'a [Vector3<f64>],
    pub(crate) normals: &'a [Vector3<f64>],
}

impl Unrolling<'_> {
    /// Vertices within `radius` of `centre`, reached over the surface, with their places in its
    /// tangent plane; sorted by vertex.
    ///
    /// The discrete exponential map of Schmidt, Grimm and Wyvill, *Interactive decal compositing*,
    /// 2006: Dijkstra's order, each vertex taking the coordinates of its nearest reached neighbour
    /// plus the edge between them, rotated into the centre's tangent plane. Exact on a flat mesh;
    /// on a curved one the error grows with the square of radius over curvature radius. Nothing
    /// leaks through the air from one side of a finger to the other. `axis` gives the direction of
    /// the first coordinate and need not be tangent.
    ///
    /// Starts from all vertices around the place at once, so that a centre inside a face is one
    /// like any other; [`ruga_mesh::tangent_coordinates`] starts from a vertex.
    pub(crate) fn around(
        &self,
        centre: &Centre,
        axis: Vector3<f64>,
        radius: f64,
    ) -> Vec<(VertexId, Vector2<f64>)> {
        let plane = TangentPlane::new(centre.interpolate(self.normals), axis);
        let mut queue = BinaryHeap::new();
        if let [(own, _)] = centre.weights() {
            queue.push(Front::new(*own, Vector2::zeros()));
        } else {
            let origin = centre.interpolate(self.positions);
            for vertex in centre.neighbours(self.mesh) {
                let place = plane.lay(self.positions[vertex.index()] - origin, plane.normal);
                queue.push(Front::new(vertex, place));
            }
        }
        let mut settled: BTreeMap<VertexId, Vector2<f64>> = BTreeMap::new();
        while let Some(front) = queue.pop() {
            if front.distance > radius || settled.contains_key(&front.vertex) {
                continue;
            }
            settled.insert(front.vertex, front.place);
            let from = front.vertex.index();
            for &face in self.mesh.vertex_faces(front.vertex) {
                let corners = self.mesh.faces()[face].into_iter();
                for vertex in corners.filter(|v| !settled.contains_key(v)) {
                    let edge = self.positions[vertex.index()] - self.positions[from];
                    let place = front.place + plane.lay(edge, self.normals[from]);
                    queue.push(Front::new(vertex, place));
                }
            }
        }
        settled.into_iter().collect()
    }
}

/// The plane that everything is laid out in.
struct TangentPlane {
    normal: Vector3<f64>,
    frame: [Vector3<f64>; 2],
}

impl TangentPlane {
    /// `normal` has any length but zero.
    fn new(normal: Vector3<f64>, axis: Vector3<f64>) -> Self {
        let normal = normal.normalize();
        Self {
            normal,
            frame: tangent_frame(normal, axis),
        }
    }

    /// An edge that starts where the surface has the given normal, turned into the plane.
    fn lay(&self, edge: Vector3<f64>, normal: Vector3<f64>) -> Vector2<f64> {
        let step = turn(flatten(edge, normal), normal, self.normal);
        Vector2::new(step.dot(&self.frame[0]), step.dot(&self.frame[1]))
    }
}

/// The tangential part of an edge, stretched back to the edge's length.
fn flatten(edge: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    let tangential = edge - normal * normal.dot(&edge);
    let length = tangential.norm();
    if length > 0.0 {
        tangential * (edge.norm() / length)
    } else {
        Vector3::zeros()
    }
}

/// The least rotation that takes the unit vector `from` to `to`, applied to `vector`.
///
/// Free of angles: the arc cosine of a dot product near one has only half of the digits.
fn turn(vector: Vector3<f64>, from: Vector3<f64>, to: Vector3<f64>) -> Vector3<f64> {
    let axis = from.cross(&to);
    let one_plus_cosine = 1.0 + from.dot(&to);
    if one_plus_cosine < 1e-9 {
        // Opposite normals: every axis is as good, and this one moves nothing.
        return vector;
    }
    let across = axis.cross(&vector);
    vector + across + axis.cross(&across) / one_plus_cosine
}

struct Front {
    distance: f64,
    vertex: VertexId,
    place: Vector2<f64>,
}

impl Front {
    fn new(vertex: VertexId, place: Vector2<f64>) -> Self {
        Self {
            distance: place.norm(),
            vertex,
            place,
        }
    }
}

impl Ord for Front {
    /// Nearest first out of a max-heap; ties by vertex, so that the order is reproducible.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .distance
            .total_cmp(&self.distance)
            .then_with(|| other.vertex.cmp(&self.vertex))
            .then_with(|| other.place.x.total_cmp(&self.place.x))
            .then_with(|| other.place.y.total_cmp(&self.place.y))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Front {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Front {}
