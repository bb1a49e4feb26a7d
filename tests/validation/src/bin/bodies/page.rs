//! The page: six panels, a key, and where they come from.

use ruga_validation::plot::{Drawn, Lettering, NOTE, PLAIN, Page};

use crate::findings::{Findings, HARD_ROWS, HYBRID};
use crate::panels;

pub(crate) const SIZE: [f64; 2] = [2060.0, 1010.0];
const FIELD: [f64; 2] = [420.0, 300.0];
const CORNER: [f64; 2] = [72.0, 172.0];
/// From column to column and from row to row.
const PITCH: [f64; 2] = [508.0, 410.0];
const MARGIN: f64 = 32.0;

/// Draws all of it.
pub(crate) fn page(page: &Page<'_>, findings: &Findings, command: &str) -> Drawn {
    heading(page)?;
    panels::isocontours(page, frame(0), findings, HYBRID)?;
    panels::isocontours(page, frame(1), findings, HARD_ROWS)?;
    panels::volumes(page, frame(2), findings)?;
    panels::cell_limits(page, frame(3), findings)?;
    panels::cells(page, frame(4), findings)?;
    panels::bars(page, frame(5), findings)?;
    let [left, top, ..] = frame(6);
    panels::key(page, [left, top], findings)?;
    let line = format!(
        "Wavelengths: median distance of crossings in the same direction, at rest, in the middle half \
         of the skin. Theory: a half-space with finite strain. Reproduce: {command}"
    );
    page.text([MARGIN, SIZE[1] - 28.0], &line, NOTE)
}

fn heading(page: &Page<'_>) -> Drawn {
    let style = Lettering {
        size: 30.0,
        bold: true,
        ..PLAIN
    };
    page.text([MARGIN, 40.0], "Skins on soft bodies", style)?;
    let lines = [
        "Slabs of soft stuff on a coarse lattice, with a skin of 8 edges per wavelength on top, are pushed together to about \
         one and a half critical strains. The five thicknesses of a modulus ratio share a block,",
        "whose cells are 1.2 wavelengths of the thickest skin long; the blocks of different ratios are the same in \
         wavelengths. Cells and bar: bent slabs, the first too little to wrinkle.",
    ];
    for (i, line) in lines.iter().enumerate() {
        page.text([MARGIN, 74.0 + 19.0 * i as f64], line, NOTE)?;
    }
    Ok(())
}

/// Of the field number `index`, row by row.
fn frame(index: usize) -> [f64; 4] {
    let [column, row] = [index % 4, index / 4].map(|n| n as f64);
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
