//! How the mesh's triangles bend, and the correction for it.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use ruga_mesh::{face_areas, triangle_frame};
use ruga_shell::{BendingModel, HINGE_EXPONENT, ResponseQuery, face_corners, response_modulus};

use super::Layer;
use crate::StepperError;
use crate::support::support_surface::SupportSurface;

/// Ratios of a mesh's bending modulus to the material's that can be the triangles' doing. A smaller
/// one counts as not measured.
const BENDING_RATIOS: [f64; 2] = [0.5, 2.0];

impl Layer {
    /// Measures how the mesh bends where, and in the direction that, `support` compresses the layer,
    /// and makes up for what is missing to the material, for hinges also for what is too much; the
    /// layer stays where it is.
    /// False when the layer is compressed enough to wrinkle and could not be measured.
    pub(crate) fn calibrate_bending(
        &mut self,
        support: SupportSurface,
    ) -> Result<bool, StepperError> {
        let state = self.state();
        self.set_support(support, 1.0)?;
        let [low, high] = BENDING_RATIOS;
        let measured = self.measured_bending_ratio();
        self.bending_ratio = measured
            .filter(|ratio| *ratio >= low)
            .map(|ratio| ratio.min(high));
        if let Some(ratio) = self.bending_ratio {
            let ratio = match self.bending {
                BendingModel::Hinge => ratio,
                // What stiffens it is the border of a narrow region, which stiffens the skin too.
                BendingModel::VertexCurvature => ratio.min(1.0),
            };
            let outcome = self.energy.set_bending_factor(1.0 / ratio);
            outcome.map_err(|source| self.shell_error(source))?;
        }
        let is_measured = self.bending_ratio.is_some() || self.strain_ratio() <= 1.0;
        // It was measured on the surface of a key, and the layer begins at rest.
        self.restore(&state)?;
        Ok(is_measured)
    }

    /// Response bending modulus of this mesh, compressed in the main direction, over that of the
    /// material; `None` where nothing is compressed enough or the mesh has no wrinkling mode.
    ///
    /// One direction for all: one that varies from face to face frustrates the mode and would
    /// count as stiffness.
    fn measured_bending_ratio(&self) -> Option<f64> {
        let mesh = &self.skin.mesh;
        let corners = face_corners(mesh, &self.skin.rest.positions);
        let directions = vec![self.main_direction(&corners)?; mesh.face_count()];
        // On a body, too, where nothing holds the border: the softest wave runs along a free edge, is
        // about half as stiff as any in the middle, and says nothing of the mesh.
        let pinned = mesh.border_vertices();
        let response = response_modulus(&ResponseQuery {
            mesh,
            corners: &corners,
            directions: &directions,
            fixed: pinned.as_slice(),
            bending_modulus: self.wrinkling.bending_stiffness,
            hinge_exponent: HINGE_EXPONENT,
            poisson: self.spec.material.poisson,
            bending_model: self.bending,
            normal_stiffness: self.wrinkling.normal_stiffness,
            gradient_stiffness: self.wrinkling.gradient_stiffness,
        });
        let modulus = response.ok().filter(|r| r.converged)?.bending_modulus;
        Some(modulus / self.wrinkling.bending_stiffness)
    }

    /// The direction in space in which most of the compression beyond the critical strain goes.
    fn main_direction(&self, corners: &[[Vector3<f64>; 3]]) -> Option<Vector3<f64>> {
        let mut tensor = Matrix3::zeros();
        let ratios = self.strain_ratios();
        let areas = face_areas(&self.skin.mesh, &self.skin.rest.positions);
        for (corners, (face, strain)) in corners.iter().zip(self.strains.iter()) {
            let excess = ratios.of_face(face) - 1.0;
            let [u, v] = triangle_frame(corners);
            let direction = u * strain.direction.x + v * strain.direction.y;
            // A direction and its opposite are the same wave, and would cancel in a sum of vectors.
            tensor += direction * direction.transpose() * (areas[face] * excess.max(0.0));
        }
        let eigen = SymmetricEigen::new(tensor);
        let largest = eigen.eigenvalues.imax();
        (eigen.eigenvalues[largest] > 0.0).then(|| eigen.eigenvectors.column(largest).into_owned())
    }
}
