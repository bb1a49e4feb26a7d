//! Plies that are bonded to each other and would each like another length.

use crate::MaterialError;
use crate::error::{require_finite, require_positive, require_representable};

/// One ply of a laminate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ply {
    /// Plane-stress modulus (Pa), above 0: Young's modulus `E` for a strip, `E/(1 - ν²)` for a sheet. The
    /// natural shape depends on the ratios between plies alone.
    pub modulus: f64,
    /// Natural strain: the change of length, over the length now, at which the ply alone has no stress;
    /// above -1.
    pub natural_strain: f64,
    /// Thickness (m), above 0.
    pub thickness: f64,
}

/// Natural shape and stiffness of plies that are bonded to each other.
///
/// ```text
/// A = sum E t        z_n = sum E t z/A           z: middle of a ply, over the lowest face
/// g = sum E t g_i/A                              strain of the neutral surface
/// D = sum E t (t^2/12 + (z - z_n)^2)
/// k = sum E t (z - z_n) (g_i - g)/D              curvature
/// ```
///
/// The same strain and curvature hold in both directions of an isotropic laminate. The energy that no
/// shape can release is a constant and left out. For two plies `k` is Timoshenko's bimetal formula (1925):
/// `1.5 dg/h` for equal halves of a sheet `h` thick. A strain that is linear through the thickness makes
/// `dg/h`, see [`linear_profile_curvature`].
///
/// # Validity
/// Strains of a few per cent: scale the rest shape by the mean length first, and take what is left of
/// lengths and thicknesses as plies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laminate {
    /// Stretching stiffness `A` (N/m).
    pub stretching_stiffness: f64,
    /// Bending stiffness `D` about the neutral surface (N m).
    pub bending_stiffness: f64,
    /// Height of the neutral surface over the lowest face (m).
    pub neutral_height: f64,
    /// Strain of the neutral surface without load.
    pub natural_strain: f64,
    /// Curvature without load (1/m), positive for a crest: where upper plies are the longer ones.
    pub natural_curvature: f64,
}

impl Laminate {
    /// The laminate of these plies, from the lowest one up.
    ///
    /// # Errors
    /// [`MaterialError::NoPlies`]; [`MaterialError::NotPositive`] for a modulus or thickness;
    /// [`MaterialError::OutOfRange`] for a strain; [`MaterialError::Overflow`] when a stiffness leaves the
    /// range of floating-point numbers.
    pub fn new(plies: &[Ply]) -> Result<Self, MaterialError> {
        plies.iter().try_for_each(Ply::validate)?;
        if plies.is_empty() {
            return Err(MaterialError::NoPlies);
        }
        let weighted = |value: &dyn Fn(&Ply, f64) -> f64| -> f64 {
            let plies = plies.iter().zip(weighted_middles(plies));
            plies
                .map(|(ply, (stiffness, middle))| stiffness * value(ply, middle))
                .sum()
        };
        let stretching_stiffness = weighted(&|_, _| 1.0);
        require_representable("the stretching stiffness (N/m)", stretching_stiffness)?;
        let neutral_height = weighted(&|_, middle| middle) / stretching_stiffness;
        let natural_strain = weighted(&|ply, _| ply.natural_strain) / stretching_stiffness;
        // About the neutral surface and the mean strain. Moments about another height are the same on
        // paper, but differences of large numbers.
        let bending_stiffness = weighted(&|ply, middle| {
            ply.thickness * ply.thickness / 12.0 + (middle - neutral_height).powi(2)
        });
        require_representable("the bending stiffness (N m)", bending_stiffness)?;
        let moment = weighted(&|ply, middle| {
            (middle - neutral_height) * (ply.natural_strain - natural_strain)
        });
        let natural_curvature = moment / bending_stiffness;
        require_finite("the natural curvature (1/m)", natural_curvature)?;
        Ok(Self {
            stretching_stiffness,
            bending_stiffness,
            neutral_height,
            natural_strain,
            natural_curvature,
        })
    }
}

/// Stretching stiffness of every ply (N/m) and height of its middle over the lowest face (m).
pub(crate) fn weighted_middles(plies: &[Ply]) -> impl Iterator<Item = (f64, f64)> + '_ {
    let mut top = 0.0;
    plies.iter().map(move |ply| {
        let middle = top + 0.5 * ply.thickness;
        top += ply.thickness;
        (ply.modulus * ply.thickness, middle)
    })
}

impl Ply {
    fn validate(&self) -> Result<(), MaterialError> {
        require_positive("ply modulus (Pa)", self.modulus)?;
        require_positive("ply thickness (m)", self.thickness)?;
        match self.natural_strain > -1.0 && self.natural_strain.is_finite() {
            true => Ok(()),
            false => Err(MaterialError::OutOfRange {
                parameter: "ply natural strain",
                value: self.natural_strain,
                range: "a finite number above -1",
            }),
        }
    }
}

/// Natural curvature (1/m, crest-positive) of a uniform sheet whose natural strain is linear from its lower
/// to its upper face, `(g_upper - g_lower)/h`.
///
/// `faces` are the strains at the lower and the upper face, over the length of the middle. Means over the
/// two halves of a sheet differ by half of what its faces do: their profile has the curvature
/// `2 (g_upper - g_lower)/h`. Taken for two plies they would make three quarters of it, because the plies'
/// `1.5` belongs to a jump at the middle.
pub fn linear_profile_curvature([lower, upper]: [f64; 2], thickness: f64) -> f64 {
    (upper - lower) / thickness
}
