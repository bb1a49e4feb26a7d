//! The page: panels of a film and of a patch, a key, what they say, and where they come from.

use super::axis::Axis;
use super::key::key;
use super::panel::{FAINT, INK, Panel};
use super::plan::Problem;
use super::results::{Measure, Point};
use super::svg::{Anchor, Drawing, Style};
use super::verdict::ratios;

const SIZE: [f64; 2] = [1560.0, 1508.0];
const TOP: f64 = 178.0;
const FIELD: [f64; 2] = [440.0, 312.0];
const PITCH: [f64; 2] = [508.0, 424.0];
const LEFT: f64 = 72.0;

/// Ordinary text.
pub(super) const PLAIN: Style<'static> = Style {
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
    let line = "Above: a stiff film on a soft base (150 : 1), compressed to four critical strains in eight frames. Below: a patch, \
                as a user has it. Down and to the left is better. Medians over seeds, whiskers to the best and the worst.";
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
        "At equal error the default is more than {:.0} times as fast as the papers’ combination (hard rows, area sampling, \
         uniform mesh, MINRES).",
        least.value().floor()
    )
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
         adjusted, quadrature), meshes and solvers. Errors under 0.05 %"
            .to_owned(),
        "are drawn at the edge. Film: against the continuum with finite strains. Its wavelength and onset are those of \
         the first mode over several box lengths, so that no box sets them; they"
            .to_owned(),
        "belong to the mesh, and MINRES shares them with LDLᵀ. Normals: along lines across the wrinkles, each shifted to \
         its best. Patch: three critical strains in its middle, none at its ends, in"
            .to_owned(),
        "six frames through the product’s own planner and stepper, against an even hybrid mesh of 32 points per wavelength.".to_owned(),
        format!(
            "{failed} of {runs} runs failed, {of_minres} of {minres} with MINRES, which was pushed by noise of a film \
             thickness. More numbers beside this chart in chart.csv and chart.json. Reproduce: {command}"
        ),
    ];
    for (i, line) in lines.iter().enumerate() {
        let style = Style {
            size: 13.0,
            colour: FAINT,
            ..PLAIN
        };
        drawing.text([LEFT - 40.0, SIZE[1] - 96.0 + 19.0 * i as f64], line, style);
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
    }
}
