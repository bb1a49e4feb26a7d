//! The limit surface of a large mesh, part by part.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, LoopSurface, MaterialPoint, PerFace, TriMesh, VertexId};

use super::no_corners;

/// Faces whose limit surface is prepared at a time, 1 kB each, and 2 kB more where places lie on them.
pub(super) const FACES_AT_A_TIME: usize = 16_384;

/// The limit surface of a mesh on some of its faces.
///
/// A face's surface depends on the faces around its vertices alone, so that a part with these is as good as the whole.
pub(super) struct LimitPart<'n> {
    pub(super) surface: LoopSurface,
    vertices: Vec<VertexId>,
    /// The number of every face of the mesh in the part; [`OUTSIDE`] where its surface is not that of the mesh.
    numbers: &'n PerFace<u32>,
}

const OUTSIDE: u32 = u32::MAX;

impl LimitPart<'_> {
    /// A place of the mesh, if the surface is known there.
    pub(super) fn place(&self, place: &MaterialPoint) -> Option<MaterialPoint> {
        let number = self.numbers[place.face];
        (number != OUTSIDE).then_some(MaterialPoint {
            face: FaceId(number),
            ..*place
        })
    }

    /// Its control points, of those of the mesh.
    pub(super) fn control(&self, control: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.vertices.iter().map(|v| control[v.index()]).collect()
    }
}

/// Hands out the limit surface of `mesh` for `most` faces at a time, and for `rings` rings of faces around these, with
/// the numbers of those of `places` that lie on the former; as long as `act` says yes.
pub(super) fn for_each_part(
    mesh: &TriMesh,
    places: &[MaterialPoint],
    (most, rings): (usize, usize),
    mut act: impl FnMut(&LimitPart<'_>, &[u32]) -> bool,
) {
    // From neighbour to neighbour, so that few faces lie around each part.
    let faces = match mesh.face_count() <= most {
        true => mesh.faces().ids().collect(),
        false => mesh.connected_parts(|_| true).concat(),
    };
    let mut ranks = PerFace::filled(faces.len(), 0);
    for (rank, &face) in faces.iter().enumerate() {
        ranks[face] = rank;
    }
    let part_of = |i: u32| ranks[places[i as usize].face] / most;
    let mut by_part: Vec<u32> = (0..places.len() as u32).collect();
    by_part.sort_unstable_by_key(|&i| (part_of(i), i));
    let mut numbers = PerFace::filled(faces.len(), OUTSIDE);
    let mut is_chosen = PerFace::filled(faces.len(), false);
    for own in by_part.chunk_by(|&i, &j| part_of(i) == part_of(j)) {
        let part = part_of(own[0]);
        let mut chosen = faces[part * most..faces.len().min((part + 1) * most)].to_vec();
        for &face in &chosen {
            is_chosen[face] = true;
        }
        for _ in 0..rings {
            add_neighbours(mesh, &mut chosen, &mut is_chosen);
        }
        let known = chosen.len();
        add_neighbours(mesh, &mut chosen, &mut is_chosen);
        for (number, &face) in (0..).zip(&chosen[..known]) {
            numbers[face] = number;
        }
        let whole = mesh.submesh(&chosen);
        let mut surface = LoopSurface::new(&whole.mesh, &no_corners(&whole.mesh));
        surface.keep_patches();
        let part = LimitPart {
            surface,
            vertices: whole.vertices.into_vec(),
            numbers: &numbers,
        };
        if !act(&part, own) {
            return;
        }
        for &face in &chosen {
            (numbers[face], is_chosen[face]) = (OUTSIDE, false);
        }
    }
}

/// Adds the other faces around the vertices of those that are `chosen`.
fn add_neighbours(mesh: &TriMesh, chosen: &mut Vec<FaceId>, is_chosen: &mut PerFace<bool>) {
    for i in 0..chosen.len() {
        for v in mesh.faces()[chosen[i]] {
            for &face in mesh.vertex_faces(v) {
                if !std::mem::replace(&mut is_chosen[face], true) {
                    chosen.push(face);
                }
            }
        }
    }
}
