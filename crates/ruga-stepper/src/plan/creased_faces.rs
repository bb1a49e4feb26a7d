//! The faces of the planning surface on which crease lines fold in a pose.

use ruga_blend::BaseSurface;
use ruga_material::CAP_START;
use ruga_mesh::{FaceId, Id, MaterialPoint, PerFace};

use crate::plan::pose_plan::PlannedLayer;
use crate::plan::region::{ACTIVE_FRACTION, PoseStrains};
use crate::{CreaseSpec, LayerSpec, PoseSpec};

/// Barycentric weight by which a place may miss a face and still lie in it.
const INSIDE: f64 = 1e-6;

/// Faces of the planning surface that the lines of its layer's creases run over.
pub(crate) struct CreasedFaces(Vec<Vec<FaceId>>);

/// The part of a line that folds in a pose.
pub(crate) struct FoldingLine {
    pub(crate) faces: Vec<FaceId>,
    /// Its length, m.
    pub(crate) length: f64,
}

impl CreasedFaces {
    /// Finds the faces of `surface`, whose edges are `edges` (m) long, under the lines, where the layer is.
    pub(crate) fn new(surface: &BaseSurface, layer: &LayerSpec, edges: &PerFace<f64>) -> Self {
        let creases = &layer.creases;
        let is_covered = |face: &FaceId| {
            let [a, b, c] = surface.uvs()[*face];
            layer.presence.covers((a + b + c) / 3.0)
        };
        if creases.is_empty() {
            return Self(Vec::new());
        }
        let origins = surface.origins();
        let parents = origins.as_slice().iter().map(|origin| origin.face.index());
        let mut parts = vec![Vec::new(); parents.max().map_or(0, |largest| largest + 1)];
        for (face, origin) in origins.iter() {
            parts[origin.face.index()].push(face);
        }
        let faces_under = |crease: &CreaseSpec| {
            let mut under = Vec::new();
            for segment in crease.line.segments() {
                let Some(own) = parts.get(segment.face.index()) else {
                    continue;
                };
                let shortest = own.iter().map(|&f| edges[f]).fold(f64::INFINITY, f64::min);
                // Half an edge apart no more than a corner of a face is missed.
                let steps = (2.0 * segment.length / shortest).ceil().clamp(1.0, 1e4) as u32;
                for step in 0..=steps {
                    let place = segment.place(f64::from(step) / f64::from(steps));
                    let lies_in = |face: &&FaceId| is_in(surface, **face, &place);
                    under.extend(own.iter().find(lies_in));
                }
            }
            under.sort_unstable();
            under.dedup();
            under.retain(is_covered);
            under
        };
        Self(creases.iter().map(faces_under).collect())
    }

    /// For every line the faces on it that fold in a pose: all of one that is drawn, and where the pose's
    /// compression makes it give way; none on a line that stays as it is.
    pub(crate) fn in_pose(
        &self,
        layer: &PlannedLayer<'_>,
        pose: &PoseSpec,
        strains: &PoseStrains,
    ) -> Vec<FoldingLine> {
        let last = pose.keys.iter().copied().fold(0.0, f64::max);
        let creases = layer.spec.creases.iter().zip(&self.0);
        let folding = creases.map(|(crease, faces)| {
            // The last key draws it most.
            let is_drawn = crease.is_drawn(crease.strength(&pose.weights, last));
            let gives_way = match crease.softness() > 0.0 {
                true => ACTIVE_FRACTION * crease.onset_ratio(layer.wrinkling),
                false => f64::INFINITY,
            };
            let takes_up = |face| crease.absorbs && strains.compression[face] > CAP_START;
            let folds = |face: &&FaceId| {
                is_drawn || takes_up(**face) || strains.strain_ratio(**face) > gives_way
            };
            let folding: Vec<FaceId> = faces.iter().filter(folds).copied().collect();
            let share = folding.len() as f64 / faces.len().max(1) as f64;
            FoldingLine {
                length: share * crease.line.length(),
                faces: folding,
            }
        });
        folding.collect()
    }
}

/// Whether a place of the driver lies in a part of its face.
fn is_in(surface: &BaseSurface, face: FaceId, place: &MaterialPoint) -> bool {
    let corners = surface.origins()[face].corners;
    let area = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
    };
    let [a, b, c] = corners;
    let (whole, p) = (area(a, b, c), place.barycentric);
    let weights = [area(p, b, c), area(a, p, c), area(a, b, p)];
    weights.iter().all(|weight| weight / whole > -INSIDE)
}
