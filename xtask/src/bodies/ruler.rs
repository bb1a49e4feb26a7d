//! Scales along the sides of a panel.

use crate::drawing::Axis;

/// Where values are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ruler {
    /// Equal ratios are equally long.
    Logarithmic(Axis),
    /// Equal differences are.
    Linear {
        /// Least and greatest value.
        values: [f64; 2],
        /// Where they are drawn.
        places: [f64; 2],
    },
}

impl Ruler {
    /// Over values that all are drawn, with a little room.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>, room: f64) -> Self {
        Self::Logarithmic(Axis::around(values, [0.0, 1.0], room))
    }

    /// Between two values.
    pub(super) fn linear(values: [f64; 2]) -> Self {
        Self::Linear {
            values,
            places: [0.0, 1.0],
        }
    }

    /// The same values elsewhere.
    pub(super) fn at(self, places: [f64; 2]) -> Self {
        match self {
            Self::Logarithmic(axis) => Self::Logarithmic(axis.at(places)),
            Self::Linear { values, .. } => Self::Linear { values, places },
        }
    }

    /// Where a value is drawn; values outside at the nearest end.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self {
            Self::Logarithmic(axis) => axis.place(value),
            Self::Linear {
                values: [low, high],
                places: [from, to],
            } => from + ((value - low) / (high - low)).clamp(0.0, 1.0) * (to - from),
        }
    }
}
