//! What a layer is made of, while it is being solved.

use super::LayerEnergy;
use crate::parameters::check_length;
use crate::{FaceParameters, MIN_AREA_LEFT, ShellError};

impl LayerEnergy {
    /// Replaces material and springs of every face; the pattern of the Hessian stays.
    ///
    /// Membrane, bending and the normal foundation follow at once, and of the creases the bounds on their
    /// compliance. Rest metric, natural strains and curvatures, rest angles and bending factor stay as they
    /// are; so do tangential springs, which belong to vertices, the stiffness on the gradient of the drift, and
    /// line anchors.
    ///
    /// # Errors
    /// [`ShellError::PairOfSheets`]; [`ShellError::LengthMismatch`]; [`ShellError::ParameterOutOfRange`], as
    /// for a new layer. The layer is then unchanged.
    pub fn set_face_parameters(&mut self, faces: &[FaceParameters]) -> Result<(), ShellError> {
        self.check_single("face parameters")?;
        check_length("face parameters", self.lower().faces().len(), faces.len())?;
        for (index, face) in faces.iter().enumerate() {
            face.check(index)?;
        }
        let area_left = self.lower().area_left().to_vec();
        self.set_material(faces.to_vec(), area_left);
        Ok(())
    }

    /// Sets the share of every face's area that is left, 1 when built, for sheets that burn or tear away
    /// along a line through their faces.
    ///
    /// It scales the membrane, bending and foundation stiffness of a face and its part of
    /// [`Self::vertex_areas`], and with those the tangential springs, and the stiffness on the gradient of the
    /// drift. Rest shapes, natural angles, creases and line anchors stay those of the whole face.
    ///
    /// # Validity
    /// Shares from [`MIN_AREA_LEFT`] to 1. A face with less is to leave the mesh, which needs a new layer.
    ///
    /// # Errors
    /// [`ShellError::PairOfSheets`]; [`ShellError::LengthMismatch`]; [`ShellError::ParameterOutOfRange`] for
    /// a share outside its range. The layer is then unchanged.
    pub fn set_area_left(&mut self, shares: &[f64]) -> Result<(), ShellError> {
        self.check_single("the area left of a face")?;
        check_length("shares of area", self.lower().faces().len(), shares.len())?;
        let valid = |share: &f64| (MIN_AREA_LEFT..=1.0).contains(share);
        if let Some(index) = shares.iter().position(|share| !valid(share)) {
            return Err(ShellError::ParameterOutOfRange {
                element: "face",
                index,
                name: "area left",
                value: shares[index],
                range: "0.02 <= share <= 1",
            });
        }
        let parameters = self.lower().parameters().to_vec();
        self.set_material(parameters, shares.to_vec());
        Ok(())
    }

    /// Scales the bending stiffness, 1 when built.
    ///
    /// Triangles that are not equilateral bend more or less easily than the material; the
    /// inverse of their [`response_modulus`](crate::response_modulus), as a share of the
    /// material's, makes up for it on average.
    ///
    /// # Errors
    /// [`ShellError::BendingFactor`] unless the factor is positive and finite.
    pub fn set_bending_factor(&mut self, factor: f64) -> Result<(), ShellError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(ShellError::BendingFactor { value: factor });
        }
        for sheet in &mut self.sheets {
            sheet.set_bending_factor(factor);
        }
        Ok(())
    }

    /// Sets the stiffness `Kg` (N/m) on the gradient of the drift along the surface below, 0 when built; of a
    /// pair, below the lower sheet.
    ///
    /// ```text
    /// E = 1/2 Kg int |grad t|^2,   t = (I - n n^T)(x - p)
    /// ```
    ///
    /// A wave of sliding with wave number `k` is then held by `Kt + Kg k^2`: like an elastic layer more stiffly the
    /// shorter it is.
    ///
    /// # Validity
    /// An elastic layer's stiffness grows with `k` and not with its square, and is half as large for sliding across
    /// the wave: two wave numbers can be met. `t` are vectors in space; on a base of curvature `kappa` even sliding is
    /// held by `Kg kappa^2`, too.
    ///
    /// # Errors
    /// [`ShellError::DriftGradient`] unless it is finite and at least 0; the layer is then unchanged.
    pub fn set_drift_gradient_stiffness(&mut self, stiffness: f64) -> Result<(), ShellError> {
        self.foundation
            .set_drift_gradient(stiffness, &self.sheets[0])
    }

    pub(super) fn check_single(&self, what: &'static str) -> Result<(), ShellError> {
        // One array of faces cannot say which sheet of a pair it is meant for, and the springs between the
        // two come from the parameters of the upper one.
        match self.springs {
            None => Ok(()),
            Some(_) => Err(ShellError::PairOfSheets { what }),
        }
    }

    fn set_material(&mut self, parameters: Vec<FaceParameters>, area_left: Vec<f64>) {
        self.sheets[0].set_material(parameters, area_left);
        self.foundation.set_rest(&self.sheets[0]);
    }
}
