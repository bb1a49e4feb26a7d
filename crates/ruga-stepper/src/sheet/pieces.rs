//! Pieces that a burning sheet falls into.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, PerFace, TriMesh};
use ruga_shell::MIN_AREA_LEFT;

use super::burning::{Burning, FireState, Remains};
use crate::StepperError;

/// Longest sides of the sheet that a loose piece may be away before it is let go.
const FAR: f64 = 10.0;

/// What surrounds the pieces of a sheet.
pub(super) struct Around<'a> {
    pub(super) mesh: &'a TriMesh,
    pub(super) rest: &'a [Vector3<f64>],
    pub(super) positions: &'a [Vector3<f64>],
    /// Whether a handle holds a vertex.
    pub(super) held: &'a [bool],
    /// Longest side of the sheet, m.
    pub(super) side: f64,
    /// Loose pieces that are smaller vanish, m².
    pub(super) least: f64,
}

/// Lets pieces vanish that nothing holds and that are small or have fallen far; returns what is left of every face.
pub(super) fn let_go(
    fire: &FireState<'_>,
    burning: &mut Burning,
    around: &Around<'_>,
) -> Result<PerFace<Remains>, StepperError> {
    let remains = fire.remains(burning)?;
    let pieces = around.pieces(&remains);
    let is_lost = |piece: &&Vec<FaceId>| {
        let area = |face: &FaceId| remains[*face].share * fire.area(*face);
        let area: f64 = piece.iter().map(area).sum();
        // What has not burnt was as small from the beginning, and stays.
        let is_burnt = piece.iter().any(|face| remains[*face].is_burnt());
        let is_small = is_burnt && area < around.least;
        !around.is_held(piece) && (is_small || pieces.len() > 1 && around.is_far(piece))
    };
    let lost: Vec<&Vec<FaceId>> = pieces.iter().filter(is_lost).collect();
    for piece in &lost {
        fire.vanish(burning, piece, &remains);
    }
    let remains = match lost.is_empty() {
        true => remains,
        false => fire.remains(burning)?,
    };
    fire.drop_specks(burning, |face| stands(&remains[face]));
    Ok(remains)
}

/// Whether enough of a face is left for it to be simulated.
pub(super) fn stands(remains: &Remains) -> bool {
    remains.share >= MIN_AREA_LEFT
}

impl Around<'_> {
    /// The pieces of what stands.
    pub(super) fn pieces(&self, remains: &PerFace<Remains>) -> Vec<Vec<FaceId>> {
        self.mesh.connected_parts(|face| stands(&remains[face]))
    }

    fn vertices<'p>(&'p self, piece: &'p [FaceId]) -> impl Iterator<Item = usize> + 'p {
        let corners = piece.iter().flat_map(|face| self.mesh.faces()[*face]);
        corners.map(|v| v.index())
    }

    fn is_held(&self, piece: &[FaceId]) -> bool {
        self.vertices(piece).any(|v| self.held[v])
    }

    fn is_far(&self, piece: &[FaceId]) -> bool {
        let way = |v: usize| (self.positions[v] - self.rest[v]).norm();
        // All of it, so that nothing vanishes that may still be seen.
        self.vertices(piece).all(|v| way(v) > FAR * self.side)
    }
}
