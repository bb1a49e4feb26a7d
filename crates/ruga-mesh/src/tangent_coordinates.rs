//! Geodesic polar coordinates around a place.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

use nalgebra::{Vector2, Vector3};

use crate::{Id, TriMesh, VertexId};

/// A vertex with its coordinates in the tangent plane of a centre (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentCoordinates {
    /// The vertex.
    pub vertex: VertexId,
    /// Its place in the tangent plane; the norm approximates the geodesic distance.
    pub place: Vector2<f64>,
}

/// A place of a surface around which to unroll it.
#[derive(Clone, Debug, PartialEq)]
pub struct TangentCentre {
    /// The place (m).
    pub origin: Vector3<f64>,
    /// Unit normal there.
    pub normal: Vector3<f64>,
    /// Direction of the first coordinate; need not be tangent.
    pub axis: Vector3<f64>,
    /// Where to start: the vertex that the place is, or the vertices around it.
    pub around: Vec<VertexId>,
}

/// Vertices within `radius` of `centre`, reached over the surface, with tangent coordinates.
///
/// The discrete exponential map of Schmidt, Grimm and Wyvill, *Interactive decal compositing*,
/// 2006: Dijkstra's order, each vertex taking the coordinates of its nearest reached neighbour
/// plus the edge between them, rotated into the centre's tangent plane. Exact on a flat mesh;
/// on a curved one the error grows with the square of radius over curvature radius. Nothing
/// leaks through the air from one side of a finger to the other. Starts from all vertices around
/// the place at once, so that a centre inside a face is one like any other.
///
/// `positions` (m) and unit `normals` per vertex. Sorted by vertex; one whose coordinates do not come
/// out finite is left out.
///
/// # Panics
/// When there is not one position and one normal per vertex, or `centre` starts from a vertex that
/// the mesh does not have.
pub fn tangent_coordinates(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    normals: &[Vector3<f64>],
    centre: &TangentCentre,
    radius: f64,
) -> Vec<TangentCoordinates> {
    let count = mesh.vertex_count();
    assert_eq!(
        [positions.len(), normals.len()],
        [count; 2],
        "one per vertex"
    );
    let plane = TangentPlane {
        normal: centre.normal,
        frame: tangent_frame(centre.normal, centre.axis),
    };
    let start = |&vertex: &VertexId| {
        let way = positions[vertex.index()] - centre.origin;
        Front::new(vertex, plane.lay(way, plane.normal))
    };
    let mut queue: BinaryHeap<Front> = centre.around.iter().map(start).collect();
    let mut near: Vec<VertexId> = Vec::new();
    // An ordered map, so that the result comes out sorted and is the same in every run.
    let mut settled: BTreeMap<VertexId, Vector2<f64>> = BTreeMap::new();
    while let Some(front) = queue.pop() {
        // Not `>`: a distance or a radius that is not a number reaches nothing.
        let is_within = front.distance <= radius;
        if !is_within || settled.contains_key(&front.vertex) {
            continue;
        }
        settled.insert(front.vertex, front.place);
        let from = front.vertex.index();
        near.clear();
        for &face in mesh.vertex_faces(front.vertex) {
            for vertex in mesh.faces()[face] {
                // Most neighbours are corners of two of the faces.
                if vertex != front.vertex && !near.contains(&vertex) {
                    near.push(vertex);
                }
            }
        }
        for &vertex in near.iter().filter(|&v| !settled.contains_key(v)) {
            let edge = positions[vertex.index()] - positions[from];
            let next = Front::new(vertex, front.place + plane.lay(edge, normals[from]));
            if next.distance <= radius {
                queue.push(next);
            }
        }
    }
    settled
        .into_iter()
        .map(|(vertex, place)| TangentCoordinates { vertex, place })
        .collect()
}

/// The plane that everything is laid out in.
struct TangentPlane {
    normal: Vector3<f64>,
    frame: [Vector3<f64>; 2],
}

impl TangentPlane {
    /// An edge that starts where the surface has the given normal, turned into the plane.
    fn lay(&self, edge: Vector3<f64>, normal: Vector3<f64>) -> Vector2<f64> {
        let step = turn(flatten(edge, normal), normal, self.normal);
        Vector2::new(step.dot(&self.frame[0]), step.dot(&self.frame[1]))
    }
}

/// Two unit tangents that with the unit `normal` make a right-handed frame; the first lies along
/// `axis`, or anywhere where that has no part in the plane.
pub fn tangent_frame(normal: Vector3<f64>, axis: Vector3<f64>) -> [Vector3<f64>; 2] {
    let along = axis - normal * normal.dot(&axis);
    // Of a shorter projection rounding would choose the direction.
    let first = along.try_normalize(1e-9 * axis.norm()).unwrap_or_else(|| {
        // The coordinate axis farthest from the normal has the longest part in the plane.
        let least = normal.iamin();
        let mut unit = Vector3::zeros();
        unit[least] = 1.0;
        (unit - normal * normal[least]).normalize()
    });
    [first, normal.cross(&first)]
}

/// The tangential part of an edge, stretched back to the edge's length.
fn flatten(edge: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    let tangential = edge - normal * normal.dot(&edge);
    let length = tangential.norm();
    // Not `> 0`: what is not a number must stay one, and be left out.
    if length == 0.0 {
        Vector3::zeros()
    } else {
        // Lengths along the way add up to the distance; a projection would shorten every one.
        tangential * (edge.norm() / length)
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
    // Rodrigues' formula: `(1 - cos) / sin^2 = 1 / (1 + cos)`, which is tame for equal normals.
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
