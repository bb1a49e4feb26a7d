//! A sheet that lies on another one.

use nalgebra::Vector3;

use crate::parameters::check_length;
use crate::{FaceParameters, LayerParameters, LayerSpringParameters, ShellError};

/// A sheet above another one, vertex `i` above vertex `i`.
#[derive(Clone, Debug)]
pub struct UpperSheet {
    /// Positions at rest, m.
    pub rest_positions: Vec<Vector3<f64>>,
    /// Material per face; the springs in it are those that hold this sheet to the lower one, on a face
    /// with the mean tangential stiffness of its corners.
    pub parameters: LayerParameters,
    /// Mid-surface offset from the lower sheet along its normal (m), ≥ 0, one entry per vertex.
    pub offsets: Vec<f64>,
}

impl UpperSheet {
    pub(crate) fn check(&self, faces: usize, vertices: usize) -> Result<(), ShellError> {
        check_length("upper rest positions", vertices, self.rest_positions.len())?;
        check_length("mid-surface offsets", vertices, self.offsets.len())?;
        self.parameters.check(faces, vertices)?;
        let valid = |offset: &f64| *offset >= 0.0 && offset.is_finite();
        match self.offsets.iter().position(|offset| !valid(offset)) {
            None => Ok(()),
            Some(index) => Err(ShellError::ParameterOutOfRange {
                element: "vertex",
                index,
                name: "mid-surface offset",
                value: self.offsets[index],
                range: ">= 0",
            }),
        }
    }

    pub(crate) fn springs(&self, faces: &[[u32; 3]]) -> Vec<LayerSpringParameters> {
        let tangential = &self.parameters.tangential_stiffness;
        let pairs = faces.iter().zip(&self.parameters.faces);
        let springs = |(corners, face): (&[u32; 3], &FaceParameters)| LayerSpringParameters {
            normal_stiffness: face.normal_stiffness,
            gradient_stiffness: face.gradient_stiffness,
            // A layer's tangential springs belong to vertices, those between two sheets to faces,
            // whose normal they turn with.
            tangential_stiffness: corners.iter().map(|&v| tangential[v as usize]).sum::<f64>()
                / 3.0,
        };
        pairs.map(springs).collect()
    }
}
