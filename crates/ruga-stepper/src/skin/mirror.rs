//! One half of a pose that is its own mirror image at the plane `x = 0`.

use nalgebra::Vector3;
use ruga_blend::{Driver, Smoothing, SurfacePoints, Weights};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerVertex, TriMesh, VertexId};

use crate::skin::piece::Piece;
use crate::skin::skin_mesh::SkinMesh;

/// How far from the plane a vertex on it may be, in lengths of the mesh's longest side: 30 µm on a head.
const ON_PLANE: f64 = 1e-4;

/// How far from the plane the smooth surface may be there: 0.6 mm on a head.
const NEAR_PLANE: f64 = 2e-3;

/// Least distance, in edges, between a vertex and the place where an edge at it crosses the plane: nearer ones would
/// make slivers.
const LEAST_PART: f64 = 0.02;

/// The plane `x = 0`, at which one half of a symmetric pose ends.
///
/// Whether the two sides of a mesh or a pose are alike is not asked here.
#[derive(Debug)]
pub struct SymmetryPlane {
    plane: Plane,
    /// Places of the driver's smooth surface on the plane at rest; `None` where a mesh is not cut cleanly.
    places: Option<SurfacePoints>,
}

impl SymmetryPlane {
    /// Looks for what lies on the plane: vertices, and places of the edges that cross it.
    pub fn new(driver: &Driver) -> Self {
        let plane = Plane::of(driver);
        let places = plane.places(driver);
        let places = places.map(|places| SurfacePoints::new(driver, places, Smoothing::Loop));
        Self { plane, places }
    }

    /// Whether a pose with these weights of the same driver can be simulated on one side of the plane alone: no face
    /// lies in it, edges cross it well away from their ends, and the smooth surface stays near it at rest and in the
    /// pose, also where edges lean to one side.
    pub fn keeps(&self, driver: &Driver, weights: &Weights) -> bool {
        let Some(places) = &self.places else {
            return false;
        };
        let is_near = |x: &Vector3<f64>| x.x.abs() <= self.plane.reach * (NEAR_PLANE / ON_PLANE);
        let stays = |control: &[Vector3<f64>]| places.pose(control).positions.iter().all(is_near);
        stays(driver.rest()) && stays(&driver.pose(weights))
    }
}

/// How a driver lies to the plane `x = 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// Distance up to which a place counts as on the plane, m.
    reach: f64,
}

impl Plane {
    pub(crate) fn of(driver: &Driver) -> Self {
        let mut bounds = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
        for point in driver.rest() {
            bounds = [bounds[0].inf(point), bounds[1].sup(point)];
        }
        Self {
            reach: ON_PLANE * (bounds[1] - bounds[0]).max(),
        }
    }

    /// Whether a place (m) lies on the side that is simulated.
    pub(crate) fn is_right(&self, place: &Vector3<f64>) -> bool {
        place.x > self.reach
    }

    /// The driver's vertices on the plane and the places of edges that cross it; `None` where a face lies in the plane
    /// or an edge crosses it too close to a vertex.
    fn places(&self, driver: &Driver) -> Option<Vec<MaterialPoint>> {
        let (topology, rest) = (driver.topology(), driver.rest());
        let is_on = |v: &VertexId| rest[v.index()].x.abs() <= self.reach;
        let mut faces = topology.faces().as_slice().iter();
        if faces.any(|face| face.iter().all(is_on)) {
            return None;
        }
        let mut places = Vec::new();
        for (face, corners) in topology.faces().iter() {
            for corner in 0..3 {
                let ends = [corner, (corner + 1) % 3];
                let mut weights = [0.0; 3];
                match self.crossing(ends.map(|c| rest[corners[c].index()].x)) {
                    None if is_on(&corners[corner]) => weights[corner] = 1.0,
                    None => continue,
                    Some(t) if !(LEAST_PART..=1.0 - LEAST_PART).contains(&t) => return None,
                    Some(t) => (weights[ends[0]], weights[ends[1]]) = (1.0 - t, t),
                }
                places.push(MaterialPoint {
                    face,
                    barycentric: weights,
                });
            }
        }
        Some(places)
    }

    /// Fraction of the way at which an edge between these x (m) crosses the plane.
    fn crossing(&self, [a, b]: [f64; 2]) -> Option<f64> {
        let crosses = a.abs().min(b.abs()) > self.reach && (a > 0.0) != (b > 0.0);
        crosses.then(|| a / (a - b))
    }

    /// The part of a piece on the side that is simulated, and for each of its faces the face of the piece that it is a
    /// part of.
    pub(crate) fn right_of(&self, driver: &Driver, mut piece: Piece) -> (Piece, Vec<FaceId>) {
        let mut positions = piece.flat_positions(driver);
        let edges = piece.mesh.edges().as_slice().iter();
        let crossings =
            edges.map(|edge| self.crossing(edge.vertices.map(|v| positions[v.index()].x)));
        let places: Vec<Option<f64>> = crossings.collect();
        let parents = piece.split(&places, &mut positions).parents;
        let is_right =
            |corners: &[VertexId; 3]| corners.iter().any(|v| positions[v.index()].x > self.reach);
        let faces = piece.mesh.faces().iter();
        let right: Vec<FaceId> = faces
            .filter(|(_, corners)| is_right(corners))
            .map(|(face, _)| face)
            .collect();
        let parents = right.iter().map(|face| parents[face.index()]).collect();
        (piece.part(&right), parents)
    }

    /// Whether every vertex of a mesh of one half, at these places of the driver, lies on the plane where that half
    /// ends; empty when none does.
    pub(super) fn holds(
        &self,
        driver: &Driver,
        mesh: &TriMesh,
        places: &[MaterialPoint],
    ) -> Vec<bool> {
        let border = mesh.border_vertices();
        let is_on = |(place, on_border): (&MaterialPoint, &bool)| {
            *on_border && place.interpolate(driver.topology(), driver.rest()).x.abs() <= self.reach
        };
        let mut on: Vec<bool> = places.iter().zip(border.as_slice()).map(is_on).collect();
        for edge in mesh
            .edges()
            .as_slice()
            .iter()
            .filter(|edge| !edge.is_border())
        {
            let [a, b] = edge.vertices.map(Id::index);
            // An edge that cuts the plane's curve short would be glued to its own image.
            on[b] &= !on[a];
        }
        match on.contains(&true) {
            true => on,
            false => Vec::new(),
        }
    }
}

/// A mesh of one half with its mirror image, at rest.
pub(crate) struct Mirrored {
    pub(crate) mesh: TriMesh,
    /// Positions of the vertices, m.
    pub(crate) positions: Vec<Vector3<f64>>,
    /// Unit normals of the surface at the vertices.
    pub(crate) normals: Vec<Vector3<f64>>,
    /// What is whose image.
    pub(crate) images: Images,
}

/// The vertices and faces of a mesh of one half and of its mirror image.
#[derive(Clone, Debug)]
pub(crate) struct Images {
    /// For every vertex the one of the half that it is or is the image of.
    originals: Vec<VertexId>,
    /// For every face of the mirror image its original.
    original_faces: Vec<FaceId>,
    /// Number of the half's own vertices, which come first.
    own: usize,
    /// Number of its own faces, likewise.
    own_faces: usize,
}

impl SkinMesh {
    /// The mesh with its mirror image, where it is one half of a symmetric pose that reaches the plane.
    pub(crate) fn mirrored(&self) -> Option<Mirrored> {
        self.mirrored_within(f64::INFINITY)
    }

    /// The mesh with the mirror image of its faces that come within a distance (m) of the plane.
    pub(crate) fn mirrored_within(&self, distance: f64) -> Option<Mirrored> {
        if self.on_plane.is_empty() {
            return None;
        }
        let (own, rest) = (self.mesh.vertex_count(), &self.rest);
        let faces = self.mesh.faces();
        let is_near = |v: &VertexId| rest.positions[v.index()].x < distance;
        let near: Vec<FaceId> = faces
            .ids()
            .filter(|face| faces[*face].iter().any(is_near))
            .collect();
        let mut originals: Vec<VertexId> = (0..own).map(VertexId::from_index).collect();
        // Vertices on the plane are their own images.
        let mut images = originals.clone();
        for &v in near.iter().flat_map(|face| &faces[*face]) {
            if !self.on_plane[v.index()] && images[v.index()] == v {
                images[v.index()] = VertexId::from_index(originals.len());
                originals.push(v);
            }
        }
        // A reflection turns faces inside out.
        let mirror = |face: &FaceId| {
            let [a, b, c] = faces[*face];
            [a, c, b].map(|v| images[v.index()].0)
        };
        let all = faces.as_slice().iter().map(|face| face.map(|v| v.0));
        let all = all.chain(near.iter().map(mirror)).collect();
        let images = Images {
            originals,
            original_faces: near,
            own,
            own_faces: faces.len(),
        };
        let mesh = TriMesh::new(images.originals.len(), all).ok()?;
        let mut mirrored = Mirrored {
            mesh,
            positions: images.vectors(&rest.positions),
            normals: images.vectors(&rest.normals),
            images,
        };
        // The two halves meet there, however exactly the artist's mesh does.
        for v in (0..own).filter(|v| self.on_plane[*v]) {
            mirrored.positions[v].x = 0.0;
            mirrored.normals[v].x = 0.0;
            let normal = mirrored.normals[v].try_normalize(0.0);
            mirrored.normals[v] = normal.unwrap_or(rest.normals[v]);
        }
        Some(mirrored)
    }

    /// Whether what carries the layer holds each vertex: those on the border, but for the plane where one half ends.
    pub(crate) fn held(&self) -> PerVertex<bool> {
        let mut held = self.mesh.border_vertices();
        for (v, _) in (0..).zip(&self.on_plane).filter(|(_, on)| **on) {
            held[VertexId(v)] = false;
        }
        if !self.on_plane.is_empty() {
            let edges = self.mesh.edges().as_slice().iter();
            let is_on = |v: &VertexId| self.on_plane[v.index()];
            let outer = edges.filter(|e| e.is_border() && !e.vertices.iter().all(is_on));
            outer.for_each(|edge| edge.vertices.iter().for_each(|v| held[*v] = true));
        }
        held
    }
}

impl Images {
    /// For every vertex the one of the half that it is or is the image of.
    pub(crate) fn originals(&self) -> &[VertexId] {
        &self.originals
    }

    /// Number of the half's own vertices, which come first.
    pub(crate) fn own_count(&self) -> usize {
        self.own
    }

    /// Vectors at all vertices from those of the half.
    pub(crate) fn vectors(&self, own: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let all = self.originals.iter().enumerate();
        all.map(|(i, v)| match i < self.own {
            true => own[v.index()],
            false => reflected(&own[v.index()]),
        })
        .collect()
    }

    /// Values without a direction at all vertices from those of the half.
    pub(crate) fn values<T: Copy>(&self, own: &[T]) -> Vec<T> {
        self.originals.iter().map(|v| own[v.index()]).collect()
    }

    /// The place on the half that a place is, or is the image of.
    pub(crate) fn original_place(&self, place: &MaterialPoint) -> MaterialPoint {
        match place.face.index().checked_sub(self.own_faces) {
            None => *place,
            Some(rank) => {
                let [a, b, c] = place.barycentric;
                MaterialPoint {
                    face: self.original_faces[rank],
                    barycentric: [a, c, b],
                }
            }
        }
    }
}

/// The mirror image of a vector.
fn reflected(vector: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-vector.x, vector.y, vector.z)
}
