//! Errors of a system or a start point.

/// A mistake in the input of this crate, or a matrix that cannot be factorised.
///
/// Failing to converge is no error: see [`SolveReport`](crate::SolveReport).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolverError {
    /// A pattern without unknowns.
    #[error("the system has no unknowns")]
    Empty,
    /// Column or row starts do not begin at 0, decrease, or end elsewhere than at the number of entries.
    #[error("compressed starts are malformed at position {position}")]
    MalformedStarts {
        /// Index into the array of starts.
        position: usize,
    },
    /// A column of the lower triangle does not begin with its diagonal entry.
    #[error("column {column} of the pattern has no diagonal entry in first place")]
    MissingDiagonal {
        /// The column.
        column: usize,
    },
    /// Rows of a column (or columns of a row) are not strictly increasing.
    #[error("indices of line {line} are not strictly increasing")]
    Unsorted {
        /// Column of the pattern, or row of the constraints.
        line: usize,
    },
    /// An index beyond the matrix.
    #[error("line {line} holds the index {index}, but there are only {limit}")]
    IndexOutOfRange {
        /// Column of the pattern, or row of the constraints.
        line: usize,
        /// The offending index.
        index: usize,
        /// Number of unknowns.
        limit: usize,
    },
    /// The number of unknowns is no multiple of the block size.
    #[error("{unknowns} unknowns cannot be grouped in blocks of {block}")]
    BlockSize {
        /// Number of unknowns.
        unknowns: usize,
        /// The block size asked for.
        block: usize,
    },
    /// An array of the wrong length.
    #[error("{what} has {found} entries instead of {expected}")]
    SizeMismatch {
        /// Name of the array.
        what: &'static str,
        /// Length needed.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// The objective's pattern is not the one that was analysed.
    #[error("the objective's sparsity pattern is not the one of the factorisation")]
    PatternMismatch,
    /// A value that is NaN or infinite.
    #[error("{what} is not finite at index {index}")]
    NotFinite {
        /// Name of the array or quantity.
        what: &'static str,
        /// First offending index.
        index: usize,
    },
    /// A setting outside its range.
    #[error("{setting} = {value} is outside its range")]
    Setting {
        /// Name of the setting.
        setting: &'static str,
        /// The value given.
        value: f64,
    },
    /// The fill-reducing ordering failed.
    #[error("the ordering of the system failed: {reason}")]
    Ordering {
        /// Message of the ordering library.
        reason: String,
    },
    /// The symbolic analysis ran out of memory, or matrix or factor have more than 2³¹ - 1 entries (17 GB).
    #[error("the system of {size} unknowns and rows is too large to be solved")]
    TooLarge {
        /// Unknowns plus constraint rows.
        size: usize,
    },
    /// A pivot vanished exactly or overflowed; the matrix has no usable factor.
    #[error("the factorisation broke down at pivot {pivot}")]
    Breakdown {
        /// Position in the elimination order.
        pivot: usize,
    },
    /// [`Kkt::solve`](crate::Kkt::solve) before [`Kkt::factorize`](crate::Kkt::factorize).
    #[error("the system was not factorised before the solve")]
    NotFactorized,
}

pub(crate) fn check_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), SolverError> {
    if expected == found {
        return Ok(());
    }
    Err(SolverError::SizeMismatch {
        what,
        expected,
        found,
    })
}

pub(crate) fn check_finite(what: &'static str, values: &[f64]) -> Result<(), SolverError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(SolverError::NotFinite { what, index }),
    }
}

/// Refuses starts of compressed lines that do not rise from 0 to the number of entries.
pub(crate) fn check_starts(starts: &[usize], entries: usize) -> Result<(), SolverError> {
    let malformed = |position| Err(SolverError::MalformedStarts { position });
    if starts.first() != Some(&0) {
        return malformed(0);
    }
    if let Some(position) = starts.windows(2).position(|pair| pair[1] < pair[0]) {
        return malformed(position + 1);
    }
    if starts.last() != Some(&entries) {
        return malformed(starts.len() - 1);
    }
    Ok(())
}

/// Refuses indices of one compressed line that do not strictly increase or reach `limit`.
pub(crate) fn check_line(
    line: usize,
    indices: impl Iterator<Item = usize>,
    limit: usize,
) -> Result<(), SolverError> {
    let mut last = None;
    for index in indices {
        if last.is_some_and(|last| index <= last) {
            return Err(SolverError::Unsorted { line });
        }
        last = Some(index);
    }
    match last {
        Some(index) if index >= limit => Err(SolverError::IndexOutOfRange { line, index, limit }),
        _ => Ok(()),
    }
}
