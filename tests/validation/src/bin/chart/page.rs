//! The pages: panels of a film and of a patch, a key, what they say, and where they come from; and a
//! summary of that.

use ruga_validation::curl_panel::{CurlRun, THICKNESSES, draw_curls};
use ruga_validation::fold_panel::{FoldCost, FoldRun, draw_folds};
use ruga_validation::plot::{Drawn, Lettering, NOTE, PLAIN, Page};

use crate::key::key;
use crate::panel;
use crate::results::{Measure, Point};
use crate::setting::Solver;
use crate::verdict::ratios;
use crate::words;

/// Cells in rows.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) size: [f64; 2],
    /// Of the first row of fields.
    top: f64,
    /// From row to row.
    pitch: f64,
    columns: usize,
}

/// Of [`page`].
pub(crate) const PAGE: Layout = Layout {
    size: [1560.0, 2025.0],
    top: 184.0,
    pitch: 446.0,
    columns: 3,
};

/// Of [`summary`].
pub(crate) const SUMMARY: Layout = Layout {
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

/// Draws all of it.
pub(crate) fn page(
    page: &Page<'_>,
    (points, folds, curls): (&[Point], &[FoldRun], &[CurlRun]),
    command: &str,
) -> Drawn {
    let lines = [
        "Above: a stiff film on a soft base (150 : 1), compressed to two and to four critical strains. Below: a patch, \
         as a user has it. Down and to the left is better. Medians over seeds, whiskers to the best and the worst.",
        PAPERS_WAY,
    ];
    heading(page, points, &lines)?;
    let film = [
        Measure::Normals,
        Measure::Wavelength,
        Measure::Amplitude,
        Measure::Onset,
    ];
    let patch = [
        Measure::PatchNormals,
        Measure::PatchWavelength,
        Measure::PatchAmplitude,
    ];
    panels(page, PAGE, points, (&film, 0))?;
    panels(page, PAGE, points, (&patch, 6))?;
    key(page, PAGE.corner(4), points)?;
    draw_folds(page, PAGE.frame(5), folds, FoldCost::Seconds)?;
    for (i, thickness) in THICKNESSES.into_iter().enumerate() {
        draw_curls(page, PAGE.frame(9 + i), curls, thickness)?;
    }
    curl_lines(page, PAGE.corner(11), curls)?;
    caption(page, points, command)
}

/// What the panels of curl say.
fn curl_lines(page: &Page<'_>, [left, top]: [f64; 2], curls: &[CurlRun]) -> Drawn {
    for (i, line) in words::curls(curls).iter().enumerate() {
        page.text([left, top + 19.0 * i as f64], line, NOTE)?;
    }
    Ok(())
}

/// Draws what matters most, for those who will not read more.
pub(crate) fn summary(page: &Page<'_>, points: &[Point], command: &str) -> Drawn {
    let lines = [
        "A stiff film on a soft base (150 : 1), compressed to two and to four critical strains, against the exact wrinkles. \
         Down and to the",
        "left is better. Medians over seeds, whiskers to the best and the worst. Along each line 4, 6, 8, 12, 16, 24 mesh edges \
         per wavelength.",
        PAPERS_WAY,
    ];
    heading(page, points, &lines)?;
    let film = [Measure::Normals, Measure::Wavelength, Measure::Amplitude];
    panels(page, SUMMARY, points, (&film, 0))?;
    key(page, SUMMARY.corner(3), points)?;
    let line = format!("Times: one thread, everything but measuring. Reproduce: {command}");
    page.text([MARGIN, SUMMARY.size[1] - 28.0], &line, NOTE)
}

/// Panels of one problem from a cell on, with one axis of costs.
fn panels(
    page: &Page<'_>,
    layout: Layout,
    points: &[Point],
    (measures, first): (&[Measure], usize),
) -> Drawn {
    for (i, &measure) in measures.iter().enumerate() {
        let frame = layout.frame(first + i);
        let costs = panel::costs(points, measure);
        panel::draw(page, frame, costs, points, measure)?;
    }
    Ok(())
}

impl Layout {
    fn corner(self, cell: usize) -> [f64; 2] {
        let [column, row] = [cell % self.columns, cell / self.columns].map(|n| n as f64);
        [LEFT + column * PITCH, self.top + row * self.pitch]
    }

    /// Of a field: left, top, right, bottom.
    fn frame(self, cell: usize) -> [f64; 4] {
        let [left, top] = self.corner(cell);
        [left, top, left + FIELD[0], top + FIELD[1]]
    }
}

fn heading(page: &Page<'_>, points: &[Point], lines: &[&str]) -> Drawn {
    let style = Lettering {
        size: 30.0,
        bold: true,
        ..PLAIN
    };
    page.text([MARGIN, 40.0], "Wrinkles: speed against accuracy", style)?;
    let style = Lettering {
        size: 17.0,
        ..PLAIN
    };
    page.text([MARGIN, 74.0], &headline(points), style)?;
    notes(page, 99.0, lines)
}

/// What is meant by the papers' way.
const PAPERS_WAY: &str = "The papers’ way: averaging constraints alone, sampled by area; bending at edges; a uniform mesh; an iterative solver (MINRES).";

/// Lines from a height on.
fn notes(page: &Page<'_>, top: f64, lines: &[&str]) -> Drawn {
    for (i, line) in lines.iter().enumerate() {
        page.text([MARGIN, top + 19.0 * i as f64], line, NOTE)?;
    }
    Ok(())
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

fn caption(page: &Page<'_>, points: &[Point], command: &str) -> Drawn {
    let runs: usize = points.iter().map(|p| p.runs).sum();
    let failed: usize = points.iter().map(|p| p.failed).sum();
    let is_iterated = |p: &&Point| p.setting.method.solver == Solver::Minres;
    let iterated = points.iter().filter(is_iterated);
    let (of_minres, minres) = iterated.fold((0, 0), |(f, r), p| (f + p.failed, r + p.runs));
    let last = format!(
        "{failed} of {runs} runs failed, {of_minres} of {minres} with MINRES, which was pushed by noise of a film \
         thickness. More numbers beside this chart in chart.json. Reproduce: {command}"
    );
    let lines = [
        "Along each line 4, 6, 8, 12, 16, 24 mesh edges per wavelength. Pale marks: other samplings of the averaging \
         constraints (area, adjusted, quadrature), meshes and solvers. Errors under 0.05 % are drawn at the lower edge.",
        "Film: against the continuum with finite strains. Its compression fades out towards both ends, so that these do \
         not set its wavelength; the border takes half a per cent of the onset.",
        "Normals: along lines across the wrinkles, each shifted to its best. Patch: three critical strains in its middle, \
         none at its ends, against an even hybrid mesh of 32 edges per wavelength.",
        "Creases: a skin pressed onto a ridge whose angle grows along its line, 8 edges along a side and more; the paper is Patkar, \
         Jin and Fedkiw 2014. Times: one thread, everything but measuring, and of creases and curl meshing.",
        "Curl: a free strip ten times as long as wide, one of whose sides is 2 % shorter; the paper is Jeong, Kim and Kim 2011, \
         springs of 40 by 4 cells, without setting up. ruga’s errors below 0.1 % are its solver’s tolerance.",
        &last,
    ];
    notes(page, PAGE.size[1] - 119.0, &lines)
}

#[cfg(test)]
mod tests {
    use ruga_validation::plot::write_page;

    use super::*;
    use crate::results::points;

    #[test]
    fn pages_without_a_single_run_are_pages() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, none) = (folder.path().join("page.png"), points(&[], &[]));
        write_page(&path, PAGE.size, 3, |own| page(own, (&none, &[], &[]), "")).expect("a page");
        write_page(&path, SUMMARY.size, 3, |own| summary(own, &none, "")).expect("a summary");
    }
}
