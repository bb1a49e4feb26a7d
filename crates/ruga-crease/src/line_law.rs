//! How soft and how folded a crease is along its line and in a pose.

use crate::CreaseError;

/// Properties of a crease, and how they fade towards its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLaw {
    /// Width of the strip that the crease stands for (m), > 0.
    pub width: f64,
    /// Share of the bending stiffness left on the line, in [1e-6, 1].
    pub stiffness: f64,
    /// Fold angle towards which the crease is drawn at full strength (rad), in [0, 150°].
    pub angle: f64,
    /// Lengths over which the crease fades in from its start and out to its end (m), ≥ 0.
    pub fade: [f64; 2],
}

/// Input that the strength of a crease follows.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Drive {
    /// The load: none at rest, so that the face at rest stays as it is.
    #[default]
    Load,
    /// Nothing: the crease is there at rest, too.
    Always,
    /// A weighted sum of blend-shape weights: number of the shape and factor.
    Weights(Vec<(usize, f64)>),
}

/// Largest angle of a crease at rest (rad): a fold that is drawn further shuts.
pub const LARGEST_ANGLE: f64 = 150.0 * std::f64::consts::PI / 180.0;

impl LineLaw {
    /// Checks all values.
    ///
    /// # Errors
    /// [`CreaseError::OutOfRange`] for the first that is not in its range.
    pub fn check(&self) -> Result<(), CreaseError> {
        let Self {
            width,
            stiffness,
            angle,
            fade: [start, end],
        } = *self;
        let is_length = |v: f64| v >= 0.0 && v.is_finite();
        let positive = width > 0.0 && width.is_finite();
        let share = (1e-6..=1.0).contains(&stiffness);
        let angles = (0.0..=LARGEST_ANGLE).contains(&angle);
        let checks = [
            ("width", width, positive, "> 0 m"),
            ("stiffness", stiffness, share, "1e-6 to 1"),
            ("angle", angle, angles, "0 to 2.618 rad (150 degrees)"),
            ("fade at the start", start, is_length(start), ">= 0 m"),
            ("fade at the end", end, is_length(end), ">= 0 m"),
        ];
        match checks.into_iter().find(|(_, _, valid, _)| !valid) {
            None => Ok(()),
            Some((name, value, _, range)) => Err(CreaseError::OutOfRange { name, value, range }),
        }
    }

    /// Strength at an arc length (m) along a line of a length (m): 1 but near the ends, where it falls to 0 as a
    /// smooth step. A closed line has no ends.
    pub fn taper(&self, at: f64, length: f64, is_closed: bool) -> f64 {
        if is_closed {
            return 1.0;
        }
        let step = |distance: f64, fade: f64| {
            let share = if fade > 0.0 { distance / fade } else { 1.0 };
            let share = share.clamp(0.0, 1.0);
            share * share * (3.0 - 2.0 * share)
        };
        step(at, self.fade[0]).min(step(length - at, self.fade[1]))
    }

    /// Compliance times bending modulus, `w (1/f - 1)`, at a strength (m); fades with it, because what is left of
    /// a crease at its tip is not allowed to fold.
    pub fn softness(&self, strength: f64) -> f64 {
        strength * self.width * (1.0 / self.stiffness - 1.0)
    }

    /// Rest angle at a strength (rad).
    pub fn rest_angle(&self, strength: f64) -> f64 {
        strength * self.angle
    }
}

impl Drive {
    /// Strength in a pose, 0 to 1, at a load of 0 to 1 and with these weights of the blend shapes. Shapes that
    /// are not there weigh nothing.
    pub fn strength(&self, load: f64, weights: &[f64]) -> f64 {
        let strength = match self {
            Self::Load => load,
            Self::Always => 1.0,
            Self::Weights(terms) => {
                let term = |&(shape, factor): &(usize, f64)| {
                    weights.get(shape).map_or(0.0, |weight| factor * weight)
                };
                terms.iter().map(term).sum()
            }
        };
        // What is no number is no strength.
        strength.clamp(0.0, 1.0).max(0.0)
    }
}
