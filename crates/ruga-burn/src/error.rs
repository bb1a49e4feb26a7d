//! Reasons why a burning sheet is refused.

use thiserror::Error;

/// A mistake in the law of burning, in a field over the mesh or in the mesh itself.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BurnError {
    /// A number is not finite, or outside its range.
    #[error("{name} = {value}; accepted: {accepted}")]
    OutOfRange {
        /// What the number is.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range, with its unit.
        accepted: &'static str,
    },
    /// Burning does not reach the temperature at which the material ignites.
    #[error(
        "burning reaches {burning} K, which is not above ignition at {ignition} K: raise `burning` or lower `ignition`"
    )]
    BurningBelowIgnition {
        /// Temperature of what has burnt without losses (K).
        burning: f64,
        /// Temperature at which the material ignites (K).
        ignition: f64,
    },
    /// The material would burn by itself in its surroundings.
    #[error(
        "ignition at {ignition} K is not above the surroundings of {surroundings} K: everything would burn at once"
    )]
    IgnitionBelowSurroundings {
        /// Temperature at which the material ignites (K).
        ignition: f64,
        /// Temperature of the surroundings (K).
        surroundings: f64,
    },
    /// Heat is lost so fast that no front lives.
    #[error(
        "the front dies: heat is lost within {loss_time:.4} s; accepted: a loss time above {least:.4} s, or none"
    )]
    FrontDies {
        /// The loss time that was given (s).
        loss_time: f64,
        /// The least with which a front lives (s).
        least: f64,
    },
    /// A field has not one value per element.
    #[error("{field} has {values} values; accepted: {expected}, one for each element of the mesh")]
    FieldSize {
        /// The field.
        field: &'static str,
        /// Values given.
        values: usize,
        /// Values needed.
        expected: usize,
    },
    /// A value of a field is not finite, or outside its range.
    #[error("{field} is {value} at number {element}; accepted: {accepted}")]
    FieldOutOfRange {
        /// The field.
        field: &'static str,
        /// Number of the vertex, edge or face, from 0.
        element: usize,
        /// The value there.
        value: f64,
        /// The accepted range, with its unit.
        accepted: &'static str,
    },
    /// No vertex has fuel.
    #[error("there is no fuel: the fuel share is 0 at each vertex; accepted: above 0 somewhere")]
    NoFuel,
    /// A triangle has no area, or its edges are too unequal to be those of a triangle.
    #[error(
        "triangle {face} of the field mesh is degenerate: its edges are {:.3e}, {:.3e} and {:.3e} m long; merge its vertices or leave it out",
        edges[0], edges[1], edges[2]
    )]
    DegenerateFace {
        /// Number of the triangle.
        face: usize,
        /// Lengths of its edges (m).
        edges: [f64; 3],
    },
    /// A vertex belongs to no triangle, so that it has neither heat capacity nor neighbours.
    #[error("vertex {vertex} of the field mesh is in no triangle: leave it out")]
    LooseVertex {
        /// Number of the vertex.
        vertex: usize,
    },
    /// The mesh has no triangle.
    #[error("the field mesh has no triangle")]
    NoFaces,
    /// A time step is so long that the front would cross the mesh many times.
    #[error(
        "a time step of {time_step} s is divided into {substeps:.0} parts, more than {limit}: shorten it"
    )]
    TooManySubsteps {
        /// The time step (s).
        time_step: f64,
        /// Parts into which it would be divided.
        substeps: f64,
        /// Most that are accepted.
        limit: u32,
    },
    /// The heat equation cannot be solved in floating point.
    #[error(
        "the heat equation cannot be solved with a step of {substep} s: diffusivity, areas and step differ by too many orders of magnitude"
    )]
    Unsolvable {
        /// Step that the matrix was built for (s).
        substep: f64,
    },
}

/// Refuses a number that is not finite and positive.
pub(crate) fn check_positive(
    name: &'static str,
    value: f64,
    accepted: &'static str,
) -> Result<(), BurnError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(BurnError::OutOfRange {
        name,
        value,
        accepted,
    })
}

/// Refuses a field of the wrong size, or with a value for which `is_accepted` does not hold.
pub(crate) fn check_field(
    field: &'static str,
    values: &[f64],
    expected: usize,
    accepted: &'static str,
    is_accepted: impl Fn(f64) -> bool,
) -> Result<(), BurnError> {
    if values.len() != expected {
        return Err(BurnError::FieldSize {
            field,
            values: values.len(),
            expected,
        });
    }
    match values.iter().position(|&value| !is_accepted(value)) {
        None => Ok(()),
        Some(element) => Err(BurnError::FieldOutOfRange {
            field,
            element,
            value: values[element],
            accepted,
        }),
    }
}

/// Whether a temperature (K) is finite and not below zero kelvin.
pub(crate) fn is_temperature(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// What [`is_temperature`] accepts, for messages.
pub(crate) const TEMPERATURES: &str = "finite, at least 0 K";
