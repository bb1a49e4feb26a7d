//! What burning or drying makes of the rest shape and stiffness of a sheet.

use nalgebra::{Matrix2, Vector2};

use crate::MaterialError;
use crate::error::require_positive;
use crate::laminate::linear_profile_curvature;

/// Largest share of its length that a sheet may lose. Beyond it char is no sheet any more.
const MAX_SHRINK: f64 = 0.6;

/// Largest share of its length that the face which shrinks more may lose.
const MAX_FACE_SHRINK: f64 = 0.9;

/// How a sheet's lengths, stiffness and natural curvature follow the fuel that is left in it.
///
/// With `Y` the fuel share, 1 when fresh and 0 when burnt out, and everything linear in it:
///
/// ```text
/// lambda = 1 - shrink (1 - Y)                      length of the middle surface, along and across
/// lambda = 1 - shrink (1 +- d/2) (1 - Y)           length of the upper and the lower face
/// E      = E_0 (1 - (1 - char_young) (1 - Y))      h likewise
/// k      = (g_u - g_l)/h,   g = lambda_face/lambda - 1
/// ```
///
/// The rest shape is first scaled by the mean length, and strains count from there, on the thickness that
/// is left: a strip whose fibres have lengths linear through the thickness is then without stress at `k`,
/// however much it has shrunk. That profile is what makes `dg/h`; the `1.5 dg/h` of [`crate::Laminate`] is
/// for two uniform halves.
///
/// # Validity
/// Curvature is far stronger than shrinkage: 1 % between the faces of 0.1 mm paper is a radius of 10 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShrinkLaw {
    /// Share of its length along the grain that burnt-out material has lost, 0 to 0.6. Char of paper and
    /// wood loses some 0.2 to 0.4 (nominal).
    pub along: f64,
    /// Share of its length across the grain that burnt-out material has lost, 0 to 0.6.
    pub across: f64,
    /// Difference `d` of the shrinkage of upper and lower face over their mean, -2 to 2; the face that
    /// shrinks more keeps a tenth of its length. Positive where the upper face shrinks more, so that the
    /// sheet curls towards it: the natural curvature is negative.
    pub asymmetry: f64,
    /// Young's modulus of burnt-out material over that of fresh one, above 0.
    pub char_young: f64,
    /// Thickness of burnt-out material over that of fresh one, above 0.
    pub char_thickness: f64,
}

/// Stiffness of the sheet before it burns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreshSheet {
    /// Young's modulus (Pa), above 0.
    pub young: f64,
    /// Thickness (m), above 0.
    pub thickness: f64,
}

/// Rest shape and stiffness of a sheet that has shrunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShrunkSheet {
    /// Length of the middle surface over that of the fresh one, along and across the grain.
    pub lengths: [f64; 2],
    /// Natural curvature (1/m), crest-positive, along and across the grain.
    pub curvatures: [f64; 2],
    /// Young's modulus (Pa).
    pub young: f64,
    /// Thickness (m).
    pub thickness: f64,
}

impl ShrinkLaw {
    /// Accepts the law if every parameter is in its range.
    ///
    /// # Errors
    /// [`MaterialError::OutOfRange`] or [`MaterialError::NotPositive`], for the first parameter in the
    /// order of the fields.
    pub fn validate(&self) -> Result<(), MaterialError> {
        require_shrink("shrinkage along the grain", self.along)?;
        require_shrink("shrinkage across the grain", self.across)?;
        require_range(
            ("asymmetry of shrinkage", self.asymmetry),
            [-2.0, 2.0],
            "between -2 and 2",
        )?;
        let largest = self.along.max(self.across) * (1.0 + 0.5 * self.asymmetry.abs());
        require_range(
            ("shrinkage of the face that shrinks more", largest),
            [0.0, MAX_FACE_SHRINK],
            "between 0 and 0.9: lower the asymmetry or the shrinkage",
        )?;
        require_positive("char Young's modulus share", self.char_young)?;
        require_positive("char thickness share", self.char_thickness)
    }

    /// The sheet with a share `fuel` of its fuel left, 0 to 1.
    ///
    /// # Errors
    /// Those of [`Self::validate`]; [`MaterialError::OutOfRange`] for the fuel;
    /// [`MaterialError::NotPositive`] for the fresh sheet.
    pub fn shrunk(&self, fresh: &FreshSheet, fuel: f64) -> Result<ShrunkSheet, MaterialError> {
        self.validate()?;
        require_range(("fuel share", fuel), [0.0, 1.0], "between 0 and 1")?;
        require_positive("fresh Young's modulus (Pa)", fresh.young)?;
        require_positive("fresh thickness (m)", fresh.thickness)?;
        let burnt = 1.0 - fuel;
        let follow = |fresh: f64, share: f64| fresh * (1.0 + (share - 1.0) * burnt);
        let thickness = follow(fresh.thickness, self.char_thickness);
        let lengths = [self.along, self.across].map(|shrink| 1.0 - shrink * burnt);
        let curvatures = [0, 1].map(|axis| {
            // Lengths of the faces less that of the middle. Differences of the lengths themselves would
            // lose the digits of a small asymmetry.
            let uneven = 0.5 * self.asymmetry * (1.0 - lengths[axis]) / lengths[axis];
            linear_profile_curvature([uneven, -uneven], thickness)
        });
        Ok(ShrunkSheet {
            lengths,
            curvatures,
            young: follow(fresh.young, self.char_young),
            thickness,
        })
    }
}

impl ShrunkSheet {
    /// Stretch of a rest triangle whose frame has the `grain` in this unit direction.
    pub fn stretch(&self, grain: Vector2<f64>) -> Matrix2<f64> {
        in_frame(self.lengths, grain)
    }

    /// Natural curvature (1/m) in the frame in which the `grain` has this unit direction.
    pub fn curvature(&self, grain: Vector2<f64>) -> Matrix2<f64> {
        in_frame(self.curvatures, grain)
    }
}

/// The tensor with these principal values along and across a unit direction.
fn in_frame([along, across]: [f64; 2], direction: Vector2<f64>) -> Matrix2<f64> {
    let normal = Vector2::new(-direction.y, direction.x);
    along * direction * direction.transpose() + across * normal * normal.transpose()
}

fn require_shrink(parameter: &'static str, value: f64) -> Result<(), MaterialError> {
    require_range((parameter, value), [0.0, MAX_SHRINK], "between 0 and 0.6")
}

fn require_range(
    (parameter, value): (&'static str, f64),
    [low, high]: [f64; 2],
    range: &'static str,
) -> Result<(), MaterialError> {
    // NaN lies between no two numbers.
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(MaterialError::OutOfRange {
            parameter,
            value,
            range,
        })
    }
}
