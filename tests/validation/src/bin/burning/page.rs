//! The page: a panel for each thickness, the paper's figure 8, numbers, pictures, and where they come from.

use ruga_validation::curl_panel::{THICKNESSES, draw_curls};
use ruga_validation::plot::colours::{BLUE, FAINT, GREEN, ORANGE, RED};
use ruga_validation::plot::{
    Axis, Colour, Drawn, HEADING, Lettering, NOTE, PLAIN, Page, Panel, Title, stroke,
};

use crate::findings::Findings;
use crate::words;

pub(crate) const SIZE: [f64; 2] = [1580.0, 1010.0];
const FIELD: [f64; 2] = [430.0, 300.0];
const CORNER: [f64; 2] = [76.0, 172.0];
/// From column to column and from row to row.
const PITCH: [f64; 2] = [512.0, 410.0];
const MARGIN: f64 = 32.0;

/// Draws all of it.
pub(crate) fn page(page: &Page<'_>, findings: &Findings, command: &str) -> Drawn {
    heading(page)?;
    for (column, thickness) in THICKNESSES.into_iter().enumerate() {
        draw_curls(page, frame(column, 0), &findings.curls, thickness)?;
    }
    errors(page, frame(0, 1), findings)?;
    let [left, top, ..] = frame(1, 1);
    pictures(page, [left, top], findings)?;
    let left = CORNER[0] + 2.0 * PITCH[0] - 40.0;
    page.text([left, CORNER[1] - 29.0], "Numbers", HEADING)?;
    let style = Lettering {
        size: 12.5,
        colour: FAINT,
        ..PLAIN
    };
    for (i, line) in words::lines(findings).iter().enumerate() {
        page.text([left, CORNER[1] - 4.0 + 19.0 * i as f64], line, style)?;
    }
    let lines = [
        "A free strip ten times as long as wide, flat at first; springs 40 by 4 cells. Times: one thread, springs without setting \
         up, ruga without meshing. ruga’s errors below 0.1 % are its solver’s tolerance."
            .to_owned(),
        format!("Reproduce: {command}"),
    ];
    for (i, line) in lines.iter().enumerate() {
        page.text([MARGIN, SIZE[1] - 47.0 + 19.0 * i as f64], line, NOTE)?;
    }
    Ok(())
}

/// Of the field in a column and a row.
fn frame(column: usize, row: usize) -> [f64; 4] {
    let [left, top] = [
        CORNER[0] + column as f64 * PITCH[0],
        CORNER[1] + row as f64 * PITCH[1],
    ];
    [left, top, left + FIELD[0], top + FIELD[1]]
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

/// Norms of the constraints over projection steps, a line a set and one for their sum: the paper's figure 8.
fn errors(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let title = Title {
        name: "Constraints over projection steps (figure 8)",
        note: "upwards: norm of C, cells; one layer 10 % shorter at once",
        across: "projection steps",
    };
    let all = &findings.errors;
    let steps = all.len().max(2) as f64 - 1.0;
    let ticks = (0..=5).map(|k| 10.0 * f64::from(k));
    let x = Axis::linear([0.0, steps], ticks.filter(|t| *t <= steps).collect());
    let y = Axis::logarithmic(all.iter().flatten().map(|c| c.max(LEAST)), 1.5);
    let panel = Panel::draw(page, frame, title, [x, y])?;
    for (index, (name, colour)) in SETS.into_iter().enumerate() {
        let value = |own: &[f64; 4]| own.get(index).copied().unwrap_or_else(|| own.iter().sum());
        let values: Vec<_> = all
            .iter()
            .enumerate()
            .map(|(i, own)| [i as f64, value(own).max(LEAST)])
            .collect();
        page.line(&panel.places(&values), stroke(colour, 2.2))?;
        let [_, top, right, _] = frame;
        let style = Lettering {
            colour,
            anchor: 1.0,
            ..PLAIN
        };
        // In a row at the top, where only the first steps come.
        let from_right = 10.0 + 62.0 * (SETS.len() - 1 - index) as f64;
        page.text([right - from_right, top + 14.0], name, style)?;
    }
    Ok(())
}

/// Names and colours of the sets, and of their sum.
const SETS: [(&str, Colour); 5] = [
    ("red", RED),
    ("green", GREEN),
    ("blue", BLUE),
    ("yellow", ORANGE),
    ("sum", FAINT),
];

/// Norm of constraints (cells) below which all are drawn alike: sets that are met at first have none.
const LEAST: f64 = 1e-2;

/// Pictures with their times.
fn pictures(page: &Page<'_>, [left, top]: [f64; 2], findings: &Findings) -> Drawn {
    page.text(
        [left, top - 29.0],
        "Pictures after the paper’s figures",
        HEADING,
    )?;
    let note = "After captions and text alone: the paper’s own pictures are not at hand. What was measured is in burning.txt.";
    page.text([left, top - 4.0], note, NOTE)?;
    for (i, own) in findings.pictures.iter().enumerate() {
        let what: String = own.what.split(';').next().unwrap_or_default().to_owned();
        let by = match own.springs {
            0 => "ruga".to_owned(),
            springs => format!("{springs} springs"),
        };
        let per_step = 1e3 * own.seconds / own.steps.max(1) as f64;
        let line = format!("{}: {what} ({by}, {per_step:.0} ms a step)", own.file);
        page.text([left, top + 24.0 + 21.0 * i as f64], &line, NOTE)?;
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
