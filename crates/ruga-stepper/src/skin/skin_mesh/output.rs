//! Output meshes that are fine across the waves alone.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{FaceId, FaceOrigin, PerFace};
use ruga_remesh::Sizing;

use super::RegionMesh;
use crate::skin::piece::Piece;

/// Longest edges of an output mesh that is fine in all directions over those asked for: half of that is the shortest that
/// halving leaves.
pub(crate) const OUTPUT_SLACK: f64 = 1.3;
/// The same of a mesh that is fine across the waves alone. Its normals of a smile are as close to those on a mesh eight
/// times as fine, to 1.2 degrees of 18 where it wrinkles, with .3 of the vertices.
const ACROSS: f64 = 1.1;

impl RegionMesh {
    /// For every face of `piece`, of which this mesh is made, the measure of output edges (1/m²): a `sizing` that is known
    /// at this mesh's vertices, for edges `coarseness` times as long.
    pub(crate) fn output_measures(
        &self,
        piece: &Piece,
        (sizing, coarseness): (&Sizing, f64),
    ) -> PerFace<Matrix3<f64>> {
        // Faces of the piece may have been cut along lines since.
        let mut parts: BTreeMap<FaceId, Vec<(Vector3<f64>, FaceId)>> = BTreeMap::new();
        for (face, origin) in self.origins.iter() {
            parts
                .entry(origin.face)
                .or_default()
                .push((middle(origin), face));
        }
        let slack = (ACROSS * coarseness).powi(-2);
        let measure = |origin: &FaceOrigin| {
            let near = parts.get(&origin.face)?.iter();
            let distance = |part: &(Vector3<f64>, FaceId)| (part.0 - middle(origin)).norm_squared();
            let (_, face) = near.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            let corners = self.skin.mesh.faces()[*face].iter();
            let sum: Matrix3<f64> = corners.map(|&v| sizing.tensors[v]).sum();
            Some(sum * (slack / 3.0))
        };
        let origins = piece.origins.as_slice().iter();
        // A face that is in no part is as fine as its shape asks for.
        origins
            .map(|origin| measure(origin).unwrap_or_else(Matrix3::zeros))
            .collect()
    }
}

/// Barycentric coordinates of the middle of a face in the driver's.
fn middle(origin: &FaceOrigin) -> Vector3<f64> {
    let corners = origin.corners.iter();
    corners
        .map(|corner| Vector3::from(*corner))
        .sum::<Vector3<f64>>()
        / 3.0
}
