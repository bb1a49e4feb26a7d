//! A sheet that lies on another one.

use nalgebra::Vector3;

use crate::parameters::check_length;
use crate::{FaceParameters, LayerParameters, ShellError, TieParameters};

/// A sheet above another one, vertex `i` above vertex `i`.
#[derive(Clone, Debug)]
pub struct UpperSheet {
    /// Positions at rest, m.
    pub rest_positions: Vec<Vector3<f64>>,
    /// Material per face; the springs in it are those that hold this sheet to the lower one, on a face
    /// with the mean tangential stiffness of its corners.
    pub parameters: LayerParameters,
    /// Distance of the mid-surfaces along the lower one's normal, per vertex, m.
    pub levers: Vec<f64>,
}

impl UpperSheet {
    pub(crate) fn check(&self, faces: usize, vertices: usize) -> Result<(), ShellError> {
        check_length("upper rest positions", vertices, self.rest_positions.len())?;
        check_length("levers", vertices, self.levers.len())?;
        self.parameters.check(faces, vertices)?;
        let valid = |lever: &f64| *lever >= 0.0 && lever.is_finite();
        match self.levers.iter().position(|lever| !valid(lever)) {
            None => Ok(()),
            Some(index) => Err(ShellError::ParameterOutOfRange {
                element: "vertex",
                index,
                name: "lever",
                value: self.levers[index],
                range: ">= 0",
            }),
        }
    }

    pub(crate) fn ties(&self, faces: &[[u32; 3]]) -> Vec<TieParameters> {
        let tangential = &self.parameters.tangential_stiffness;
        let pairs = faces.iter().zip(&self.parameters.faces);
        let tie = |(corners, face): (&[u32; 3], &FaceParameters)| TieParameters {
            normal_stiffness: face.normal_stiffness,
            gradient_stiffness: face.gradient_stiffness,
            // A layer's tie belongs to vertices, that of two sheets to faces, whose normal it turns
            // with.
            tangential_stiffness: corners.iter().map(|&v| tangential[v as usize]).sum::<f64>()
                / 3.0,
        };
        pairs.map(tie).collect()
    }
}
