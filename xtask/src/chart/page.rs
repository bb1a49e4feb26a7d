//! The pages: panels of a film and of a patch, a key, what they say, and where they come from; and a
//! summary of that.

use super::key::key;
use super::panel::{FAINT, INK, Panel};
use super::plan::Problem;
use super::results::{Measure, Point};
use super::verdict::ratios;
use crate::drawing::{Anchor, Axis, Drawing, Style};

/// Cells in rows.
#[derive(Clone, Copy)]
struct Layout {
    size: [f64; 2],
    /// Of the first row of fields.
    top: f64,
    /// From row to row.
    pitch: f64,
    columns: usize,
}

const PAGE: Layout = Layout {
    size: [1560.0, 1560.0],
    top: 184.0,
    pitch: 446.0,
    columns: 3,
};

const SUMMARY: Layout = Layout {
    size: [1048.0, 1058.0],
    top: 200.0,
    pitch: 418.0,
    columns: 2,
};

const FIELD: [f64; 2] = [440.0, 312.0];
/// From column to column.
const PITCH: f64 = 508.0;
const LEFT: f64 = 72.0;
const MARGIN: f64 = 32.0;

/// Ordinary text.
pub(super) const PLAIN: Style<'static> = Style {
    size: 14.0,
    colour: INK,
    anchor: Anchor::Start,
    bold: false,
};

/// All of it.
pub(super) fn page(points: &[Point], command: &str) -> Drawing {
    let mut drawing = Drawing::new(PAGE.size);
    let lines = [
        "Above: a stiff film on a soft base (150 : 1), compressed to four critical strains in eight frames. Below: a patch, \
         as a user has it. Down and to the left is better. Medians over seeds, whiskers to the best and the worst.",
        PAPERS_WAY,
    ];
    heading(&mut drawing, points, &lines);
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
    row(&mut drawing, PAGE, points, (&film, 0));
    row(&mut drawing, PAGE, points, (&patch, 6));
    key(&mut drawing, PAGE.corner(5), points);
    caption(&mut drawing, points, command);
    drawing
}

/// What matters most, for those who will not read more.
pub(super) fn summary(points: &[Point], command: &str) -> Drawing {
    let mut drawing = Drawing::new(SUMMARY.size);
    let lines = [
        "A stiff film on a soft base (150 : 1), compressed to four critical strains in eight frames, against the exact wrinkles. \
         Down and to the",
        "left is better. Medians over seeds, whiskers to the best and the worst. Along each line 4, 6, 8, 12, 16, 24 mesh edges \
         per wavelength.",
        PAPERS_WAY,
    ];
    heading(&mut drawing, points, &lines);
    let film = [Measure::Normals, Measure::Wavelength, Measure::Amplitude];
    row(&mut drawing, SUMMARY, points, (&film, 0));
    key(&mut drawing, SUMMARY.corner(3), points);
    let line = format!("Times: one thread, everything but measuring. Reproduce: {command}");
    note(&mut drawing, SUMMARY.size[1] - 24.0, &line);
    drawing
}

/// Panels of one problem from a cell on, with one axis of costs.
fn row(
    drawing: &mut Drawing,
    layout: Layout,
    points: &[Point],
    (measures, first): (&[Measure], usize),
) {
    let problem = measures.first().map_or(Problem::Film, |m| m.problem());
    let own = points.iter().filter(|p| p.setting.problem == problem);
    let costs = own.flat_map(|p| p.seconds.iter().flat_map(|s| [s.low, s.high]));
    let x = Axis::around(costs, [0.0, 1.0], 1.15);
    for (i, &measure) in measures.iter().enumerate() {
        let [left, top] = layout.corner(first + i);
        let frame = [left, top, left + FIELD[0], top + FIELD[1]];
        Panel::new(points, measure, frame, x).draw(drawing);
    }
}

impl Layout {
    fn corner(self, cell: usize) -> [f64; 2] {
        let [column, row] = [cell % self.columns, cell / self.columns].map(|n| n as f64);
        [LEFT + column * PITCH, self.top + row * self.pitch]
    }
}

fn heading(drawing: &mut Drawing, points: &[Point], lines: &[&str]) {
    let style = Style {
        size: 30.0,
        bold: true,
        ..PLAIN
    };
    drawing.text([MARGIN, 50.0], "Wrinkles: speed against accuracy", style);
    let style = Style {
        size: 17.0,
        bold: false,
        ..style
    };
    drawing.text([MARGIN, 80.0], &headline(points), style);
    for (i, line) in lines.iter().enumerate() {
        note(drawing, 104.0 + 19.0 * i as f64, line);
    }
}

/// What is meant by the papers' way.
const PAPERS_WAY: &str =
    "The papers’ way: hard rows sampled by area, hinges, a uniform mesh, MINRES.";

fn note(drawing: &mut Drawing, y: f64, line: &str) {
    let style = Style {
        size: 13.5,
        colour: FAINT,
        ..PLAIN
    };
    drawing.text([MARGIN, y], line, style);
}

/// The first thing to know.
fn headline(points: &[Point]) -> String {
    let ratios = ratios(points);
    let Some(least) = ratios.iter().min_by(|a, b| a.value().total_cmp(&b.value())) else {
        return "The papers’ way gave nothing to compare with.".to_owned();
    };
    let times = least.value().floor();
    format!("At equal error the default is over {times:.0} times as fast as the papers’ way.")
}

fn caption(drawing: &mut Drawing, points: &[Point], command: &str) {
    let runs: usize = points.iter().map(|p| p.runs).sum();
    let failed: usize = points.iter().map(|p| p.failed).sum();
    let iterated = points
        .iter()
        .filter(|p| p.setting.method.solver == "minres");
    let (of_minres, minres) = iterated.fold((0, 0), |(f, r), p| (f + p.failed, r + p.runs));
    let lines = [
        "Along each line 4, 6, 8, 12, 16, 24 mesh edges per wavelength. Pale marks: other samplings of the rows (area, \
         adjusted, quadrature), meshes and solvers. Errors under 0.05 % are drawn at the lower edge."
            .to_owned(),
        "Film: against the continuum with finite strains. Its wavelength and onset are those of the first mode over several \
         box lengths, so that no box sets them; they belong to the mesh, and MINRES shares them with LDLᵀ."
            .to_owned(),
        "Normals: along lines across the wrinkles, each shifted to its best. Patch: three critical strains in its middle, \
         none at its ends, in six frames through the product’s own planner and stepper, against an"
            .to_owned(),
        "even hybrid mesh of 32 edges per wavelength. Times: one thread, everything but measuring.".to_owned(),
        format!(
            "{failed} of {runs} runs failed, {of_minres} of {minres} with MINRES, which was pushed by noise of a film \
             thickness. More numbers beside this chart in chart.csv and chart.json. Reproduce: {command}"
        ),
    ];
    for (i, line) in lines.iter().enumerate() {
        note(drawing, PAGE.size[1] - 96.0 + 19.0 * i as f64, line);
    }
}

#[cfg(test)]
mod tests {
    use super::super::results::points;
    use super::*;

    #[test]
    fn a_page_without_a_single_run_is_a_page() {
        let page = page(&points(&[], &[]), "cargo xtask chart");
        assert!(page.svg().contains("Reproduce: cargo xtask chart"));
        assert!(page.png(0.2).is_ok());
        assert!(summary(&points(&[], &[]), "").png(0.2).is_ok());
    }
}
