//! Counts of a remesh's operations.

/// Operations done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Counts {
    pub(crate) splits: usize,
    pub(crate) flips: usize,
    pub(crate) collapses: usize,
    pub(crate) moves: usize,
}
