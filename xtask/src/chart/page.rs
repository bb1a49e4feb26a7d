//! The page: five panels, a key, what they say, and where they come from.

use super::axis::Axis;
use super::panel::{FAINT, INK, Panel, look, mark, promise_bar};
use super::plan::{DEFAULT, Method, PAPERS, Problem};
use super::results::{Measure, Point};
use super::svg::{Anchor, Drawing, Style};
use super::verdict::{Ratio, acceptance, ratios};

const SIZE: [f64; 2] = [1560.0, 1500.0];
const TOP: f64 = 178.0;
const FIELD: [f64; 2] = [440.0, 312.0];
const PITCH: [f64; 2] = [508.0, 424.0];
const LEFT: f64 = 72.0;

const PLAIN: Style<'static> = Style {
    size: 14.0,
    colour: INK,
    anchor: Anchor::Start,
    bold: false,
};

/// Draws it all.
pub(super) fn page(points: &[Point], command: &str) -> Drawing {
    let mut drawing = Drawing::new(SIZE);
    heading(&mut drawing, points);
    let film = [
        Measure::Normals,
        Measure::Wavelength,
        Measure::Amplitude,
        Measure::Onset,
        Measure::Gap,
    ];
    let patch = [
        Measure::PatchNormals,
        Measure::PatchWavelength,
        Measure::PatchAmplitude,
    ];
    row(&mut drawing, points, Problem::Film, (&film, 0));
    row(&mut drawing, points, Problem::Patch, (&patch, 6));
    key(&mut drawing, corner(5), points);
    caption(&mut drawing, points, command);
    drawing
}

/// Panels from a cell on, with one axis of costs.
fn row(
    drawing: &mut Drawing,
    points: &[Point],
    problem: Problem,
    (measures, first): (&[Measure], usize),
) {
    let own = points.iter().filter(|p| p.setting.problem == problem);
    let costs = own.flat_map(|p| [p.seconds.low, p.seconds.high]);
    let x = Axis::around(costs, [0.0, 1.0], 1.15);
    for (i, &measure) in measures.iter().enumerate() {
        let [left, top] = corner(first + i);
        let frame = [left, top, left + FIELD[0], top + FIELD[1]];
        Panel::new(points, measure, frame, x).draw(drawing);
    }
}

fn corner(cell: usize) -> [f64; 2] {
    let [column, row] = [cell % 3, cell / 3].map(|n| n as f64);
    [LEFT + column * PITCH[0], TOP + row * PITCH[1]]
}

fn heading(drawing: &mut Drawing, points: &[Point]) {
    let style = Style {
        size: 30.0,
        bold: true,
        ..PLAIN
    };
    drawing.text(
        [LEFT - 40.0, 50.0],
        "Wrinkles: speed against accuracy",
        style,
    );
    let style = Style {
        size: 17.0,
        bold: false,
        ..style
    };
    drawing.text([LEFT - 40.0, 80.0], &headline(points), style);
    let style = Style {
        size: 14.0,
        colour: FAINT,
        ..style
    };
    let line = "A stiff film on a soft base (150 : 1), compressed to four critical strains in eight frames. Down and to \
                the left is better. Marks are medians over seeds, whiskers the best and the worst seed.";
    drawing.text([LEFT - 40.0, 104.0], line, style);
}

/// The first thing to know.
fn headline(points: &[Point]) -> String {
    let ratios = ratios(points);
    let Some(least) = ratios.iter().min_by(|a, b| a.value().total_cmp(&b.value())) else {
        return "The papers’ combination (hard rows, area sampling, uniform mesh, MINRES) gave nothing to compare with."
            .to_owned();
    };
    format!(
        "At equal error the default is at least {:.0} times as fast as the papers’ combination (hard rows, area sampling, \
         uniform mesh, MINRES).",
        least.value().floor()
    )
}

fn key(drawing: &mut Drawing, [left, top]: [f64; 2], points: &[Point]) {
    let bold = Style {
        size: 15.0,
        bold: true,
        ..PLAIN
    };
    let mut y = top - 20.0;
    drawing.text([left, y], "Key", bold);
    for (coupling, words) in [
        ("hybrid", "hybrid: foundation and low-pass rows (default)"),
        (
            "elastic",
            "elastic: foundation alone; right only where flat",
        ),
        ("constraint", "constraint: hard rows alone (papers)"),
    ] {
        y += 22.0;
        let colour = look(&Method { coupling, ..PAPERS }).colour;
        drawing.line(&[[left, y - 5.0], [left + 22.0, y - 5.0]], colour, 4.0, "");
        drawing.text([left + 32.0, y], words, PLAIN);
    }
    let with = |mesh: &'static str, solver: &'static str| Method {
        mesh,
        solver,
        ..DEFAULT
    };
    y += 25.0;
    let marks = [
        (with("adaptive", "ldlt"), 0.0, "adaptive mesh"),
        (with("uniform", "ldlt"), 132.0, "uniform"),
        (with("uniform", "minres"), 218.0, "MINRES; round: LDLᵀ"),
    ];
    for (method, shift, words) in marks {
        mark(drawing, [left + 7.0 + shift, y - 5.0], &method, FAINT, 5.0);
        drawing.text([left + 18.0 + shift, y], words, PLAIN);
    }
    y += 24.0;
    drawing.line(
        &[[left, y - 5.0], [left + 22.0, y - 5.0]],
        "#000000",
        8.0,
        "",
    );
    drawing.line(
        &[[left, y - 5.0], [left + 22.0, y - 5.0]],
        "#ffe680",
        6.0,
        "",
    );
    drawing.text([left + 32.0, y], "Pareto line", PLAIN);
    let x = left + 132.0;
    promise_bar(drawing, [x + 12.0, y - 8.0]);
    drawing.text([x + 32.0, y], "promised", PLAIN);
    let x = left + 250.0;
    for [from, to] in [[-4.0, 4.0], [4.0, -4.0]] {
        drawing.line(
            &[[x - 4.0, y - 5.0 + from], [x + 4.0, y - 5.0 + to]],
            FAINT,
            1.8,
            "",
        );
    }
    drawing.text([x + 11.0, y], "every run failed", PLAIN);
    y = promises(drawing, [left, y + 32.0], points);
    times(drawing, [left, y + 30.0], &ratios(points));
}

/// The default's errors beside what they may be; gives how far down it reaches.
fn promises(drawing: &mut Drawing, [left, top]: [f64; 2], points: &[Point]) -> f64 {
    let bold = Style {
        size: 15.0,
        bold: true,
        ..PLAIN
    };
    let faint = Style {
        colour: FAINT,
        ..PLAIN
    };
    drawing.text([left, top], "The default’s error", bold);
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
    let bold = Style {
        size: 15.0,
        bold: true,
        ..PLAIN
    };
    drawing.text(
        [left, top],
        "Cost of the papers’ combination at equal error",
        bold,
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

fn caption(drawing: &mut Drawing, points: &[Point], command: &str) {
    let runs: usize = points.iter().map(|p| p.runs).sum();
    let failed: usize = points.iter().map(|p| p.failed).sum();
    let iterated = points
        .iter()
        .filter(|p| p.setting.method.solver == "minres");
    let (of_minres, minres) = iterated.fold((0, 0), |(f, r), p| (f + p.failed, r + p.runs));
    let lines = [
        "Along each line 4, 6, 8, 12, 16, 24 mesh points per wavelength. Pale marks: other samplings of the rows (area, \
         adjusted, quadrature), meshes and solvers. Exact: the continuum with finite strains. Wavelength and onset: the first mode"
            .to_owned(),
        "over nine box lengths, so no box sets them; they belong to the mesh, and MINRES shares them with LDLᵀ. Normals: \
         each line across the wrinkles shifted to its best. Errors under 0.05 % are drawn at the edge.".to_owned(),
        format!(
            "{failed} of {runs} runs failed, {of_minres} of {minres} with MINRES, which was pushed by noise of one \
             thickness. More numbers beside this chart in chart.csv and chart.json. Reproduce: {command}"
        ),
    ];
    for (i, line) in lines.iter().enumerate() {
        let style = Style {
            size: 13.0,
            colour: FAINT,
            ..PLAIN
        };
        drawing.text([LEFT - 40.0, SIZE[1] - 56.0 + 19.0 * i as f64], line, style);
    }
}
