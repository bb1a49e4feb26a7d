//! Material and springs of a layer, face by face.

use crate::ShellError;

/// Least share of a face's area that may be left of it. A face with less leaves the mesh: it holds nothing,
/// and its stiffness would spoil the factorisation.
pub const MIN_AREA_LEFT: f64 = 0.02;

/// Material and normal coupling of one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceParameters {
    /// Young's modulus (Pa), > 0.
    pub young: f64,
    /// Poisson ratio, in (-1, 0.5].
    pub poisson: f64,
    /// Thickness (m), > 0.
    pub thickness: f64,
    /// Foundation stiffness `K0` (N/m³), ≥ 0; `D k_c^4` for a wavelength `2 pi/k_c`.
    pub normal_stiffness: f64,
    /// Foundation stiffness `K1` on the gradient of the deviation (N/m), any sign;
    /// `N_c - 2 D k_c^2` for a critical force `N_c`.
    pub gradient_stiffness: f64,
}

impl FaceParameters {
    /// `C = E h/(1 - nu^2)` (N/m).
    pub fn tension_modulus(&self) -> f64 {
        self.young * self.thickness / (1.0 - self.poisson * self.poisson)
    }

    /// `D = E h^3/(12 (1 - nu^2))` (N m).
    pub fn bending_modulus(&self) -> f64 {
        self.tension_modulus() * self.thickness * self.thickness / 12.0
    }

    pub(crate) fn check(&self, face: usize) -> Result<(), ShellError> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        let (tension, bending) = (self.tension_modulus(), self.bending_modulus());
        let checks = [
            ("young", self.young, positive(self.young), "> 0"),
            (
                "poisson",
                self.poisson,
                // Plane stress stays finite for an incompressible material: one half is allowed.
                self.poisson > -1.0 && self.poisson <= 0.5,
                "-1 < nu <= 0.5",
            ),
            ("thickness", self.thickness, positive(self.thickness), "> 0"),
            (
                "normal_stiffness",
                self.normal_stiffness,
                self.normal_stiffness >= 0.0 && self.normal_stiffness.is_finite(),
                ">= 0",
            ),
            (
                // On a thin incompressible foundation a layer wrinkles at 1.5 D k_c^2, which makes
                // K1 negative.
                "gradient_stiffness",
                self.gradient_stiffness,
                self.gradient_stiffness.is_finite(),
                "finite",
            ),
            // Each may be in its range and their product out of that of floating-point numbers.
            ("E h/(1 - nu^2)", tension, positive(tension), "> 0, finite"),
            (
                "E h^3/12(1 - nu^2)",
                bending,
                positive(bending),
                "> 0, finite",
            ),
        ];
        match checks.into_iter().find(|(_, _, valid, _)| !valid) {
            None => Ok(()),
            Some((name, value, _, range)) => Err(ShellError::ParameterOutOfRange {
                element: "face",
                index: face,
                name,
                value,
                range,
            }),
        }
    }
}

/// Parameters of a whole layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerParameters {
    /// One entry per face.
    pub faces: Vec<FaceParameters>,
    /// Stiffness `Kt` of the tangential springs (N/m³), ≥ 0, one entry per vertex; `2 K0`, at most
    /// `0.12 C k_c^2`.
    pub tangential_stiffness: Vec<f64>,
}

impl LayerParameters {
    /// Parameters with one material and coupling everywhere.
    pub fn uniform(
        face: FaceParameters,
        faces: usize,
        tangential_stiffness: f64,
        vertices: usize,
    ) -> Self {
        Self {
            faces: vec![face; faces],
            tangential_stiffness: vec![tangential_stiffness; vertices],
        }
    }

    pub(crate) fn check(&self, faces: usize, vertices: usize) -> Result<(), ShellError> {
        check_length("parameters.faces", faces, self.faces.len())?;
        let name = "parameters.tangential_stiffness";
        check_length(name, vertices, self.tangential_stiffness.len())?;
        for (index, face) in self.faces.iter().enumerate() {
            face.check(index)?;
        }
        for (index, &value) in self.tangential_stiffness.iter().enumerate() {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(ShellError::ParameterOutOfRange {
                    element: "vertex",
                    index,
                    name: "tangential_stiffness",
                    value,
                    range: ">= 0",
                });
            }
        }
        Ok(())
    }
}

/// Accepts finite numbers, `per_vertex` of them for each vertex.
pub(crate) fn check_finite<'a>(
    what: &'static str,
    mut values: impl Iterator<Item = &'a f64>,
    per_vertex: usize,
) -> Result<(), ShellError> {
    match values.position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ShellError::NotFinite {
            what,
            vertex: index / per_vertex,
        }),
    }
}

pub(crate) fn check_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), ShellError> {
    if expected == found {
        Ok(())
    } else {
        Err(ShellError::LengthMismatch {
            what,
            expected,
            found,
        })
    }
}
