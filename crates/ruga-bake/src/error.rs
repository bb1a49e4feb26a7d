//! Errors of a bake: what a caller can get wrong.

use thiserror::Error;

/// Reason why nothing could be baked. Every variant names the offending element.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BakeError {
    /// A coordinate is NaN or infinite.
    #[error("{array}[{index}] is not finite")]
    NotFinite {
        /// Name of the input array.
        array: &'static str,
        /// Index of the element in it.
        index: usize,
    },
    /// Two arrays that describe the same elements differ in length.
    #[error("{array} has {found} elements, expected {expected}")]
    LengthMismatch {
        /// Name of the input array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// An index points past the end of the array it refers to.
    #[error("{array}[{index}] refers to {value}, but there are only {count}")]
    IndexOutOfRange {
        /// Name of the array that holds the index.
        array: &'static str,
        /// Position of the index in it.
        index: usize,
        /// The index itself.
        value: u32,
        /// Number of elements that it may refer to.
        count: usize,
    },
    /// A normal that must be of unit length is not.
    #[error("{array}[{index}] has length {length}, expected a unit normal")]
    NotUnit {
        /// Name of the input array.
        array: &'static str,
        /// Index of the normal in it.
        index: usize,
        /// Its length.
        length: f64,
    },
    /// MikkTSpace gave up, with its own message.
    #[error("no tangent space: {0}")]
    TangentSpace(String),
    /// The map's side is zero or larger than [`crate::MAX_SIZE`].
    #[error("map size {0} is outside 1..=16384")]
    Size(u32),
    /// Supersampling other than 1, 2 or 4.
    #[error("supersample {0} is not 1, 2 or 4")]
    Supersample(u32),
    /// The range of a height encoding is not a positive length.
    #[error("height range {0} m is not positive and finite")]
    HeightRange(f64),
}

/// Fails on the first element of `array` that is not finite.
pub(crate) fn all_finite<T>(
    array: &'static str,
    elements: &[T],
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), BakeError> {
    match elements.iter().position(|element| !is_finite(element)) {
        Some(index) => Err(BakeError::NotFinite { array, index }),
        None => Ok(()),
    }
}

/// Fails unless `found == expected`.
pub(crate) fn same_length(
    array: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), BakeError> {
    if found == expected {
        Ok(())
    } else {
        Err(BakeError::LengthMismatch {
            array,
            found,
            expected,
        })
    }
}

/// Fails on the first triangle that refers to a vertex at or past `count`.
pub(crate) fn all_in_range(
    array: &'static str,
    triangles: &[[u32; 3]],
    count: usize,
) -> Result<(), BakeError> {
    for (index, triangle) in triangles.iter().enumerate() {
        if let Some(&value) = triangle.iter().find(|&&v| v as usize >= count) {
            return Err(BakeError::IndexOutOfRange {
                array,
                index,
                value,
                count,
            });
        }
    }
    Ok(())
}
