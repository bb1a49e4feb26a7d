//! Errors of materials, property maps and stacks.

/// Largest relative spread of a variation.
pub(crate) const MAX_SPREAD: f64 = 0.5;

/// Reason why a layer on a substrate has no wavelength.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// A modulus, length or density is negative, zero, infinite or NaN.
    #[error("{parameter} is {value}, but must be a finite number above 0")]
    NotPositive {
        /// Name of the parameter with its unit, for instance `layer thickness (m)`.
        parameter: &'static str,
        /// The value found.
        value: f64,
    },
    /// A Poisson ratio for which no stable, compressible solid exists.
    #[error("{parameter} is {value}, but must lie strictly between -1 and 0.5")]
    PoissonOutOfRange {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value found.
        value: f64,
    },
    /// A parameter outside its range.
    #[error("{parameter} is {value}, but must be {range}")]
    OutOfRange {
        /// Name of the parameter with its unit, if it has one.
        parameter: &'static str,
        /// The value found.
        value: f64,
        /// What is accepted.
        range: &'static str,
    },
    /// A laminate without plies.
    #[error("the laminate has no plies, but must have at least one")]
    NoPlies,
    /// Stretches for another number of plies than there are.
    #[error("the laminate has {plies} plies, but there are stretches of {found}")]
    StretchCount {
        /// Number of plies.
        plies: usize,
        /// Stretches given.
        found: usize,
    },
    /// A target strain that no compression can have.
    #[error("critical strain is {value}, but must lie strictly between 0 and 1")]
    StrainOutOfRange {
        /// The value found.
        value: f64,
    },
    /// An unevenness that no skin has.
    #[error(
        "the variation's relative spread is {value}, but must lie between 0 and {}",
        MAX_SPREAD
    )]
    SpreadOutOfRange {
        /// The value found.
        value: f64,
    },
    /// Each parameter is acceptable, but together they leave the range of floating-point numbers.
    #[error(
        "the parameters are too far apart: {quantity} comes out as {value}; \
         check the units (all are SI: Pa, m, kg/m³)"
    )]
    Overflow {
        /// The first quantity that has no such value.
        quantity: &'static str,
        /// Value that was computed for it.
        value: f64,
    },
    /// A painted image has no texels.
    #[error("the {property} image is {width} x {height}, but must have at least one texel")]
    EmptyImage {
        /// Name of the painted property.
        property: &'static str,
        /// Texels per row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The values of a painted image do not fill its sides.
    #[error("the {property} image holds {found} values, but its sides ask for {expected}")]
    ImageLength {
        /// Name of the painted property.
        property: &'static str,
        /// Values given.
        found: usize,
        /// Values that width, height and channels ask for.
        expected: usize,
    },
    /// A painted value lies outside what the range is laid over.
    #[error(
        "the {property} image has {value} at column {column}, row {row}, \
         but must hold numbers from 0 to 1"
    )]
    TexelOutOfRange {
        /// Name of the painted property.
        property: &'static str,
        /// Column from the left, from 0.
        column: usize,
        /// Row from the top, from 0.
        row: usize,
        /// The value found.
        value: f32,
    },
    /// Black or white would make a property zero or negative.
    #[error("the {property} range is [{low}, {high}], but both ends must be finite and above 0")]
    RangeNotPositive {
        /// Name of the painted property.
        property: &'static str,
        /// Value that black stands for.
        low: f64,
        /// Value that white stands for.
        high: f64,
    },
    /// A jump that would be everywhere or nowhere.
    #[error("the ratio that counts as a sharp jump is {value}, but must be finite and above 1")]
    JumpRatio {
        /// The value found.
        value: f64,
    },
    /// Two layers together show the upper one's fine wave alone.
    #[error(
        "the stack has no large wave to replace it by: its lower layer wrinkles at {lower}, the \
         upper one already at {upper}; let each layer keep its own wavelength instead"
    )]
    NoJointWave {
        /// Critical strain of the lower layer alone.
        lower: f64,
        /// Critical strain of the upper layer alone.
        upper: f64,
    },
    /// The springs under a composite layer would push it off its base.
    #[error(
        "the stack cannot be replaced by one composite layer: its gradient spring is \
         {gradient_stiffness} N/m, but must lie between -{bound} and {bound}; \
         let each layer keep its own wavelength instead"
    )]
    CompositeUnstable {
        /// `K1'` (N/m).
        gradient_stiffness: f64,
        /// `2 √(D' K0')` (N/m).
        bound: f64,
    },
}

/// Accepts a finite positive `value`.
pub(crate) fn require_positive(parameter: &'static str, value: f64) -> Result<(), MaterialError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(MaterialError::NotPositive { parameter, value })
    }
}

/// Accepts a computed quantity that may have either sign, or none.
pub(crate) fn require_finite(quantity: &'static str, value: f64) -> Result<(), MaterialError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(MaterialError::Overflow { quantity, value })
    }
}

/// Accepts a Poisson ratio strictly inside `(-1, 0.5)`.
pub(crate) fn require_poisson(parameter: &'static str, value: f64) -> Result<(), MaterialError> {
    if value > -1.0 && value < 0.5 {
        Ok(())
    } else {
        Err(MaterialError::PoissonOutOfRange { parameter, value })
    }
}

/// Accepts a computed quantity that neither overflowed nor lost digits to underflow.
pub(crate) fn require_representable(
    quantity: &'static str,
    value: f64,
) -> Result<(), MaterialError> {
    if value.is_normal() && value > 0.0 {
        Ok(())
    } else {
        Err(MaterialError::Overflow { quantity, value })
    }
}
