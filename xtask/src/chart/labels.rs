//! Texts that keep out of each other's way.

use crate::drawing::{Anchor, Drawing, Style};

/// Mean width of a letter over the size of its font; a little more than measured.
const LETTER: f64 = 0.58;

/// What is taken on a page.
#[derive(Debug, Default)]
pub(super) struct Labels {
    taken: Vec<[f64; 4]>,
}

impl Labels {
    /// Keeps labels off a mark of this radius.
    pub(super) fn avoid(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.taken
            .push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Writes a text beside one of some points: at the first of eight places around each, near before
    /// far, that is inside of `frame` (left, top, right, bottom) and covers least.
    pub(super) fn write(
        &mut self,
        drawing: &mut Drawing,
        points: &[[f64; 2]],
        text: &str,
        style: Style,
        frame: [f64; 4],
    ) {
        let width = LETTER * style.size * text.chars().count() as f64;
        let mut best: Option<(f64, [f64; 2], [f64; 4], Anchor)> = None;
        let around = points.iter().flat_map(|point| {
            let gaps = [9.0, 16.0, 26.0].into_iter();
            gaps.flat_map(move |gap| AROUND.map(|direction| (*point, gap, direction)))
        });
        for ([x, y], gap, (dx, dy, anchor)) in around {
            let at = [x + gap * dx, y + gap * dy + 0.36 * style.size];
            let left = match anchor {
                Anchor::Start => at[0],
                Anchor::Middle => at[0] - 0.5 * width,
                Anchor::End => at[0] - width,
            };
            let size = style.size;
            let area = [left, at[1] - 0.85 * size, left + width, at[1] + 0.2 * size];
            let covered: f64 = self.taken.iter().map(|other| overlap(area, *other)).sum();
            let cost = covered + 50.0 * excess(area, frame) + 0.3 * gap;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, at, area, anchor));
            }
        }
        if let Some((_, at, area, anchor)) = best {
            self.taken.push(area);
            drawing.text(at, text, Style { anchor, ..style });
        }
    }
}

/// Directions from a point to its label, the preferred ones first.
const AROUND: [(f64, f64, Anchor); 8] = [
    (1.0, 0.0, Anchor::Start),
    (0.8, -1.0, Anchor::Start),
    (0.8, 1.0, Anchor::Start),
    (0.0, -1.4, Anchor::Middle),
    (0.0, 1.4, Anchor::Middle),
    (-0.8, -1.0, Anchor::End),
    (-0.8, 1.0, Anchor::End),
    (-1.0, 0.0, Anchor::End),
];

/// Area that two rectangles share.
fn overlap(a: [f64; 4], b: [f64; 4]) -> f64 {
    let side = |i: usize| (a[i + 2].min(b[i + 2]) - a[i].max(b[i])).max(0.0);
    side(0) * side(1)
}

/// How far a rectangle reaches out of a frame.
fn excess(area: [f64; 4], frame: [f64; 4]) -> f64 {
    let low: f64 = (0..2).map(|i| (frame[i] - area[i]).max(0.0)).sum();
    let high: f64 = (2..4).map(|i| (area[i] - frame[i]).max(0.0)).sum();
    low + high
}

#[cfg(test)]
mod tests {
    use super::*;

    const STYLE: Style<'static> = Style {
        size: 10.0,
        colour: "#000000",
        anchor: Anchor::Start,
        bold: false,
    };

    #[test]
    fn a_second_label_goes_elsewhere() {
        let mut drawing = Drawing::new([200.0, 200.0]);
        let mut labels = Labels::default();
        for text in ["one", "two", "three", "four"] {
            labels.write(
                &mut drawing,
                &[[100.0, 100.0]],
                text,
                STYLE,
                [0.0, 0.0, 200.0, 200.0],
            );
        }
        let areas = &labels.taken;
        let shared: f64 = (0..4)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| overlap(areas[i], areas[j]))
            .sum();
        assert_eq!((areas.len(), shared), (4, 0.0));
    }

    #[test]
    fn no_label_leaves_the_frame() {
        let mut drawing = Drawing::new([200.0, 200.0]);
        let mut labels = Labels::default();
        let frame = [0.0, 0.0, 200.0, 200.0];
        labels.write(&mut drawing, &[[195.0, 100.0]], "to the left", STYLE, frame);
        assert_eq!(excess(labels.taken[0], frame), 0.0);
    }
}
