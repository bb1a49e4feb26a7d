//! The faces around one corner of a face, and the controls that they give.

use crate::{FaceId, Id, PerFace, PerVertex, SparseRows, TriMesh, VertexId};

/// Faces around a vertex that hang together, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexFan {
    /// The vertex.
    pub vertex: VertexId,
    /// Each face with the corner at which the vertex is.
    pub faces: Vec<(FaceId, usize)>,
    /// The neighbours, one where each face begins; of an open fan one more, on the border as the first.
    pub spokes: Vec<VertexId>,
    /// Whether the last face is followed by the first.
    pub closed: bool,
    /// Position in `faces` of the face asked for; zero in a closed fan.
    pub sector: usize,
}

impl VertexFan {
    /// The fans of all vertices, by face and corner of the first face of each that the mesh has.
    ///
    /// A vertex at which several fans touch has all of them.
    pub fn all(mesh: &TriMesh) -> Vec<Self> {
        let mut seen = PerFace::filled(mesh.face_count(), [false; 3]);
        let mut fans = Vec::new();
        for face in mesh.faces().ids() {
            for corner in 0..3 {
                if !seen[face][corner] {
                    let fan = Self::around(mesh, face, corner);
                    for &(face, corner) in &fan.faces {
                        seen[face][corner] = true;
                    }
                    fans.push(fan);
                }
            }
        }
        fans
    }

    /// The fan around `corner` of `face`; a closed one starts at that face, others at the border.
    ///
    /// # Panics
    /// When `face` is none of the mesh's, or `corner` is not 0, 1 or 2.
    pub fn around(mesh: &TriMesh, face: FaceId, corner: usize) -> Self {
        let vertex = mesh.faces()[face][corner];
        let mut first = (face, corner);
        let mut sector = 0;
        let mut closed = false;
        // Clockwise first, since an open fan begins at its border. An edge has at most two faces,
        // so the way cannot run into a loop that misses the face where it began.
        while let Some(before) = turn(mesh, first, vertex, 0) {
            if before.0 == face {
                closed = true;
                break;
            }
            first = before;
            sector += 1;
        }
        if closed {
            (first, sector) = ((face, corner), 0);
        }
        let mut faces = Vec::with_capacity(mesh.vertex_faces(vertex).len());
        faces.push(first);
        while let Some(next) = turn(mesh, faces[faces.len() - 1], vertex, 2) {
            if next.0 == first.0 {
                break;
            }
            faces.push(next);
        }
        let spoke = |&(f, c): &(FaceId, usize)| mesh.faces()[f][(c + 1) % 3];
        let mut spokes = Vec::with_capacity(faces.len() + usize::from(!closed));
        spokes.extend(faces.iter().map(spoke));
        if let (false, Some(&(f, c))) = (closed, faces.last()) {
            spokes.push(mesh.faces()[f][(c + 2) % 3]);
        }
        Self {
            vertex,
            faces,
            spokes,
            closed,
            sector,
        }
    }
}

/// The next face around `vertex` across the edge `side` corners further, and its corner there.
fn turn(
    mesh: &TriMesh,
    (face, corner): (FaceId, usize),
    vertex: VertexId,
    side: usize,
) -> Option<(FaceId, usize)> {
    let next = mesh.neighbour(face, (corner + side) % 3)?;
    let corner = mesh.faces()[next].iter().position(|&v| v == vertex)?;
    Some((next, corner))
}

/// How the surface behaves around a vertex, seen from one face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct VertexKind {
    /// Faces in the fan.
    pub(crate) faces: usize,
    /// Whether the fan is closed.
    pub(crate) closed: bool,
    /// Whether the vertex stays where it is: a corner, or a vertex with several fans.
    pub(crate) fixed: bool,
}

impl VertexKind {
    /// The kind of the vertex of `fan`.
    pub(crate) fn of(mesh: &TriMesh, corners: &PerVertex<bool>, fan: &VertexFan) -> Self {
        Self {
            faces: fan.faces.len(),
            closed: fan.closed,
            fixed: corners[fan.vertex] || mesh.vertex_faces(fan.vertex).len() != fan.faces.len(),
        }
    }

    /// Whether the surface is a box spline here.
    pub(crate) fn is_regular(&self) -> bool {
        !self.fixed && self.faces == if self.closed { 6 } else { 3 }
    }
}

/// The twelve controls of a box spline face from the mesh's vertices; `None` for another face.
///
/// The order is that of [`crate::box_spline::CONTROLS`]. Beyond a border edge `a b` with apex `c`
/// the control is `a + b - c`: with it, the rules of the interior give those of the border.
pub(crate) fn regular_controls(
    mesh: &TriMesh,
    corners: &PerVertex<bool>,
    face: FaceId,
) -> Option<SparseRows> {
    let mut rings = [[Control::Vertex(0); 6]; 3];
    for (corner, ring) in rings.iter_mut().enumerate() {
        let fan = VertexFan::around(mesh, face, corner);
        if !VertexKind::of(mesh, corners, &fan).is_regular() {
            return None;
        }
        *ring = ring_of_six(&fan);
    }
    // Of a corner's six neighbours 0 and 1 are the two other corners of the face, and those three
    // places further lie opposite them; 5 is the apex across edge `i`, and 2 is the 5 of another
    // corner.
    let own = mesh.faces()[face].map(|v| Control::Vertex(v.0));
    let across = rings.iter().map(|ring| ring[5]);
    let further = rings.iter().flat_map(|ring| [ring[4], ring[3]]);
    let mut rows = SparseRows::default();
    for control in own.into_iter().chain(across).chain(further) {
        match control {
            Control::Vertex(vertex) => rows.push_row(&mut [(vertex, 1.0)]),
            Control::Beyond([a, b, apex]) => {
                rows.push_row(&mut [(a, 1.0), (b, 1.0), (apex, -1.0)]);
            }
        }
    }
    Some(rows)
}

/// A control of a regular face.
#[derive(Clone, Copy)]
enum Control {
    /// A vertex of the mesh.
    Vertex(u32),
    /// Beyond a border edge: the sum of its ends less the apex.
    Beyond([u32; 3]),
}

/// The neighbours of a regular vertex, starting in the fan's sector.
fn ring_of_six(fan: &VertexFan) -> [Control; 6] {
    let beyond = |border: usize, apex: usize| {
        let [border, apex] = [border, apex].map(|i| fan.spokes[i].0);
        Control::Beyond([fan.vertex.0, border, apex])
    };
    let mut ring = std::array::from_fn(|i| match (fan.closed, i) {
        // Three faces have four spokes: the two neighbours that six faces would have besides lie
        // beyond the two border edges.
        (false, 4) => beyond(3, 2),
        (false, 5) => beyond(0, 1),
        _ => Control::Vertex(fan.spokes[i].0),
    });
    ring.rotate_left(fan.sector);
    ring
}

/// The controls of a face whose one irregular vertex is at `corner`, the others being new vertices
/// of a subdivision; `None` for a face that is not.
///
/// The vertex, its neighbours, the apexes beyond the rim of the sector before (if any), this one
/// and the one after (if any), then the far neighbours of the two other corners.
pub(crate) fn sector_controls(
    mesh: &TriMesh,
    face: FaceId,
    corner: usize,
) -> Option<Vec<VertexId>> {
    let fan = VertexFan::around(mesh, face, corner);
    let mut controls = vec![mesh.faces()[face][corner]];
    controls.extend(&fan.spokes);
    let count = fan.faces.len();
    let before = match fan.sector {
        0 if fan.closed => Some(count - 1),
        sector => sector.checked_sub(1),
    };
    let after = match fan.sector + 1 {
        sector if sector < count => Some(sector),
        _ => fan.closed.then_some(0),
    };
    for sector in [before, Some(fan.sector), after].into_iter().flatten() {
        let (f, c) = fan.faces[sector];
        controls.push(apex_across(mesh, f, (c + 1) % 3)?);
    }
    let beyond = mesh.neighbour(face, (corner + 1) % 3)?;
    let next = mesh.faces()[face][(corner + 1) % 3];
    let c = mesh.faces()[beyond].iter().position(|&v| v == next)?;
    controls.push(apex_across(mesh, beyond, c)?);
    controls.push(apex_across(mesh, beyond, (c + 1) % 3)?);
    Some(controls)
}

/// The vertex opposite edge `corner` of `face` in the face beyond it.
fn apex_across(mesh: &TriMesh, face: FaceId, corner: usize) -> Option<VertexId> {
    let edge = &mesh.edges()[mesh.face_edges(face)[corner]];
    let beyond = usize::from(edge.faces[0] == Some(face));
    edge.apexes[beyond]
}

/// A mesh of `kind.faces` faces around vertex 0; face `i` is sector `i`, with vertex 0 first.
pub(crate) fn fan_mesh(kind: VertexKind) -> TriMesh {
    let rim = kind.faces + usize::from(!kind.closed);
    let vertex = |i: usize| VertexId::from_index(1 + i % rim).0;
    let faces = (0..kind.faces).map(|i| [0, vertex(i), vertex(i + 1)]);
    TriMesh::new(1 + rim, faces.collect()).expect("a fan copied from a mesh is a mesh")
}

impl TriMesh {
    /// The fan of faces around a vertex; `None` where no face or more than one fan meets it.
    ///
    /// # Panics
    /// When `vertex` is none of this mesh's.
    pub fn ring(&self, vertex: VertexId) -> Option<VertexFan> {
        let faces = self.vertex_faces(vertex);
        let &face = faces.first()?;
        let corner = self.faces()[face].iter().position(|&v| v == vertex)?;
        let fan = VertexFan::around(self, face, corner);
        // Where several fans touch, one of them misses faces of the others.
        (fan.faces.len() == faces.len()).then_some(fan)
    }
}
