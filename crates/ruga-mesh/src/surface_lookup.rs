//! Lookup of the material point of a surface that is closest to a point in space.

use std::sync::OnceLock;

use nalgebra::Vector3;

use crate::{FaceId, Id, MaterialPoint, TriMesh};

/// The closest place that a search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPlace {
    /// The place.
    pub point: MaterialPoint,
    /// Its distance from the target (m).
    pub distance: f64,
}

impl ClosestPlace {
    /// Whether this place comes before another: the nearer one, the lower face among equals.
    fn precedes(&self, other: &Option<Self>) -> bool {
        let key = |place: &Self| (place.distance, place.point.face);
        other.as_ref().is_none_or(|other| key(self) < key(other))
    }
}

/// Finds the closest place on the facets of a mesh with given positions.
///
/// Both searches are exact and reproducible. Triangles without area count as the segments or
/// points that they are; those with coordinates that are not finite are passed over.
#[derive(Clone, Debug)]
pub struct SurfaceLookup<'a> {
    mesh: &'a TriMesh,
    positions: &'a [Vector3<f64>],
    /// Built for the first search over the whole surface; local searches need none.
    tree: OnceLock<Vec<Node>>,
}

impl<'a> SurfaceLookup<'a> {
    /// A lookup on a mesh whose vertices are at `positions` (m).
    ///
    /// # Panics
    /// When there is not one position per vertex.
    pub fn new(mesh: &'a TriMesh, positions: &'a [Vector3<f64>]) -> Self {
        assert_eq!(
            positions.len(),
            mesh.vertex_count(),
            "one position per vertex"
        );
        Self {
            mesh,
            positions,
            tree: OnceLock::new(),
        }
    }

    /// The place closest to `target` among those that hang together with `start` within `reach`.
    ///
    /// The search spreads from the start's face across edges, over faces that come within `reach`
    /// (m) of the target. Another part of the surface that is close in space but not connected
    /// within this ball, as the other one of two touching lips, is never found. The start's face
    /// counts even when it is further away. `None` when nothing has finite coordinates, as when the
    /// target has none.
    ///
    /// # Panics
    /// When the mesh has no face `start`.
    pub fn closest_near(
        &self,
        start: FaceId,
        target: &Vector3<f64>,
        reach: f64,
    ) -> Option<ClosestPlace> {
        let mut best = None;
        // Ascending; most searches see a dozen.
        let mut seen = vec![start];
        // The order of the search is free: `precedes` decides between equal distances by face.
        let mut front = vec![start];
        while let Some(face) = front.pop() {
            let place = self.closest_on(face, target);
            if face != start && !place.is_some_and(|p| p.distance <= reach) {
                continue;
            }
            if let Some(place) = place.filter(|p| p.precedes(&best)) {
                best = Some(place);
            }
            let beyond = (0..3).filter_map(|corner| self.mesh.neighbour(face, corner));
            for next in beyond {
                if let Err(at) = seen.binary_search(&next) {
                    seen.insert(at, next);
                    front.push(next);
                }
            }
        }
        best
    }

    /// The place of the whole surface that is closest to `target`; `None` when there is none, as for a
    /// target that is not finite.
    pub fn closest(&self, target: &Vector3<f64>) -> Option<ClosestPlace> {
        let tree = self.tree.get_or_init(|| self.build_tree());
        let mut best: Option<ClosestPlace> = None;
        let mut stack = Vec::new();
        if let Some(root) = tree.first() {
            stack.push((root.distance(target), 0));
        }
        while let Some((distance, index)) = stack.pop() {
            // Distances equal up to rounding are followed up, for the face with the lower id.
            if best.is_some_and(|b| distance * (1.0 - 1e-14) > b.distance) {
                continue;
            }
            match &tree[index].content {
                Content::Faces(faces) => {
                    for place in faces.iter().filter_map(|&f| self.closest_on(f, target)) {
                        if place.precedes(&best) {
                            best = Some(place);
                        }
                    }
                }
                &Content::Halves(halves) => {
                    let mut halves = halves.map(|i| (tree[i].distance(target), i));
                    // The nearer half is popped first.
                    halves.sort_by(|a, b| b.0.total_cmp(&a.0));
                    stack.extend(halves);
                }
            }
        }
        best
    }

    /// The place that is closest to `target`, by a look at every face, for a few targets: the tree of
    /// [`Self::closest`] is worth building for many. Where distances are equal up to rounding the two may differ.
    pub fn closest_of_all(&self, target: &Vector3<f64>) -> Option<ClosestPlace> {
        let mut best = None;
        let faces = self.mesh.faces().ids();
        for place in faces.filter_map(|face| self.closest_on(face, target)) {
            if place.precedes(&best) {
                best = Some(place);
            }
        }
        best
    }

    fn corners(&self, face: FaceId) -> [Vector3<f64>; 3] {
        self.mesh.faces()[face].map(|v| self.positions[v.index()])
    }

    fn closest_on(&self, face: FaceId, target: &Vector3<f64>) -> Option<ClosestPlace> {
        let (barycentric, squared) = closest_on_triangle(&self.corners(face), target);
        let distance = squared.sqrt();
        distance.is_finite().then_some(ClosestPlace {
            point: MaterialPoint { face, barycentric },
            distance,
        })
    }

    fn build_tree(&self) -> Vec<Node> {
        let is_finite = |&face: &FaceId| self.corners(face).iter().flatten().all(|c| c.is_finite());
        let mut faces: Vec<FaceId> = self.mesh.faces().ids().filter(is_finite).collect();
        let mut tree = Vec::new();
        if !faces.is_empty() {
            self.add_node(&mut faces, &mut tree);
        }
        tree
    }

    /// Adds the tree over `faces` and returns its root: halves by the middle along the longest side.
    fn add_node(&self, faces: &mut [FaceId], tree: &mut Vec<Node>) -> usize {
        let all = || faces.iter().flat_map(|&f| self.corners(f));
        let low = all().fold(Vector3::repeat(f64::INFINITY), |a, b| a.inf(&b));
        let high = all().fold(Vector3::repeat(f64::NEG_INFINITY), |a, b| a.sup(&b));
        let index = tree.len();
        if faces.len() <= LEAF_SIZE {
            let content = Content::Faces(faces.to_vec());
            tree.push(Node { low, high, content });
        } else {
            // Known once the halves are added.
            let content = Content::Halves([0; 2]);
            tree.push(Node { low, high, content });
            // Halves of equal number, not of equal space: the tree stays shallow where faces crowd.
            let axis = (high - low).imax();
            let middle = |f: FaceId| self.corners(f).iter().map(|c| c[axis] / 3.0).sum::<f64>();
            faces.sort_by(|&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
            let (left, right) = faces.split_at_mut(faces.len() / 2);
            let halves = [self.add_node(left, tree), self.add_node(right, tree)];
            tree[index].content = Content::Halves(halves);
        }
        index
    }
}

/// Faces in one leaf of the tree.
const LEAF_SIZE: usize = 4;

/// A box around some faces.
#[derive(Clone, Debug)]
struct Node {
    low: Vector3<f64>,
    high: Vector3<f64>,
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    Faces(Vec<FaceId>),
    Halves([usize; 2]),
}

impl Node {
    fn distance(&self, target: &Vector3<f64>) -> f64 {
        (target - target.sup(&self.low).inf(&self.high)).norm()
    }
}

/// Barycentric coordinates of the point of a triangle that is closest to `target`, and its squared
/// distance (m²).
///
/// The foot of the perpendicular competes with the closest points of the edges by its actual
/// distance, so that rounding in a sliver's plane does no harm.
pub fn closest_on_triangle(corners: &[Vector3<f64>; 3], target: &Vector3<f64>) -> ([f64; 3], f64) {
    // A corner has a distance even where the triangle has no area and its edges no length.
    let mut best = measured(corners, [1.0, 0.0, 0.0], target);
    let foot = foot(corners, target).map(|weights| measured(corners, weights, target));
    let edges = (0..3).map(|corner| closest_on_edge(corners, corner, target));
    for place in foot.into_iter().chain(edges) {
        if place.1 < best.1 {
            best = place;
        }
    }
    best
}

/// The closest point of the edge from `corner` to the next.
fn closest_on_edge(
    corners: &[Vector3<f64>; 3],
    corner: usize,
    target: &Vector3<f64>,
) -> ([f64; 3], f64) {
    let next = (corner + 1) % 3;
    let edge = corners[next] - corners[corner];
    let along = (target - corners[corner]).dot(&edge) / edge.norm_squared();
    // An edge without length gives NaN, or infinity from rounding.
    let t = if along.is_finite() {
        along.clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut weights = [0.0; 3];
    weights[corner] = 1.0 - t;
    weights[next] = t;
    measured(corners, weights, target)
}

/// The foot of the perpendicular on the triangle's plane, where it lies inside.
fn foot(corners: &[Vector3<f64>; 3], target: &Vector3<f64>) -> Option<[f64; 3]> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    let area = normal.norm_squared();
    let v = (target - a).cross(&(c - a)).dot(&normal) / area;
    let w = (b - a).cross(&(target - a)).dot(&normal) / area;
    let weights = [1.0 - v - w, v, w];
    // Comparisons with NaN are false.
    weights.iter().all(|&b| b >= 0.0).then_some(weights)
}

fn measured(
    [a, b, c]: &[Vector3<f64>; 3],
    weights: [f64; 3],
    target: &Vector3<f64>,
) -> ([f64; 3], f64) {
    let place = a * weights[0] + b * weights[1] + c * weights[2];
    (weights, (place - target).norm_squared())
}
