//! The sheet that a response modulus is asked of.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh};

use crate::parameters::check_length;
use crate::{BendingModel, ShellError};

/// A sheet on a foundation, compressed along one direction per face.
///
/// Shapes: `corners` and `directions` per face, `fixed` per vertex.
#[derive(Clone, Copy, Debug)]
pub struct ResponseQuery<'a> {
    /// The sheet.
    pub mesh: &'a TriMesh,
    /// Rest positions of each face's corners (m), from [`crate::face_corners`]. They are given per face so
    /// that a periodic cell can be described: unwrap the corners of the faces that cross its border.
    pub corners: &'a [[Vector3<f64>; 3]],
    /// Compression direction of each face, in space; only its part in the face counts.
    pub directions: &'a [Vector3<f64>],
    /// Vertices held at zero deviation.
    pub fixed: &'a [bool],
    /// Plate modulus `D` (N m) that the sheet is meant to have, > 0.
    pub bending_modulus: f64,
    /// Poisson ratio, in (-1, 1]; hinges do not know it.
    pub poisson: f64,
    /// Model of the bending energy.
    pub bending_model: BendingModel,
    /// Exponent of the per-hinge factor; [`crate::HINGE_EXPONENT`] is what a layer uses.
    pub hinge_exponent: f64,
    /// Foundation stiffness `K0` (N/m³), > 0; sets the wavelength `2 pi (D/K0)^(1/4)` probed.
    pub normal_stiffness: f64,
    /// Foundation stiffness `K1` (N/m).
    pub gradient_stiffness: f64,
}

impl ResponseQuery<'_> {
    pub(crate) fn check(&self) -> Result<(), ShellError> {
        let faces = self.mesh.face_count();
        check_length("fixed", self.mesh.vertex_count(), self.fixed.len())?;
        check_length("corners", faces, self.corners.len())?;
        check_length("directions", faces, self.directions.len())?;
        let is_finite = |p: &Vector3<f64>| p.iter().all(|c| c.is_finite());
        for (face, corners) in self.mesh.faces().as_slice().iter().zip(self.corners) {
            if let Some(corner) = corners.iter().position(|p| !is_finite(p)) {
                return Err(ShellError::NotFinite {
                    what: "rest position",
                    vertex: face[corner].index(),
                });
            }
        }
        let above = |value: f64, least: f64| value > least && value.is_finite();
        let (modulus, normal) = (self.bending_modulus, self.normal_stiffness);
        let (exponent, gradient) = (self.hinge_exponent, self.gradient_stiffness);
        // Wider than for a material: the plate's stiffnesses go with 1 + nu and 1 - nu, and neither
        // is negative in this range.
        let poisson = above(self.poisson, -1.0) && self.poisson <= 1.0;
        let checks = [
            ("bending_modulus", modulus, above(modulus, 0.0), "> 0"),
            ("normal_stiffness", normal, above(normal, 0.0), "> 0"),
            ("poisson", self.poisson, poisson, "-1 < nu <= 1"),
            ("hinge_exponent", exponent, exponent.is_finite(), "finite"),
            (
                "gradient_stiffness",
                gradient,
                gradient.is_finite(),
                "finite",
            ),
        ];
        match checks.into_iter().find(|(_, _, valid, _)| !valid) {
            None => Ok(()),
            Some((name, value, _, range)) => Err(ShellError::ParameterOutOfRange {
                element: "response query",
                index: 0,
                name,
                value,
                range,
            }),
        }
    }
}
