//! Whether goals are met.

use std::fmt;

/// What was found of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Met,
    Missed,
    /// All is good, but less was measured than the goal asks for.
    TooFew,
    NotMeasured,
}

impl Verdict {
    /// Of something measured once.
    pub(crate) fn one(is_good: bool) -> Self {
        Self::of(is_good, 1, 1)
    }

    /// Of `count` measurements where `asked` are needed.
    pub(crate) fn of(is_good: bool, count: usize, asked: usize) -> Self {
        match (count, is_good) {
            (0, _) => Self::NotMeasured,
            (_, false) => Self::Missed,
            (_, true) if count < asked => Self::TooFew,
            (_, true) => Self::Met,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Met => "met",
            Self::Missed => "MISSED",
            Self::TooFew => "too few to tell",
            Self::NotMeasured => "not measured",
        })
    }
}
