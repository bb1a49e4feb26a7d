//! Logarithmic axes.

/// Numbers that fit beside an axis.
const MOST_LABELS: usize = 12;

/// A range of positive values along a stretch of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    /// Least and greatest value.
    values: [f64; 2],
    /// Where they are drawn.
    places: [f64; 2],
}

impl Axis {
    /// An axis for some values, with a little room at both ends.
    pub(crate) fn around(values: impl Iterator<Item = f64>, places: [f64; 2], room: f64) -> Self {
        let (low, high) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        let (low, high) = if low <= high { (low, high) } else { (0.1, 1.0) };
        Self {
            values: [low / room, high * room],
            places,
        }
    }

    /// The same range elsewhere.
    pub(crate) fn at(self, places: [f64; 2]) -> Self {
        Self { places, ..self }
    }

    /// No more than down to this value.
    pub(crate) fn from(mut self, least: f64) -> Self {
        self.values[0] = self.values[0].max(least);
        self
    }

    /// Where a value is drawn; values outside at the nearest end.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let [low, high] = self.values.map(f64::ln);
        let share = ((value.ln() - low) / (high - low)).clamp(0.0, 1.0);
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// Values of the form 1, 2 or 5 times a power of ten inside the range, and whether each is a power
    /// of ten.
    pub(crate) fn ticks(&self) -> Vec<(f64, bool)> {
        let decades = self.values[0].log10().floor() as i32..=self.values[1].log10().ceil() as i32;
        decades
            .flat_map(|decade| [1.0, 2.0, 5.0].map(|m| (m * 10_f64.powi(decade), m == 1.0)))
            .filter(|(value, _)| (self.values[0]..=self.values[1]).contains(value))
            .collect()
    }

    /// Ticks that carry a number: all where they are few, else powers of ten.
    pub(crate) fn labelled(&self) -> Vec<f64> {
        let ticks = self.ticks();
        let are_few = ticks.len() <= MOST_LABELS;
        let labelled = ticks.iter().filter(|tick| are_few || tick.1);
        labelled.map(|tick| tick.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decade_takes_as_much_room_as_another() {
        let axis = Axis::around([0.1, 10.0].into_iter(), [0.0, 100.0], 1.0);
        for (value, place) in [(0.1, 0.0), (1.0, 50.0), (10.0, 100.0), (0.001, 0.0)] {
            assert!((axis.place(value) - place).abs() < 1e-9);
        }
        assert_eq!(axis.labelled().len(), 7);
        let wide = Axis::around([1e-3, 1e3].into_iter(), [0.0, 100.0], 1.0);
        assert_eq!([wide.ticks().len(), wide.labelled().len()], [19, 7]);
    }

    #[test]
    fn nothing_to_draw_has_an_axis_too() {
        let axis = Axis::around(std::iter::empty(), [0.0, 1.0], 1.0);
        assert!(axis.place(0.5).is_finite() && !axis.ticks().is_empty());
    }
}
