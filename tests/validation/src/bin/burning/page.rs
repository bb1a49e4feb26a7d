//! The page: a panel for each thickness, numbers, and where they come from.

use ruga_validation::plot::colours::{BLUE, FAINT, PAPER, RED};
use ruga_validation::plot::{
    Axis, Drawn, HEADING, Lettering, NOTE, PLAIN, Page, Panel, Shape, Title, stroke,
};

use crate::findings::{Curl, Findings, THICKNESSES};
use crate::words;

pub(crate) const SIZE: [f64; 2] = [1580.0, 600.0];
const FIELD: [f64; 2] = [430.0, 300.0];
const CORNER: [f64; 2] = [76.0, 172.0];
/// From column to column.
const PITCH: f64 = 512.0;
const MARGIN: f64 = 32.0;

/// Draws all of it.
pub(crate) fn page(page: &Page<'_>, findings: &Findings, command: &str) -> Drawn {
    heading(page)?;
    for (column, thickness) in THICKNESSES.into_iter().enumerate() {
        curl(page, column, findings, thickness)?;
    }
    let left = CORNER[0] + 2.0 * PITCH - 40.0;
    page.text([left, CORNER[1] - 29.0], "Numbers", HEADING)?;
    let style = Lettering {
        size: 12.5,
        colour: FAINT,
        ..PLAIN
    };
    for (i, line) in words::lines(findings).iter().enumerate() {
        page.text([left, CORNER[1] - 4.0 + 19.0 * i as f64], line, style)?;
    }
    let line = format!(
        "A free strip ten times as long as wide, flat at first; springs 40 by 4 cells. Times: one thread, springs \
         without setting up, ruga without meshing. ruga's errors below 0.1 % are its solver's tolerance. Reproduce: \
         {command}"
    );
    page.text([MARGIN, SIZE[1] - 28.0], &line, NOTE)
}

fn heading(page: &Page<'_>) -> Drawn {
    let style = Lettering {
        size: 30.0,
        bold: true,
        ..PLAIN
    };
    page.text(
        [MARGIN, 40.0],
        "Curl of a burning sheet, ours and the paper’s",
        style,
    )?;
    let lines = [
        "Jeong, Kim and Kim 2011 shorten one of two layers of springs and project on to one set of lengths after \
         another: how far a sheet curls depends on how often that is done, on the cells",
        "and on the distance of the layers. ruga gives a shell a natural curvature and finds the least energy.",
    ];
    for (i, line) in lines.iter().enumerate() {
        page.text([MARGIN, 74.0 + 19.0 * i as f64], line, NOTE)?;
    }
    Ok(())
}

/// Error of the curl over processor time, of both methods.
fn curl(page: &Page<'_>, column: usize, findings: &Findings, thickness: f64) -> Drawn {
    let left = CORNER[0] + PITCH * column as f64;
    let frame = [left, CORNER[1], left + FIELD[0], CORNER[1] + FIELD[1]];
    let name = format!("Layers {thickness} of a cell apart");
    let title = Title {
        name: &name,
        note: "upwards: curvature off by, %; numbers: projections, triangles across",
        across: "processor time, ms",
    };
    let all = findings.curls.iter();
    let own: Vec<&Curl> = all.filter(|own| own.thickness == thickness).collect();
    let place = |own: &Curl| [1e3 * own.seconds, 100.0 * own.error()];
    let [x, y] = [0, 1].map(|side| {
        let values = own.iter().map(|own| place(own)[side]);
        Axis::logarithmic(values, 1.8)
    });
    let panel = Panel::draw(page, frame, title, [x, y])?;
    for (is_springs, name, colour) in [(true, "springs (the paper)", RED), (false, "ruga", BLUE)] {
        let runs = own.iter().filter(|own| own.is_springs == is_springs);
        let runs: Vec<_> = runs.map(|own| (own.number, place(own))).collect();
        let values: Vec<_> = runs.iter().map(|run| run.1).collect();
        let places = panel.places(&values);
        page.line(&places, stroke(colour, 2.4))?;
        let style = Lettering { colour, ..PLAIN };
        for (at, (number, _)) in places.into_iter().zip(&runs) {
            page.mark(at, Shape::Round, 5.0, [colour, PAPER])?;
            let above = Lettering {
                anchor: 0.5,
                ..style
            };
            page.text([at[0], at[1] - 14.0], &number.to_string(), above)?;
        }
        let line = frame[3] - if is_springs { 34.0 } else { 15.0 };
        page.text([left + 10.0, line], name, style)?;
    }
    Ok(())
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
