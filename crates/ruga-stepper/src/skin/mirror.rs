//! One half of a pose that is its own mirror image at the plane `x = 0`.

use nalgebra::Vector3;
use ruga_blend::{Driver, Weights};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerFace, PerVertex, TriMesh, VertexId};

use crate::skin::skin_mesh::SkinMesh;

/// How far from the plane a vertex on it may be, in sizes of the mesh: 30 µm on a head.
const ON_PLANE: f64 = 1e-4;

/// Weight up to which a corner off the plane does not take a place off it.
const NO_WEIGHT: f64 = 1e-6;

/// Whether a pose with these weights can be simulated on one side of the plane `x = 0` alone: the mesh has edges all
/// along that plane, and neither at rest nor in the pose do their ends leave it.
///
/// Whether the two sides are alike is not asked.
pub fn can_be_halved(driver: &Driver, weights: &Weights) -> bool {
    let on_plane = plane_vertices(driver);
    let (topology, rest) = (driver.topology(), driver.rest());
    let is_clean = |(face, corners): (FaceId, &[VertexId; 3])| {
        let right = is_right(driver, face);
        let is_beyond = |v: &VertexId| !on_plane[*v] && (rest[v.index()].x > 0.0) != right;
        !corners.iter().any(is_beyond) && !corners.iter().all(|v| on_plane[*v])
    };
    let posed = driver.pose(weights);
    let most = ON_PLANE * extent(rest);
    let stays = |v: VertexId| [rest, &posed].map(|x| x[v.index()].x.abs() <= most) == [true; 2];
    let on_both_sides = |faces: [Option<FaceId>; 2]| match faces {
        [Some(a), Some(b)] => is_right(driver, a) != is_right(driver, b),
        _ => false,
    };
    let mut edges = topology.edges().as_slice().iter();
    let is_halved = on_plane.as_slice().contains(&true)
        && topology.faces().iter().all(is_clean)
        && on_plane.ids().filter(|v| on_plane[*v]).all(stays);
    // An edge between two such vertices that does not run along the plane would be glued to its own image.
    is_halved
        && edges
            .all(|edge| !edge.vertices.iter().all(|v| on_plane[*v]) || on_both_sides(edge.faces))
}

/// Whether a face lies on the side that is simulated.
pub(crate) fn is_right(driver: &Driver, face: FaceId) -> bool {
    let corners = driver.topology().faces()[face];
    corners
        .iter()
        .map(|v| driver.rest()[v.index()].x)
        .sum::<f64>()
        > 0.0
}

/// The driver's vertices with faces on both sides.
fn plane_vertices(driver: &Driver) -> PerVertex<bool> {
    let topology = driver.topology();
    let right: PerFace<bool> = topology
        .faces()
        .ids()
        .map(|f| is_right(driver, f))
        .collect();
    let is_between = |v: VertexId| {
        let faces = topology.vertex_faces(v);
        faces.iter().any(|f| right[*f]) && !faces.iter().all(|f| right[*f])
    };
    let all = PerVertex::filled(topology.vertex_count(), ());
    all.ids().map(is_between).collect()
}

/// The longest side of the box around the points, m.
fn extent(points: &[Vector3<f64>]) -> f64 {
    let mut bounds = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
    for point in points {
        bounds = [bounds[0].inf(point), bounds[1].sup(point)];
    }
    (bounds[1] - bounds[0]).max()
}

/// Whether every vertex of a mesh of one half, at these places of the driver, lies on the plane where that half ends;
/// empty when none does.
pub(super) fn on_plane(driver: &Driver, mesh: &TriMesh, places: &[MaterialPoint]) -> Vec<bool> {
    let between = plane_vertices(driver);
    let border = mesh.border_vertices();
    let is_on = |(place, on_border): (&MaterialPoint, &bool)| {
        let corners = driver.topology().faces()[place.face].iter();
        let off = corners
            .zip(place.barycentric)
            .filter(|(v, _)| !between[**v]);
        *on_border && off.map(|(_, weight)| weight).sum::<f64>() < NO_WEIGHT
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
