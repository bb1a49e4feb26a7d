//! What colours and marks mean, and the numbers that matter most.

use ruga_validation::plot::colours::{FAINT, INK};
use ruga_validation::plot::{Colour, Drawn, Lettering, NOTE, PLAIN, Page, Shape, stroke};

use crate::panel::{colour, mark, pareto_line, promise_bar};
use crate::plan::{DEFAULT, ELASTIC, HINGED, PAPERS, QUALITIES};
use crate::results::{Measure, Point, Spread};
use crate::setting::{Mesh, Method, Problem, Solver};
use crate::verdict::{Acceptance, Ratio, acceptance, default_at, ratios};

const TITLE: Lettering = Lettering {
    size: 15.0,
    bold: true,
    ..PLAIN
};

const STRONG: Lettering = Lettering {
    bold: true,
    ..PLAIN
};

const QUIET: Lettering = Lettering { size: 14.0, ..NOTE };

/// Of an error that is greater than promised.
const ALARM: Colour = Colour(0xb0, 0x00, 0x20);

/// From its upper left corner down.
pub(crate) fn key(page: &Page<'_>, [left, top]: [f64; 2], points: &[Point]) -> Drawn {
    page.text([left, top - 32.0], "Key", TITLE)?;
    let mut y = top - 33.0;
    for (method, words) in [
        (
            DEFAULT,
            "hybrid: springs and averaging constraints (default)",
        ),
        (HINGED, "the same, bending at edges, on shorter triangles"),
        (ELASTIC, "elastic: springs alone; right only where flat"),
        (
            PAPERS,
            "averaging constraints alone (papers); dashed: direct",
        ),
    ] {
        y += 20.0;
        page.line(&[[left, y], [left + 22.0, y]], stroke(colour(&method), 4.0))?;
        page.text([left + 32.0, y], words, PLAIN)?;
    }
    marks(page, [left, y + 22.0])?;
    signs(page, [left, y + 43.0])?;
    let y = qualities(page, [left, y + 72.0], points)?;
    times(page, [left, y + 28.0], &ratios(points))
}

fn marks(page: &Page<'_>, [left, y]: [f64; 2]) -> Drawn {
    let with = |mesh: Mesh, solver: Solver| Method {
        mesh,
        solver,
        ..DEFAULT
    };
    for (method, shift, words) in [
        (with(Mesh::Adaptive, Solver::Ldlt), 0.0, "adaptive mesh"),
        (with(Mesh::Uniform, Solver::Ldlt), 132.0, "uniform"),
        (
            with(Mesh::Uniform, Solver::Minres),
            218.0,
            "iterative; round: direct",
        ),
    ] {
        mark(page, [left + 7.0 + shift, y], &method, FAINT, 5.2)?;
        page.text([left + 18.0 + shift, y], words, PLAIN)?;
    }
    Ok(())
}

fn signs(page: &Page<'_>, [left, y]: [f64; 2]) -> Drawn {
    pareto_line(page, &[[left, y], [left + 22.0, y]])?;
    page.text([left + 32.0, y], "Pareto line", PLAIN)?;
    promise_bar(page, [left + 144.0, y - 3.0])?;
    page.text([left + 164.0, y], "promised", PLAIN)?;
    page.mark([left + 250.0, y], Shape::Cross, 4.0, [FAINT; 2])?;
    page.text([left + 261.0, y], "every run failed", PLAIN)
}

/// The default at every quality: errors, beside what they may be, and costs; gives how far down it
/// reaches.
fn qualities(
    page: &Page<'_>,
    [left, top]: [f64; 2],
    points: &[Point],
) -> Result<f64, Box<dyn std::error::Error>> {
    page.text([left, top], "The default", TITLE)?;
    let accepted = acceptance(points);
    let film = Measure::ALL.into_iter();
    let film = film.filter(|measure| measure.problem() == Problem::Film);
    let lines = film.clone().map(Measure::name);
    let lines = lines.chain(COSTS.map(|(name, _)| name.to_owned()));
    for (i, name) in lines.clone().enumerate() {
        page.text([left, top + 18.0 * (i + 1) as f64], &name, PLAIN)?;
    }
    for ((name, quality), column) in QUALITIES.into_iter().zip([138.0, 222.0, 340.0]) {
        let x = left + column;
        page.text([x, top], &format!("{name} {quality}"), QUIET)?;
        let setting = default_at(quality, Measure::Wavelength);
        let Some(point) = points.iter().find(|point| point.setting == setting) else {
            continue;
        };
        let mut y = top;
        for measure in film.clone() {
            y += 18.0;
            let is_it = |a: &&Acceptance| a.points == quality && a.measure == measure;
            let promise = accepted.iter().find(is_it);
            error_beside(page, [x, y], measure, (point.error(measure), promise))?;
        }
        for (_, number) in COSTS {
            y += 18.0;
            page.text([x, y], &number(point), PLAIN)?;
        }
    }
    Ok(top + 18.0 * lines.count() as f64)
}

/// A cost's name, and how a point has it in words.
type Cost = (&'static str, fn(&Point) -> String);

fn in_words(cost: Option<&Spread>) -> String {
    cost.map_or("–".to_owned(), |cost| format!("{:.3}", cost.median))
}

/// What the film costs.
const COSTS: [Cost; 3] = [
    ("seconds a key", |p| in_words(p.seconds.as_ref())),
    ("a 1000 vertices", |p| {
        in_words(p.seconds_per_thousand.as_ref())
    }),
    ("runs failed", |p| format!("{} of {}", p.failed, p.runs)),
];

/// An error and, where one was promised, the greatest that it may be.
fn error_beside(
    page: &Page<'_>,
    [x, y]: [f64; 2],
    measure: Measure,
    (error, promise): (Option<f64>, Option<&Acceptance>),
) -> Drawn {
    let words = error.map_or("–".to_owned(), |e| measure.words(e));
    let is_missed = promise.is_some_and(|promise| !promise.is_met());
    let colour = if is_missed { ALARM } else { INK };
    page.text([x, y], &words, Lettering { colour, ..STRONG })?;
    if let Some(promise) = promise {
        let accepted = format!("≤ {:.1} %", 100.0 * promise.accepted);
        let style = Lettering {
            size: 12.0,
            ..QUIET
        };
        page.text([x + 58.0, y], &accepted, style)?;
    }
    Ok(())
}

/// How much dearer the papers' way is.
fn times(page: &Page<'_>, [left, top]: [f64; 2], ratios: &[Ratio]) -> Drawn {
    let title = "Cost of the papers’ combination at equal error";
    page.text([left, top], title, TITLE)?;
    let mut y = top;
    for ratio in ratios {
        y += 18.0;
        page.text([left, y], &ratio.measure.name(), PLAIN)?;
        let bound = if ratio.is_bound { "> " } else { "" };
        let text = format!("{bound}{:.0} times", ratio.value());
        page.text([left + 138.0, y], &text, STRONG)?;
        let error = ratio.measure.words(ratio.error);
        let text = format!("at {error} with {} points", ratio.points);
        page.text([left + 240.0, y], &text, QUIET)?;
    }
    Ok(())
}
