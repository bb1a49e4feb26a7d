//! The limit surface of a large mesh, part by part.

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{FaceId, Id, LoopSurface, MaterialPoint, PerFace, TriMesh, VertexId};

use super::no_corners;

/// Faces of a part, whose limit surface is prepared at a time: 1 kB each, and 2 kB more where places lie on them.
pub(super) const FACES_AT_A_TIME: usize = 8192;

/// Places evaluated with one preparation of a part: where a fine mesh lies on a coarse one, a part has a million.
const PLACES_OF_PART: usize = 1 << 16;

/// Parts evaluated before what was found is put in its place: no more threads than these are used, and no more memory.
const PARTS_AT_A_TIME: usize = 4;

/// The limit surface of a mesh on some of its faces.
///
/// A face's surface depends on the faces around its vertices alone, so that a part with these is as good as the whole.
pub(super) struct LimitPart {
    pub(super) surface: LoopSurface,
    /// The vertices of the mesh that it has, ascending.
    vertices: Vec<VertexId>,
    /// The faces on which its surface is that of the mesh, ascending, and their numbers in the part.
    known: Vec<(FaceId, u32)>,
}

impl LimitPart {
    /// The part with these faces of `mesh` and so many rings of faces around them. Unlike with
    /// [`TriMesh::submesh`] no list is as long as the whole mesh, of which there are many parts.
    fn new(mesh: &TriMesh, core: &[FaceId], rings: usize) -> Self {
        let mut chosen = core.to_vec();
        chosen.sort_unstable();
        for _ in 0..rings {
            add_neighbours(mesh, &mut chosen);
        }
        let known = chosen.clone();
        add_neighbours(mesh, &mut chosen);
        let mut vertices: Vec<VertexId> = chosen.iter().flat_map(|&f| mesh.faces()[f]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: VertexId| vertices.partition_point(|&other| other < v) as u32;
        let faces = chosen.iter().map(|&face| mesh.faces()[face].map(number));
        let part = TriMesh::new(vertices.len(), faces.collect());
        let part = part.expect("faces of a valid mesh are a valid mesh");
        let mut surface = LoopSurface::new(&part, &no_corners(&part));
        if rings > 0 {
            // Places that may move are asked for again.
            surface.keep_patches();
        }
        let known = known.into_iter().map(|face| {
            let number = chosen.partition_point(|&other| other < face);
            (face, number as u32)
        });
        Self {
            surface,
            known: known.collect(),
            vertices,
        }
    }

    /// A place of the mesh, if the surface is known there.
    pub(super) fn place(&self, place: &MaterialPoint) -> Option<MaterialPoint> {
        let found = self
            .known
            .binary_search_by_key(&place.face, |(face, _)| *face);
        found.ok().map(|i| MaterialPoint {
            face: FaceId(self.known[i].1),
            ..*place
        })
    }

    /// Its control points, of those of the mesh.
    pub(super) fn control(&self, control: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.vertices.iter().map(|v| control[v.index()]).collect()
    }
}

/// Evaluates `places` part by part: `of_part` is given the limit surface of `most` neighbouring faces and the numbers
/// of the places on them, and may move these over so many `rings` of faces around. Parts run in parallel; `take` gets
/// what was found in their order, until it says no.
pub(super) fn for_each_part<R: Send>(
    mesh: &TriMesh,
    places: &[MaterialPoint],
    (most, rings): (usize, usize),
    of_part: impl Fn(&LimitPart, &[u32]) -> R + Sync,
    mut take: impl FnMut(&[u32], R) -> bool,
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
    by_part.par_sort_unstable_by_key(|&i| (part_of(i), i));
    let parts = by_part.chunk_by(|&i, &j| part_of(i) == part_of(j));
    let parts: Vec<&[u32]> = parts.flat_map(|own| own.chunks(PLACES_OF_PART)).collect();
    let found = |own: &&[u32]| {
        let part = part_of(own[0]);
        let core = &faces[part * most..faces.len().min((part + 1) * most)];
        of_part(&LimitPart::new(mesh, core, rings), own)
    };
    for parts in parts.chunks(PARTS_AT_A_TIME) {
        let found: Vec<R> = parts.par_iter().map(found).collect();
        for (own, found) in parts.iter().zip(found) {
            if !take(own, found) {
                return;
            }
        }
    }
}

/// Adds the other faces around the vertices of those that are `chosen`, ascending as these.
fn add_neighbours(mesh: &TriMesh, chosen: &mut Vec<FaceId>) {
    let vertices = chosen.iter().flat_map(|&face| mesh.faces()[face]);
    let around = vertices.flat_map(|v| mesh.vertex_faces(v));
    let around: Vec<FaceId> = around.copied().collect();
    chosen.extend(around);
    chosen.sort_unstable();
    chosen.dedup();
}
