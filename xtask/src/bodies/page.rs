//! The page: six panels, a key, and where they come from.

use super::findings::{Findings, HARD_ROWS, HYBRID};
use super::panel::{INK, SMALL};
use super::panels;
use crate::drawing::{Drawing, Style};

const SIZE: [f64; 2] = [2060.0, 1010.0];
const FIELD: [f64; 2] = [420.0, 300.0];
const CORNER: [f64; 2] = [72.0, 172.0];
/// From column to column and from row to row.
const PITCH: [f64; 2] = [508.0, 410.0];
const MARGIN: f64 = 32.0;

/// All of it.
pub(super) fn page(findings: &Findings, command: &str) -> Drawing {
    let mut drawing = Drawing::new(SIZE);
    heading(&mut drawing);
    panels::isocontours(&mut drawing, frame(0), findings, HYBRID);
    panels::isocontours(&mut drawing, frame(1), findings, HARD_ROWS);
    panels::volumes(&mut drawing, frame(2), findings);
    panels::cell_limits(&mut drawing, frame(3), findings);
    panels::cells(&mut drawing, frame(4), findings);
    panels::bars(&mut drawing, frame(5), findings);
    let [left, top, ..] = frame(6);
    panels::key(&mut drawing, [left, top], findings);
    let line = format!(
        "Wavelengths: median distance of crossings in the same direction, at rest, in the middle half \
         of the skin. Theory: a half-space with finite strain. Reproduce: {command}"
    );
    drawing.text([MARGIN, SIZE[1] - 24.0], &line, SMALL);
    drawing
}

fn heading(drawing: &mut Drawing) {
    let style = Style {
        size: 30.0,
        colour: INK,
        bold: true,
        ..SMALL
    };
    drawing.text([MARGIN, 50.0], "Skins on soft bodies", style);
    let lines = [
        "Slabs of soft stuff on a coarse lattice, with a skin of 8 edges per wavelength on top, are pushed together to about \
         one and a half critical strains. The five thicknesses of a modulus ratio share a block,",
        "whose cells are 1.2 wavelengths of the thickest skin long; the blocks of different ratios are the same in \
         wavelengths. Cells and bar: bent slabs, the first too little to wrinkle.",
    ];
    for (i, line) in lines.iter().enumerate() {
        let style = Style {
            size: 13.5,
            ..SMALL
        };
        drawing.text([MARGIN, 78.0 + 19.0 * i as f64], line, style);
    }
}

/// Of the field number `index`, row by row.
fn frame(index: usize) -> [f64; 4] {
    let [column, row] = [index % 4, index / 4].map(|n| n as f64);
    let [left, top] = [CORNER[0] + column * PITCH[0], CORNER[1] + row * PITCH[1]];
    [left, top, left + FIELD[0], top + FIELD[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_without_findings_is_a_page() {
        let page = page(&Findings::default(), "cargo xtask bodies");
        assert!(page.svg().contains("Reproduce: cargo xtask bodies"));
        assert!(page.png(0.2).is_ok());
    }
}
