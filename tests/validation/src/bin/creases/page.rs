//! The page: five panels, numbers, and where they come from.

use ruga_validation::fold_panel::{FoldCost, draw_folds};
use ruga_validation::plot::{Drawn, Lettering, NOTE, PLAIN, Page};

use crate::findings::Findings;
use crate::panels;

pub(crate) const SIZE: [f64; 2] = [1580.0, 1010.0];
const FIELD: [f64; 2] = [430.0, 300.0];
const CORNER: [f64; 2] = [76.0, 172.0];
/// From column to column and from row to row.
const PITCH: [f64; 2] = [512.0, 410.0];
const MARGIN: f64 = 32.0;

/// Draws all of it.
pub(crate) fn page(page: &Page<'_>, findings: &Findings, command: &str) -> Drawn {
    heading(page)?;
    draw_folds(page, frame(0), &findings.folds, FoldCost::Faces)?;
    draw_folds(page, frame(1), &findings.folds, FoldCost::Seconds)?;
    panels::onsets(page, frame(2), findings)?;
    panels::drifts(page, frame(3), findings)?;
    panels::rest(page, frame(4), findings)?;
    let [left, top, ..] = frame(5);
    panels::numbers(page, [left - 40.0, top], findings)?;
    let line = format!(
        "A skin is pressed onto a ridge whose angle grows along its line, and folds there without a moment; 8 edges along a \
         side and more. Times: one thread, without meshing. Reproduce: {command}"
    );
    page.text([MARGIN, SIZE[1] - 28.0], &line, NOTE)
}

fn heading(page: &Page<'_>) -> Drawn {
    let style = Lettering {
        size: 30.0,
        bold: true,
        ..PLAIN
    };
    page.text([MARGIN, 40.0], "Sharp creases, ours and the paper’s", style)?;
    let lines = [
        "Patkar, Jin and Fedkiw 2014 cut a mesh with virtual nodes and sew it together with linear rows: a cut keeps one vector of \
         freedom, however long it is. ruga has edges on the line",
        "and, on each, a compliance in series with its bending. Both run through the product’s energies and its solver.",
    ];
    for (i, line) in lines.iter().enumerate() {
        page.text([MARGIN, 74.0 + 19.0 * i as f64], line, NOTE)?;
    }
    Ok(())
}

/// Of the field number `index`, row by row.
fn frame(index: usize) -> [f64; 4] {
    let [column, row] = [index % 3, index / 3].map(|n| n as f64);
    let [left, top] = [CORNER[0] + column * PITCH[0], CORNER[1] + row * PITCH[1]];
    [left, top, left + FIELD[0], top + FIELD[1]]
}

#[cfg(test)]
mod tests {
    use ruga_validation::plot::write_page;

    use super::*;

    #[test]
    fn a_page_without_findings_is_a_page() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("page.png");
        let findings = Findings::default();
        write_page(&path, SIZE, 3, |own| page(own, &findings, "")).expect("a page");
    }
}
