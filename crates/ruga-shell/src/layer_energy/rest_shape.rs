//! The shape that a layer would like to have.

use nalgebra::{Matrix2, Vector3};

use super::LayerEnergy;
use crate::parameters::{check_finite, check_length};
use crate::{BendingModel, ShellError};

/// Difference of the two mixed components of a curvature, over its largest one, that counts as none.
/// Rounding in a change of frame leaves 1e-15; what is off by more is no curvature.
const SYMMETRY_TOLERANCE: f64 = 1e-9;

impl LayerEnergy {
    /// Stretches every rest triangle, as built, by a 2×2 matrix in its local frame
    /// ([`ruga_mesh::triangle_frame`]): the rest metric becomes `S^T S`. Replaces any earlier stretch.
    ///
    /// Membrane, bending stiffness and springs all follow, of a pair in both sheets; rest angles and natural
    /// curvatures (1/m) stay, and natural strains are zero again.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`], [`ShellError::InvertedStretch`],
    /// [`ShellError::DegenerateFace`]; the layer is then unchanged.
    pub fn set_rest_metric(&mut self, stretches: &[Matrix2<f64>]) -> Result<(), ShellError> {
        check_length(
            "rest stretches",
            self.lower().faces().len(),
            stretches.len(),
        )?;
        // All rest triangles are made before any is put in place: after an error nothing has
        // changed.
        let stretched = self.sheets.iter().map(|sheet| sheet.stretched(stretches));
        let stretched = stretched.collect::<Result<Vec<_>, _>>()?;
        for (sheet, rest) in self.sheets.iter_mut().zip(stretched) {
            sheet.set_rest(rest);
        }
        if let Some(springs) = &mut self.springs {
            springs.set_rest(self.sheets[0].rest());
        }
        self.foundation.set_rest(&self.sheets[0]);
        Ok(())
    }

    /// Sets every face's Green strain without stress, in the frame of its stretched rest triangle.
    ///
    /// With `(1 - s)` times the strain of a surface the layer on it has `s` times its strain, while
    /// bending and foundation, and so the length of the waves, stay those of the rest metric.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`] for an array of another size;
    /// [`ShellError::ParameterOutOfRange`] for a strain that is not finite.
    pub fn set_natural_strains(&mut self, strains: &[Matrix2<f64>]) -> Result<(), ShellError> {
        check_length("natural strains", self.lower().faces().len(), strains.len())?;
        check_tensors("natural strain", strains)?;
        for sheet in &mut self.sheets {
            sheet.set_natural_strains(strains);
        }
        Ok(())
    }

    /// Makes the angles of `positions` (m) the rest angles: the layer is not bent there, unless it has a
    /// natural curvature, which comes on top.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`] for an array of another size; [`ShellError::NotFinite`].
    pub fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) -> Result<(), ShellError> {
        check_length("positions", self.vertex_count(), positions.len())?;
        check_finite("position", positions.iter().flatten(), 3)?;
        for sheet in &mut self.sheets {
            sheet.set_rest_angles(positions);
        }
        Ok(())
    }

    /// Sets the curvature (1/m) that every face has by itself, a symmetric tensor in the frame of its
    /// stretched rest triangle, positive for crests; returns the number of faces that are capped.
    ///
    /// The rest angle of every inner edge gains that of the piecewise linear surface with the mean curvature
    /// of its two faces; see [`crate::StarShape`] for what a star makes of it. A sheet with the same
    /// curvature everywhere in one direction is then without energy on a cylinder. Angles add to those of
    /// [`Self::set_rest_angles`]. The tensors stay when the rest metric changes, and the angles follow it.
    ///
    /// # Validity
    /// No edge has a natural angle above [`MAX_NATURAL_ANGLE`](crate::MAX_NATURAL_ANGLE): faces that ask for
    /// more bend less, and finer ones would bend as asked. A sheet under tension or on a foundation does not
    /// get to its natural curvature.
    ///
    /// # Errors
    /// [`ShellError::CurvatureOnHinges`], whose Poisson ratio would put the curvature of a plate wrong by a
    /// factor of two; [`ShellError::PairOfSheets`]; [`ShellError::LengthMismatch`] for an array of another
    /// size; [`ShellError::ParameterOutOfRange`] for a tensor that is not finite,
    /// [`ShellError::AsymmetricCurvature`]. The layer is then unchanged.
    pub fn set_natural_curvatures(
        &mut self,
        curvatures: &[Matrix2<f64>],
    ) -> Result<usize, ShellError> {
        match self.bending_model {
            BendingModel::Hinge => return Err(ShellError::CurvatureOnHinges),
            BendingModel::VertexCurvature => {}
        }
        self.check_single("a natural curvature")?;
        let sheet = &mut self.sheets[0];
        check_length("natural curvatures", sheet.faces().len(), curvatures.len())?;
        check_tensors("natural curvature", curvatures)?;
        for (face, curvature) in curvatures.iter().enumerate() {
            let (xy, yx) = (curvature.m12, curvature.m21);
            if (xy - yx).abs() > SYMMETRY_TOLERANCE * curvature.amax() {
                return Err(ShellError::AsymmetricCurvature { face, xy, yx });
            }
        }
        sheet.set_natural_curvatures(curvatures);
        Ok(sheet.capped_faces())
    }

    /// Number of faces that ask for a natural angle above [`MAX_NATURAL_ANGLE`](crate::MAX_NATURAL_ANGLE) at
    /// one of their edges, under the present rest metric, and bend less than they ask for; 0 in a
    /// [`crate::LayerPart`].
    pub fn capped_faces(&self) -> usize {
        self.lower().capped_faces()
    }
}

/// Refuses tensors that are not finite; one per face.
fn check_tensors(name: &'static str, tensors: &[Matrix2<f64>]) -> Result<(), ShellError> {
    let mut values = tensors.iter().flatten().enumerate();
    match values.find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((index, &value)) => Err(ShellError::ParameterOutOfRange {
            element: "face",
            index: index / 4,
            name,
            value,
            range: "finite",
        }),
    }
}
