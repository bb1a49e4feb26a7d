//! Pieces of a burning sheet that a new mesh must not join again.

use ruga_mesh::{FaceId, Id, PerFace, TriMesh};

use super::burning::{Burning, FireState};
use super::pieces::stands;
use crate::StepperError;

impl FireState<'_> {
    /// Drops what lies on a triangle of the sheet's mesh beside a larger piece, or shares a vertex with one, where the
    /// field's triangles lie on these pieces, the largest first: they may be far apart by now.
    pub(super) fn keep_apart(
        &self,
        burning: &mut Burning,
        mesh: &TriMesh,
        pieces: &PerFace<Option<usize>>,
    ) -> Result<(), StepperError> {
        let remains = self.remains(burning)?;
        let mut of_faces: Vec<Option<usize>> = vec![None; mesh.face_count()];
        for (field, owner) in self.pairs() {
            if let (Some(piece), true) = (pieces[field], stands(&remains[owner])) {
                let own = &mut of_faces[owner.index()];
                *own = Some(own.map_or(piece, |other| other.min(piece)));
            }
        }
        let mut of_vertices: Vec<Option<usize>> = vec![None; mesh.vertex_count()];
        for (corners, piece) in mesh.faces().as_slice().iter().zip(&of_faces) {
            let Some(piece) = piece else { continue };
            for v in corners {
                let own = &mut of_vertices[v.index()];
                *own = Some(own.map_or(*piece, |other| other.min(*piece)));
            }
        }
        let is_beside = |face: FaceId| {
            let corners = mesh.faces()[face].into_iter();
            let mut larger = corners.filter_map(|v| of_vertices[v.index()]);
            of_faces[face.index()].is_some_and(|own| larger.any(|other| other < own))
        };
        let is_lost = |(field, owner): &(FaceId, FaceId)| {
            let is_smaller = pieces[*field] > of_faces[owner.index()];
            of_faces[owner.index()].is_some() && is_smaller || is_beside(*owner)
        };
        let lost: Vec<FaceId> = self
            .pairs()
            .filter(is_lost)
            .map(|(field, _)| field)
            .collect();
        self.drop_fields(burning, lost);
        Ok(())
    }
}
