//! What colours and marks mean, and the numbers that matter most.

use super::page::PLAIN;
use super::panel::{FAINT, INK, cross, look, mark, pareto_line, promise_bar};
use super::plan::{DEFAULT, HINGED, Method, PAPERS};
use super::results::{Measure, Point};
use super::svg::{Drawing, Style};
use super::verdict::{Ratio, acceptance, ratios};

const TITLE: Style<'static> = Style {
    size: 15.0,
    bold: true,
    ..PLAIN
};

/// From its upper left corner down.
pub(super) fn key(drawing: &mut Drawing, [left, top]: [f64; 2], points: &[Point]) {
    drawing.text([left, top - 20.0], "Key", TITLE);
    let y = colours(drawing, [left, top - 20.0]);
    marks(drawing, [left, y + 25.0]);
    signs(drawing, [left, y + 49.0]);
    let y = promises(drawing, [left, y + 81.0], points);
    times(drawing, [left, y + 30.0], &ratios(points));
}

/// Gives how far down it reaches.
fn colours(drawing: &mut Drawing, [left, top]: [f64; 2]) -> f64 {
    let mut y = top;
    for (method, words) in [
        (DEFAULT, "hybrid: foundation and low-pass rows (default)"),
        (HINGED, "the same with hinges, on shorter triangles"),
        (
            Method {
                coupling: "elastic",
                ..DEFAULT
            },
            "elastic: foundation alone; right only where flat",
        ),
        (PAPERS, "constraint: hard rows alone (papers)"),
    ] {
        y += 22.0;
        let colour = look(&method).colour;
        drawing.line(&[[left, y - 5.0], [left + 22.0, y - 5.0]], colour, 4.0, "");
        drawing.text([left + 32.0, y], words, PLAIN);
    }
    y
}

fn marks(drawing: &mut Drawing, [left, y]: [f64; 2]) {
    let with = |mesh: &'static str, solver: &'static str| Method {
        mesh,
        solver,
        ..DEFAULT
    };
    let marks = [
        (with("adaptive", "ldlt"), 0.0, "adaptive mesh"),
        (with("uniform", "ldlt"), 132.0, "uniform"),
        (with("uniform", "minres"), 218.0, "MINRES; round: LDLᵀ"),
    ];
    for (method, shift, words) in marks {
        mark(drawing, [left + 7.0 + shift, y - 5.0], &method, FAINT, 5.0);
        drawing.text([left + 18.0 + shift, y], words, PLAIN);
    }
}

fn signs(drawing: &mut Drawing, [left, y]: [f64; 2]) {
    pareto_line(drawing, &[[left, y - 5.0], [left + 22.0, y - 5.0]]);
    drawing.text([left + 32.0, y], "Pareto line", PLAIN);
    promise_bar(drawing, [left + 144.0, y - 8.0]);
    drawing.text([left + 164.0, y], "promised", PLAIN);
    cross(drawing, [left + 250.0, y - 5.0], FAINT);
    drawing.text([left + 261.0, y], "every run failed", PLAIN);
}

/// The default's errors beside what they may be; gives how far down it reaches.
fn promises(drawing: &mut Drawing, [left, top]: [f64; 2], points: &[Point]) -> f64 {
    let faint = Style {
        colour: FAINT,
        ..PLAIN
    };
    drawing.text([left, top], "The default’s error", TITLE);
    let columns = [("standard", left + 180.0), ("fine", left + 320.0)];
    for (name, x) in columns {
        drawing.text([x, top], name, faint);
    }
    let mut y = top;
    let all = acceptance(points);
    for measure in [
        Measure::Wavelength,
        Measure::Amplitude,
        Measure::Onset,
        Measure::Gap,
    ] {
        y += 20.0;
        drawing.text([left, y], measure.name(), PLAIN);
        let own = all.iter().filter(|a| a.measure == measure);
        for (promise, (_, x)) in own.zip(columns) {
            let error = promise.error.map_or("–".to_owned(), |e| measure.words(e));
            let colour = if promise.is_met() { INK } else { "#b00020" };
            drawing.text(
                [x, y],
                &error,
                Style {
                    colour,
                    bold: true,
                    ..PLAIN
                },
            );
            let accepted = format!("of {:.1} %", 100.0 * promise.accepted);
            drawing.text([x + 62.0, y], &accepted, faint);
        }
    }
    y
}

/// How much dearer the papers' way is.
fn times(drawing: &mut Drawing, [left, top]: [f64; 2], ratios: &[Ratio]) {
    drawing.text(
        [left, top],
        "Cost of the papers’ combination at equal error",
        TITLE,
    );
    let mut y = top;
    for ratio in ratios {
        y += 20.0;
        drawing.text([left, y], ratio.measure.name(), PLAIN);
        let bound = if ratio.is_bound { "> " } else { "" };
        let text = format!("{bound}{:.0} times", ratio.value());
        drawing.text(
            [left + 104.0, y],
            &text,
            Style {
                bold: true,
                ..PLAIN
            },
        );
        let text = format!(
            "at {} with {} points",
            ratio.measure.words(ratio.error),
            ratio.points
        );
        drawing.text(
            [left + 206.0, y],
            &text,
            Style {
                colour: FAINT,
                ..PLAIN
            },
        );
    }
}
