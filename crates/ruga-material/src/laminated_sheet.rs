//! Sheets of bonded plies that grow each in its own way and direction.

use nalgebra::Matrix2;

use crate::error::{require_poisson, require_positive};
use crate::laminate::weighted_middles;
use crate::{Laminate, LayerMaterial, MaterialError, Ply};

/// One ply of a [`LaminatedSheet`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetPly {
    /// Young's modulus (Pa), above 0.
    pub young: f64,
    /// Thickness (m), above 0.
    pub thickness: f64,
    /// Mass per volume (kg/m³), above 0.
    pub density: f64,
}

/// A sheet of plies that are bonded to each other and have one Poisson ratio `nu`.
///
/// Without growth it stretches, bends and weighs like an even layer, which is its [`Self::material`]. With `A` and
/// `D` of a [`Laminate`] of moduli `E_i`:
///
/// ```text
/// h = sqrt(12 D/A)      E = A/h      rho = sum rho_i t_i/h
/// ```
///
/// Plies whose lengths at rest have become `L_i` times what they were, a symmetric tensor each, give it the
/// [`NaturalShape`]
///
/// ```text
/// S = sum E_i t_i L_i/A                          stretch, the mean one
/// g_i = (S^-1 L_i + L_i S^-1)/2 - 1              strain of a ply that is left
/// K = sum E_i t_i (z_i - z_n) g_i/D              curvature
/// ```
///
/// With one Poisson ratio all plies weigh the components of strain alike, so that the sums of [`Laminate`] hold for
/// each component. `g_i` is the Green strain between the metrics `S S` and `L_i L_i` in the stretched sheet, to first
/// order in their difference; of stretches along the same axes it is `L_i/S - 1`.
///
/// # Validity
/// Strains between plies of some per cent, whatever the mean.
#[derive(Clone, Debug, PartialEq)]
pub struct LaminatedSheet {
    material: LayerMaterial,
    thickness: f64,
    /// Per ply, from the lowest one up: `E_i t_i/A`, and `E_i t_i (z_i - z_n)/D` (1/m).
    weights: Vec<[f64; 2]>,
}

/// Rest shape of a sheet whose plies have grown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NaturalShape {
    /// Stretch of the neutral surface, symmetric.
    pub stretch: Matrix2<f64>,
    /// Curvature (1/m), symmetric, positive for a crest: where upper plies are the longer ones.
    pub curvature: Matrix2<f64>,
}

impl LaminatedSheet {
    /// The sheet of these plies, from the lowest one up.
    ///
    /// # Errors
    /// [`MaterialError::NoPlies`]; [`MaterialError::NotPositive`] for a number of a ply;
    /// [`MaterialError::PoissonOutOfRange`]; [`MaterialError::Overflow`] when a stiffness leaves the range of
    /// floating-point numbers.
    pub fn new(plies: &[SheetPly], poisson: f64) -> Result<Self, MaterialError> {
        require_poisson("layer Poisson ratio", poisson)?;
        for ply in plies {
            require_positive("ply density (kg/m³)", ply.density)?;
        }
        // The factor 1 - nu^2 of all plies cancels in the ratios.
        let elastic: Vec<Ply> = plies
            .iter()
            .map(|ply| Ply {
                modulus: ply.young,
                natural_strain: 0.0,
                thickness: ply.thickness,
            })
            .collect();
        let laminate = Laminate::new(&elastic)?;
        let (stretching, bending) = (laminate.stretching_stiffness, laminate.bending_stiffness);
        let thickness = (12.0 * (bending / stretching)).sqrt();
        let mass: f64 = plies.iter().map(|ply| ply.density * ply.thickness).sum();
        let material = LayerMaterial {
            young: stretching / thickness,
            poisson,
            thickness,
            density: mass / thickness,
        };
        material.validate()?;
        let weights = weighted_middles(&elastic)
            .map(|(stiffness, middle)| {
                let arm = middle - laminate.neutral_height;
                [stiffness / stretching, stiffness * arm / bending]
            })
            .collect();
        Ok(Self {
            material,
            thickness: plies.iter().map(|ply| ply.thickness).sum(),
            weights,
        })
    }

    /// The even layer with its stretching and bending stiffness and its mass per area. Its thickness is that of the
    /// plies together only where they are alike.
    pub fn material(&self) -> &LayerMaterial {
        &self.material
    }

    /// Thickness of all plies together (m).
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Number of its plies.
    pub fn ply_count(&self) -> usize {
        self.weights.len()
    }

    /// The shape it has by itself where its plies, from the lowest one up, are stretched by these symmetric tensors.
    ///
    /// # Errors
    /// [`MaterialError::StretchCount`] for another number of them than of plies; [`MaterialError::OutOfRange`]
    /// where their mean leaves no area.
    pub fn natural_shape(&self, stretches: &[Matrix2<f64>]) -> Result<NaturalShape, MaterialError> {
        if stretches.len() != self.weights.len() {
            return Err(MaterialError::StretchCount {
                plies: self.weights.len(),
                found: stretches.len(),
            });
        }
        let pairs = || self.weights.iter().zip(stretches);
        let stretch: Matrix2<f64> = pairs().map(|([share, _], l)| l * *share).sum();
        let determinant = stretch.determinant();
        let inverse = stretch.try_inverse().filter(|_| determinant > 0.0);
        let inverse = inverse.ok_or(MaterialError::OutOfRange {
            parameter: "determinant of the mean stretch of the plies",
            value: determinant,
            range: "above 0",
        })?;
        // The levers add up to nothing, but for rounding, which then only counts for differences of the plies.
        let moments = pairs().map(|([_, lever], l)| (l - stretch) * *lever);
        let half = 0.5 * (inverse * moments.sum::<Matrix2<f64>>());
        Ok(NaturalShape {
            stretch,
            curvature: half + half.transpose(),
        })
    }
}
