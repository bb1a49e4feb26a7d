//! Output meshes that are fine across the waves alone.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use ruga_mesh::{FaceId, Id, PerFace};
use ruga_remesh::Sizing;

use super::RegionMesh;
use super::sizing::limit_aspect;
use crate::skin::refined::Refined;

/// Longest edges over those asked for of an output mesh that is fine in all directions: half of that is the
/// shortest that halving leaves.
pub(crate) const OUTPUT_SLACK: f64 = 1.3;
/// Longest edges across the waves, over those asked for, of an output mesh that is fine there alone. Normals of a smile
/// are then 1.3 degrees, of 18, from those on a mesh of 403 thousand vertices, as they are on one that is fine in all
/// directions.
const ACROSS: f64 = 1.1;
/// Largest ratio of edges along and across the waves: relief fades at borders over half a wave, which takes a few
/// edges in every direction.
const ASPECT: f64 = 2.0;

/// Faces whose terms are found before they are added up, one after the other.
const AT_A_TIME: usize = 1 << 15;

impl RegionMesh {
    /// Measure of output edges (1/m²) for every face of the whole that this mesh was refined `from`: as short as
    /// anywhere in the face by a `sizing` that is known at this mesh's vertices, `coarseness` times as long. No line
    /// must have been cut into this mesh since.
    pub(crate) fn output_measures(
        &self,
        from: &Refined,
        (sizing, coarseness): (&Sizing, f64),
    ) -> PerFace<Matrix3<f64>> {
        let slack = (ACROSS * coarseness).powi(-2);
        // Sum of the tensors of a face's parts, by area, that area, and the largest value of all of them.
        let none = (Matrix3::zeros(), 0.0, 0.0_f64);
        let mut sums = PerFace::filled(from.whole.mesh.face_count(), none);
        let part = |face: FaceId| {
            let corners = self.skin.mesh.faces()[face];
            let tensors = corners.iter().map(|&v| sizing.tensors[v]);
            let mean = tensors.sum::<Matrix3<f64>>() * (slack / 3.0);
            let [a, b, c] = corners.map(|v| self.skin.rest.positions[v.index()]);
            let area = Vector3::norm(&(b - a).cross(&(c - a)));
            (mean * area, area, mean.symmetric_eigenvalues().max())
        };
        let count = self.skin.mesh.face_count();
        for first in (0..count).step_by(AT_A_TIME) {
            let faces = first..count.min(first + AT_A_TIME);
            let each = faces.clone().into_par_iter();
            let parts: Vec<_> = each.map(|face| part(FaceId::from_index(face))).collect();
            for (face, (mean, area, value)) in faces.map(FaceId::from_index).zip(parts) {
                let (sum, whole, most) = &mut sums[from.origins[face]];
                *sum += mean;
                *whole += area;
                *most = most.max(value);
            }
        }
        let measure = |(sum, whole, most): &(Matrix3<f64>, f64, f64)| {
            let mut mean = sum / whole.max(f64::MIN_POSITIVE);
            let own = mean.symmetric_eigenvalues().max();
            if own > 0.0 {
                mean *= most / own;
            }
            limit_aspect(&mut mean, ASPECT);
            mean
        };
        let measures: Vec<_> = sums.as_slice().par_iter().map(measure).collect();
        measures.into()
    }
}

#[cfg(test)]
mod tests {
    use ruga_blend::{BaseSurface, Smoothing};

    use super::*;
    use crate::skin::piece::Piece;
    use crate::skin::refined::refined;
    use crate::test_drivers::{SIDE, region, square};

    /// Waves across x on one half of a flat square, and nothing on the other.
    #[test]
    fn edges_are_short_across_the_waves_where_there_are_some() {
        let flat = |p: nalgebra::Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = square(&flat, &flat);
        let region = region(&driver, 0, 0.0);
        let (across, coarse) = (SIDE / 300.0, SIDE / 5.0);
        let tensor = |x: &Vector3<f64>| {
            let waves = if x.x < 0.0 { across } else { coarse };
            Matrix3::from_diagonal(&Vector3::new(waves, coarse, coarse).map(|l| l.powi(-2)))
        };
        let tensors = region.skin.rest.positions.iter().map(tensor).collect();
        let faces: Vec<FaceId> = driver.topology().faces().ids().collect();
        let whole = Piece::of(&BaseSurface::new(&driver, &faces, 0, Smoothing::Loop));
        let before = whole.mesh.face_count();
        let origins = faces.into_iter().collect();
        let from = Refined { whole, origins };
        let measures = region.output_measures(&from, (&Sizing { tensors }, 1.0));
        let (fine, _) =
            refined(&driver, from.whole, &measures, &mut || true).expect("nothing ends it");
        let positions = fine.flat_positions(&driver);
        let longest = ACROSS * across;
        let (mut left, mut right, mut along) = (0, 0, 0.0_f64);
        for (_, corners) in fine.mesh.faces().iter() {
            let [a, b, c] = corners.map(|v| positions[v.index()]);
            let middle = (a + b + c) / 3.0;
            // Beside the middle the tensor changes within a face.
            if middle.x < -SIDE / 20.0 {
                left += 1;
                for edge in [b - a, c - b, a - c] {
                    assert!(edge.x.abs() <= longest * (1.0 + 1e-9), "{} m", edge.x);
                    along = along.max(edge.y.abs());
                }
            } else if middle.x > SIDE / 20.0 {
                right += 1;
            }
        }
        assert!(along > 1.2 * longest, "{along} m along the waves");
        // The other half stays as it is, up to a border that is cut with its neighbours.
        assert!(right < before, "{right} faces of {before}");
        assert!(left > 10 * right, "{left} faces");
    }
}
