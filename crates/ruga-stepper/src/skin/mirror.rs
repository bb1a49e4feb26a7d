//! One half of a pose that is its own mirror image at the plane `x = 0`.

use nalgebra::Vector3;
use ruga_blend::{Driver, Weights};
use ruga_mesh::{Edge, FaceId, Id, MaterialPoint, PerVertex, TriMesh, VertexId};

use crate::skin::piece::Piece;
use crate::skin::skin_mesh::SkinMesh;

/// How far from the plane a vertex on it may be, in sizes of the mesh: 30 µm on a head.
const ON_PLANE: f64 = 1e-4;

/// Whether a pose with these weights can be simulated on one side of the plane `x = 0` alone: no face of the mesh lies in
/// that plane, and what lies on it at rest, vertices or places of edges, does so in the pose.
///
/// Whether the two sides are alike is not asked.
pub fn can_be_halved(driver: &Driver, weights: &Weights) -> bool {
    let plane = Plane::of(driver);
    let (topology, rest) = (driver.topology(), driver.rest());
    let posed = driver.pose(weights);
    let is_on = |x: f64| x.abs() <= plane.reach;
    let stays = |edge: &Edge| {
        let [a, b] = edge.vertices.map(Id::index);
        let crossing = plane.crossing([rest[a].x, rest[b].x]);
        let is_kept = |v: usize| !is_on(rest[v].x) || is_on(posed[v].x);
        let stays = |t: f64| is_on(posed[a].x + t * (posed[b].x - posed[a].x));
        is_kept(a) && is_kept(b) && crossing.is_none_or(stays)
    };
    let mut faces = topology.faces().as_slice().iter();
    faces.all(|face| !face.iter().all(|v| is_on(rest[v.index()].x)))
        && topology.edges().as_slice().iter().all(stays)
}

/// The plane `x = 0`, at which one half of a driver ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// Distance up to which a place counts as on it, m.
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

    /// Whether a face of the driver has a part on the side that is simulated.
    pub(crate) fn has_right_part(&self, driver: &Driver, face: FaceId) -> bool {
        let corners = driver.topology().faces()[face];
        corners
            .iter()
            .any(|v| driver.rest()[v.index()].x > self.reach)
    }

    /// Fraction of the way at which an edge between these x (m) crosses the plane.
    fn crossing(&self, [a, b]: [f64; 2]) -> Option<f64> {
        let crosses = a.abs().min(b.abs()) > self.reach && (a > 0.0) != (b > 0.0);
        crosses.then(|| a / (a - b))
    }

    /// The part of a piece on the side that is simulated, and the face of the piece that each of its faces is a part of.
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

    /// Whether every vertex of a mesh of one half, at these places of the driver, lies on the plane where that half ends;
    /// empty when none does.
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

/// A mesh of one half with its mirror image, one at rest as the other.
#[derive(Clone, Debug)]
pub(crate) struct Mirrored {
    pub(crate) mesh: TriMesh,
    /// Positions of the vertices, m.
    pub(crate) positions: Vec<Vector3<f64>>,
    /// Unit normals of the surface at the vertices.
    pub(crate) normals: Vec<Vector3<f64>>,
    /// For every vertex the one of the half that it is or is the image of.
    pub(crate) originals: Vec<VertexId>,
    /// Number of the half's own vertices, which come first.
    own: usize,
    /// Number of its own faces, likewise.
    own_faces: usize,
}

impl SkinMesh {
    /// The mesh with its mirror image, where it is one half of a symmetric pose that reaches the plane.
    pub(crate) fn mirrored(&self) -> Option<Mirrored> {
        if self.on_plane.is_empty() {
            return None;
        }
        let own = self.mesh.vertex_count();
        let mut originals: Vec<VertexId> = (0..own).map(VertexId::from_index).collect();
        let mut images = originals.clone();
        for v in (0..own).filter(|&v| !self.on_plane[v]) {
            images[v] = VertexId::from_index(originals.len());
            originals.push(VertexId::from_index(v));
        }
        let faces = self.mesh.faces().as_slice();
        // A reflection turns faces inside out.
        let mirror = |&[a, b, c]: &[VertexId; 3]| [a, c, b].map(|v| images[v.index()].0);
        let all = faces.iter().map(|face| face.map(|v| v.0));
        let all = all.chain(faces.iter().map(mirror)).collect();
        let mesh = TriMesh::new(originals.len(), all).ok()?;
        let mut mirrored = Mirrored {
            mesh,
            positions: Vec::new(),
            normals: Vec::new(),
            originals,
            own,
            own_faces: faces.len(),
        };
        mirrored.positions = mirrored.vectors(&self.rest.positions);
        mirrored.normals = mirrored.vectors(&self.rest.normals);
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

impl Mirrored {
    /// Vectors at all vertices from those of the half.
    pub(crate) fn vectors(&self, own: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let all = self.originals.iter().enumerate();
        all.map(|(i, v)| match i < self.own {
            true => own[v.index()],
            false => reflected(&own[v.index()]),
        })
        .collect()
    }

    /// Number of the half's own vertices, which come first.
    pub(crate) fn own_count(&self) -> usize {
        self.own
    }

    /// The place on the half that a place is, or is the image of.
    pub(crate) fn original_place(&self, place: &MaterialPoint) -> MaterialPoint {
        match place.face.index().checked_sub(self.own_faces) {
            None => *place,
            Some(face) => {
                let [a, b, c] = place.barycentric;
                MaterialPoint {
                    face: FaceId::from_index(face),
                    barycentric: [a, c, b],
                }
            }
        }
    }
}

/// The mirror image of a vector.
pub(crate) fn reflected(vector: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-vector.x, vector.y, vector.z)
}
