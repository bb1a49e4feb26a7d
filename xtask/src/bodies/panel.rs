//! A field with two scales, a title and what is drawn in it.

use super::ruler::Ruler;
use crate::drawing::{Anchor, Drawing, Style};

/// Of grid, secondary and primary text.
const GRID: &str = "#e6e6e6";
pub(super) const FAINT: &str = "#6b6b6b";
pub(super) const INK: &str = "#1a1a1a";

/// Left, top, right, bottom of a field.
pub(super) type Frame = [f64; 4];

/// A panel's words.
pub(super) struct Title<'a> {
    pub(super) name: &'a str,
    /// What is drawn upwards, and anything else to know.
    pub(super) note: &'a str,
    /// What is drawn to the right.
    pub(super) across: &'a str,
}

/// Where a panel is and what its sides mean.
pub(super) struct Panel {
    frame: Frame,
    x: Ruler,
    y: Ruler,
}

/// Small text.
pub(super) const SMALL: Style<'static> = Style {
    size: 12.5,
    colour: FAINT,
    anchor: Anchor::Start,
    bold: false,
};

impl Panel {
    pub(super) fn new(frame: Frame, [x, y]: [Ruler; 2]) -> Self {
        let [left, top, right, bottom] = frame;
        Self {
            frame,
            x: x.at([left, right]),
            y: y.at([bottom, top]),
        }
    }

    pub(super) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.place(x), self.y.place(y)]
    }

    /// Title, and lines at some values of both sides with their numbers.
    pub(super) fn draw_axes(&self, drawing: &mut Drawing, title: &Title<'_>, ticks: [&[f64]; 2]) {
        let [left, top, right, bottom] = self.frame;
        for tick in ticks[0] {
            let x = self.x.place(*tick);
            drawing.line(&[[x, top], [x, bottom]], GRID, 1.0, "");
            let style = Style {
                anchor: Anchor::Middle,
                ..SMALL
            };
            drawing.text([x, bottom + 17.0], &short(*tick), style);
        }
        let style = Style {
            anchor: Anchor::End,
            ..SMALL
        };
        for tick in ticks[1] {
            let y = self.y.place(*tick);
            drawing.line(&[[left, y], [right, y]], GRID, 1.0, "");
            drawing.text([left - 6.0, y + 4.5], &short(*tick), style);
        }
        let sides = [[left, top], [left, bottom], [right, bottom]];
        drawing.line(&sides, "#9a9a9a", 1.2, "");
        drawing.text([right, bottom + 34.0], title.across, style);
        let style = Style {
            size: 17.0,
            colour: INK,
            bold: true,
            ..SMALL
        };
        drawing.text([left, top - 27.0], title.name, style);
        drawing.text([left, top - 9.0], title.note, SMALL);
    }

    /// A line through values.
    pub(super) fn draw_line(
        &self,
        drawing: &mut Drawing,
        values: &[[f64; 2]],
        (colour, width, dash): (&str, f64, &str),
    ) {
        let places: Vec<[f64; 2]> = values.iter().map(|value| self.place(*value)).collect();
        drawing.line(&places, colour, width, dash);
    }
}

/// A number without superfluous digits.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.0, 0.25, 10.0, 3000.0].map(short),
            ["0", "0.25", "10", "3000"]
        );
    }
}
