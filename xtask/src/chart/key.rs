//! What colours and marks mean, and the numbers that matter most.

use super::page::PLAIN;
use super::panel::{FAINT, INK, cross, look, mark, pareto_line, promise_bar};
use super::plan::{DEFAULT, ELASTIC, HINGED, Method, PAPERS, Problem, QUALITIES};
use super::results::{Measure, Point, Spread};
use super::verdict::{Acceptance, Ratio, acceptance, default_at, ratios};
use crate::drawing::{Drawing, Style};

const TITLE: Style<'static> = Style {
    size: 15.0,
    bold: true,
    ..PLAIN
};

const QUIET: Style<'static> = Style {
    colour: FAINT,
    ..PLAIN
};

const STRONG: Style<'static> = Style {
    bold: true,
    ..PLAIN
};

/// Of an error that is greater than promised.
const ALARM: &str = "#b00020";

/// From its upper left corner down.
pub(super) fn key(drawing: &mut Drawing, [left, top]: [f64; 2], points: &[Point]) {
    drawing.text([left, top - 28.0], "Key", TITLE);
    let y = colours(drawing, [left, top - 28.0]);
    marks(drawing, [left, y + 22.0]);
    signs(drawing, [left, y + 43.0]);
    let y = qualities(drawing, [left, y + 72.0], points);
    times(drawing, [left, y + 28.0], &ratios(points));
}

/// Gives how far down it reaches.
fn colours(drawing: &mut Drawing, [left, top]: [f64; 2]) -> f64 {
    let mut y = top;
    for (method, words) in [
        (DEFAULT, "hybrid: foundation and low-pass rows (default)"),
        (HINGED, "the same with hinges, on shorter triangles"),
        (ELASTIC, "elastic: foundation alone; right only where flat"),
        (PAPERS, "constraint: hard rows alone (papers)"),
    ] {
        y += 20.0;
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

/// The default at every quality: errors, beside what they may be, and costs; gives how far down it
/// reaches.
fn qualities(drawing: &mut Drawing, [left, top]: [f64; 2], points: &[Point]) -> f64 {
    drawing.text([left, top], "The default", TITLE);
    let columns = [138.0, 222.0, 340.0].map(|x| left + x);
    let accepted = acceptance(points);
    let film = |quality: u32| {
        let setting = default_at(quality, Measure::Wavelength);
        points.iter().find(move |point| point.setting == setting)
    };
    let mut y = top;
    for ((name, quality), x) in QUALITIES.into_iter().zip(columns) {
        drawing.text([x, top], &format!("{name} {quality}"), QUIET);
    }
    for measure in Measure::ALL {
        if measure.problem() != Problem::Film {
            continue;
        }
        y += 18.0;
        drawing.text([left, y], measure.name(), PLAIN);
        for ((_, quality), x) in QUALITIES.into_iter().zip(columns) {
            let error = film(quality).and_then(|point| point.error(measure));
            let is_it = |a: &&Acceptance| a.points == quality && a.measure == measure;
            error_beside(
                drawing,
                [x, y],
                measure,
                (error, accepted.iter().find(is_it)),
            );
        }
    }
    for (words, number) in COSTS {
        y += 18.0;
        drawing.text([left, y], words, PLAIN);
        for ((_, quality), x) in QUALITIES.into_iter().zip(columns) {
            let text = film(quality).map_or("–".to_owned(), number);
            drawing.text([x, y], &text, PLAIN);
        }
    }
    y
}

/// A cost's name, and how a point has it in words.
type Cost = (&'static str, fn(&Point) -> String);

fn in_words(cost: Option<&Spread>) -> String {
    cost.map_or("–".to_owned(), |cost| format!("{:.3}", cost.median))
}

/// What the film costs.
const COSTS: [Cost; 3] = [
    ("seconds a frame", |p| in_words(p.seconds.as_ref())),
    ("a 1000 vertices", |p| {
        in_words(p.seconds_per_thousand.as_ref())
    }),
    ("runs failed", |p| format!("{} of {}", p.failed, p.runs)),
];

/// An error and, where one was promised, the greatest that it may be.
fn error_beside(
    drawing: &mut Drawing,
    [x, y]: [f64; 2],
    measure: Measure,
    (error, promise): (Option<f64>, Option<&Acceptance>),
) {
    let words = error.map_or("–".to_owned(), |e| measure.words(e));
    let is_missed = promise.is_some_and(|promise| !promise.is_met());
    let colour = if is_missed { ALARM } else { INK };
    drawing.text([x, y], &words, Style { colour, ..STRONG });
    if let Some(promise) = promise {
        let accepted = format!("≤ {:.1} %", 100.0 * promise.accepted);
        let style = Style {
            size: 12.0,
            ..QUIET
        };
        drawing.text([x + 58.0, y], &accepted, style);
    }
}

/// How much dearer the papers' way is.
fn times(drawing: &mut Drawing, [left, top]: [f64; 2], ratios: &[Ratio]) {
    drawing.text(
        [left, top],
        "Cost of the papers’ combination at equal error",
        TITLE,
    );
    let mut y = top;
    for ratio in ratios
        .iter()
        .filter(|r| r.measure.problem() == Problem::Film)
    {
        y += 18.0;
        drawing.text([left, y], ratio.measure.name(), PLAIN);
        let bound = if ratio.is_bound { "> " } else { "" };
        let text = format!("{bound}{:.0} times", ratio.value());
        drawing.text([left + 138.0, y], &text, STRONG);
        let text = format!(
            "at {} with {} points",
            ratio.measure.words(ratio.error),
            ratio.points
        );
        drawing.text([left + 240.0, y], &text, QUIET);
    }
}
