//! What can be wrong with a material.

/// Why a layer on a substrate has no wavelength.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// A modulus, length or density is negative, zero, infinite or NaN.
    #[error("{parameter} is {value}, but must be a finite number above 0")]
    NotPositive {
        /// Which parameter, with its unit, for instance `layer thickness (m)`.
        parameter: &'static str,
        /// The value found.
        value: f64,
    },
    /// A Poisson ratio for which no stable, compressible solid exists.
    #[error("{parameter} is {value}, but must lie strictly between -1 and 0.5")]
    PoissonOutOfRange {
        /// Which parameter.
        parameter: &'static str,
        /// The value found.
        value: f64,
    },
    /// A target strain that no compression can have.
    #[error("critical strain is {value}, but must lie strictly between 0 and 1")]
    StrainOutOfRange {
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
        /// What was computed for it.
        value: f64,
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
