//! How a command ends.

/// End of a command that could run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All is well.
    Done,
    /// Results are written, but a pose did not converge or the run was interrupted.
    Incomplete,
}
