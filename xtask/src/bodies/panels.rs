//! The panels of the page.

use std::f64::consts::TAU;

use super::contour::contour;
use super::findings::{Findings, HARD_ROWS, HYBRID, Sample};
use super::panel::{FAINT, Frame, INK, Panel, SMALL, Title};
use super::ruler::Ruler;
use super::words::VOLUME;
use crate::drawing::{Drawing, Style};

/// Colours by Okabe and Ito, told apart by all.
const BLUE: &str = "#0072b2";
const SKY: &str = "#56b4e9";
const ORANGE: &str = "#e69f00";
const RED: &str = "#d55e00";
const GREEN: &str = "#009e73";

/// Errors up to which a sample has a colour, and the colour of what has none.
const COLOURS: [(f64, &str, &str); 4] = [
    (0.02, BLUE, "up to 2 %"),
    (0.05, SKY, "up to 5 %"),
    (0.1, ORANGE, "up to 10 %"),
    (f64::INFINITY, RED, "more"),
];

/// Wavelengths that are drawn as lines, m.
const LEVELS: [f64; 10] = [
    5e-3, 6e-3, 8e-3, 10e-3, 12e-3, 15e-3, 20e-3, 25e-3, 30e-3, 40e-3,
];

/// Radius of a sample.
const DOT: f64 = 6.0;

/// Room around values on a logarithmic side.
const ROOM: f64 = 1.08;

/// Lines of equal wavelength over thickness and modulus ratio, and samples by their errors.
pub(super) fn isocontours(
    drawing: &mut Drawing,
    frame: Frame,
    findings: &Findings,
    coupling: &str,
) {
    let samples: Vec<&Sample> = findings.of(coupling).collect();
    let thicknesses = distinct(samples.iter().map(|own| 1e3 * own.thickness));
    let ratios = distinct(samples.iter().map(|own| own.ratio));
    let x = Ruler::logarithmic(thicknesses.iter().copied(), ROOM);
    let y = Ruler::logarithmic(ratios.iter().copied(), 1.35);
    let panel = Panel::new(frame, [x, y]);
    let name = match coupling {
        HYBRID => "Wavelengths with the default coupling",
        _ => "Wavelengths with hard rows",
    };
    let median = findings
        .median_error(coupling, 1)
        .map_or(String::new(), |e| {
            format!("; median error {:.1} %", 100.0 * e)
        });
    let title = Title {
        name,
        note: &format!("upwards: Young’s modulus of skin over inside{median}"),
        across: "thickness, mm",
    };
    let ticks: Vec<f64> = thicknesses
        .iter()
        .map(|t| (1e3 * t).round() / 1e3)
        .collect();
    panel.draw_axes(drawing, &title, [&ticks, &ratios]);
    for level in LEVELS {
        predicted_line(&panel, drawing, level, (&thicknesses, &ratios));
        for piece in contour(&samples, level) {
            let ends = piece.map(|[thickness, ratio]| [1e3 * thickness, ratio]);
            panel.draw_line(drawing, &ends, (RED, 1.6, "6 4"));
        }
    }
    for own in samples {
        let place = panel.place([1e3 * own.thickness, own.ratio]);
        match own.errors()[1] {
            Some(error) => drawing.circle(place, DOT, colour(error), ("#ffffff", 1.0)),
            None => drawing.circle(place, DOT, "#ffffff", (INK, 1.5)),
        }
    }
}

/// Where theory has a wavelength (m), as far as the samples go.
fn predicted_line(
    panel: &Panel,
    drawing: &mut Drawing,
    wavelength: f64,
    (thicknesses, ratios): (&[f64], &[f64]),
) {
    let [Some(low), Some(high)] = [ratios.first(), ratios.last()] else {
        return;
    };
    let [thin, thick] = [
        thicknesses[0] / ROOM,
        thicknesses[thicknesses.len() - 1] * ROOM,
    ];
    let line: Vec<[f64; 2]> = (0..=100)
        .map(|step| low * (high / low).powf(f64::from(step) / 100.0))
        .map(|ratio| [1e3 * thickness(wavelength, ratio), ratio])
        .filter(|[mm, _]| (thin..=thick).contains(mm))
        .collect();
    panel.draw_line(drawing, &line, (GREEN, 1.8, ""));
    if let Some(end) = line.last().filter(|_| line.len() > 8) {
        let [x, y] = panel.place(*end);
        let style = Style {
            colour: GREEN,
            size: 11.5,
            ..SMALL
        };
        drawing.text(
            [x + 3.0, y - 4.0],
            &format!("{:.0}", 1e3 * wavelength),
            style,
        );
    }
}

/// Of a skin (m) whose waves are so long (m): `lambda = 2 pi h (r/3)^(1/3) (1 + eps_c/2)` with
/// `eps_c = (3/r)^(2/3)/4`, for the Poisson ratios of skin and inside are the same.
fn thickness(wavelength: f64, ratio: f64) -> f64 {
    let strain = 0.25 * (3.0 / ratio).powf(2.0 / 3.0);
    wavelength / ((1.0 + 0.5 * strain) * TAU * (ratio / 3.0).cbrt())
}

fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn colour(error: f64) -> &'static str {
    let found = COLOURS.iter().find(|(most, _, _)| error.abs() <= *most);
    found.map_or(RED, |(_, colour, _)| colour)
}

/// Wavelengths of embedded skins against those of volumes.
pub(super) fn volumes(drawing: &mut Drawing, frame: Frame, findings: &Findings) {
    let pairs = findings.dense.iter();
    let lengths = pairs.flat_map(|own| [Some(own.volume), own.embedded]);
    let ruler = Ruler::logarithmic(lengths.flatten().map(|m| 1e3 * m), 1.15);
    let panel = Panel::new(frame, [ruler, ruler]);
    let title = Title {
        name: "Against a volume",
        note: "upwards: that of the embedded skin; lines: equal, 10 % off",
        across: "wavelength of a volume of skin and block, mm",
    };
    let ticks = [5.0, 10.0, 20.0, 50.0];
    let lengths = findings.dense.iter().map(|own| 1e3 * own.volume);
    let (low, high) = lengths.fold((f64::MAX, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    let shown: Vec<f64> = ticks
        .into_iter()
        .filter(|tick| (low / 1.15..=high * 1.15).contains(tick))
        .collect();
    panel.draw_axes(drawing, &title, [&shown, &shown]);
    if findings.dense.is_empty() {
        return;
    }
    for (share, dash) in [(1.0, ""), (1.0 - VOLUME, "3 4"), (1.0 + VOLUME, "3 4")] {
        let ends = [low, high].map(|length| [length, share * length]);
        panel.draw_line(drawing, &ends, (FAINT, 1.2, dash));
    }
    for own in &findings.dense {
        if let (Some(embedded), Some(error)) = (own.embedded, own.error()) {
            let place = panel.place([1e3 * own.volume, 1e3 * embedded]);
            drawing.circle(place, DOT, colour(error), ("#ffffff", 1.0));
        }
    }
}

/// What lattices of different fineness do to a wavelength.
pub(super) fn cell_limits(drawing: &mut Drawing, frame: Frame, findings: &Findings) {
    let limits = findings.cell_limits.iter();
    let points: Vec<[f64; 2]> = limits
        .filter_map(|own| Some([own.cell, 100.0 * own.error?]))
        .collect();
    let ends = points
        .iter()
        .fold([-20.0, 20.0], |[low, high]: [f64; 2], p| {
            [low.min(p[1]), high.max(1.1 * p[1])]
        });
    let x = Ruler::logarithmic(points.iter().map(|p| p[0]), ROOM);
    let panel = Panel::new(frame, [x, Ruler::linear(ends)]);
    let title = Title {
        name: "Fineness of the lattice",
        note: "upwards: error of the wavelength, %, with the default coupling",
        across: "wavelengths to a cell",
    };
    let cells: Vec<f64> = points.iter().map(|p| p[0]).collect();
    let up: Vec<f64> = (-10..=10)
        .map(|i| 20.0 * f64::from(i))
        .filter(|tick| (ends[0]..=ends[1]).contains(tick))
        .collect();
    panel.draw_axes(drawing, &title, [&cells, &up]);
    panel.draw_line(drawing, &points, (BLUE, 1.8, ""));
    for point in points {
        let fill = colour(point[1] / 100.0);
        drawing.circle(panel.place(point), DOT, fill, ("#ffffff", 1.0));
    }
}

/// How the angle of a bent skin follows the cells.
pub(super) fn cells(drawing: &mut Drawing, frame: Frame, findings: &Findings) {
    let points = findings.artefacts.iter().flat_map(|own| &own.profile);
    let (mut x, mut y) = ([f64::MAX, 0.0_f64], 0.01_f64);
    for [place, angle] in points {
        x = [x[0].min(*place), x[1].max(*place)];
        y = y.max(angle.abs());
    }
    let x = if x[0] < x[1] { x } else { [0.0, 1.0] };
    let panel = Panel::new(
        frame,
        [Ruler::linear(x), Ruler::linear([-1.1 * y, 1.1 * y])],
    );
    let times = findings.smoother().map_or(String::new(), |times| {
        format!("; {times:.0} times less bending energy")
    });
    let title = Title {
        name: "Cells under a bent skin",
        note: &format!("upwards: degrees beside a smooth skin{times}"),
        across: "cells along the slab",
    };
    let whole: Vec<f64> = (x[0].ceil() as i32..=x[1].floor() as i32)
        .map(f64::from)
        .collect();
    let tick = 0.1 * (10.0 * 0.7 * y).ceil();
    panel.draw_axes(drawing, &title, [&whole, &[-tick, 0.0, tick]]);
    for own in &findings.artefacts {
        let colour = if own.shape == "linear" { RED } else { BLUE };
        panel.draw_line(drawing, &own.profile, (colour, 2.2, ""));
    }
}

/// Where a bar wrinkles that is bent at one end.
pub(super) fn bars(drawing: &mut Drawing, frame: Frame, findings: &Findings) {
    let points = findings.localities.iter().flat_map(|own| &own.profile);
    let high = points.fold([1.0_f64, 0.1], |[x, y], point| {
        [x.max(point[0]), y.max(point[1])]
    });
    let panel = Panel::new(
        frame,
        [
            Ruler::linear([0.0, high[0]]),
            Ruler::linear([0.0, 1.05 * high[1]]),
        ],
    );
    let title = Title {
        name: "A bar bent at one end",
        note: "upwards: RMS height of its skin, in thicknesses; bent between the dashed lines",
        across: "along the bar, wavelengths",
    };
    let along: Vec<f64> = (0..=high[0] as i32 / 2).map(|i| f64::from(2 * i)).collect();
    let up: Vec<f64> = (0..=(2.0 * high[1]) as i32)
        .map(|i| 0.5 * f64::from(i))
        .collect();
    panel.draw_axes(drawing, &title, [&along, &up]);
    if let Some(own) = findings.localities.first() {
        for end in own.bent {
            let line = [[end, 0.0], [end, 1.05 * high[1]]];
            panel.draw_line(drawing, &line, (INK, 1.2, "4 4"));
        }
    }
    for own in &findings.localities {
        panel.draw_line(
            drawing,
            &own.profile,
            (coupling_colour(&own.coupling), 1.8, ""),
        );
    }
}

fn coupling_colour(coupling: &str) -> &'static str {
    match coupling {
        HYBRID => BLUE,
        HARD_ROWS => RED,
        "spectral" => ORANGE,
        _ => GREEN,
    }
}

/// What marks and lines mean.
pub(super) fn key(drawing: &mut Drawing, [left, top]: [f64; 2], findings: &Findings) {
    let style = Style {
        size: 17.0,
        colour: INK,
        bold: true,
        ..SMALL
    };
    drawing.text([left, top], "Key", style);
    let style = Style {
        size: 13.5,
        colour: INK,
        ..SMALL
    };
    let mut y = top + 28.0;
    for (_, colour, words) in COLOURS {
        drawing.circle([left + 12.0, y - 4.5], DOT, colour, ("#ffffff", 1.0));
        let text = format!("error of a wavelength {words}");
        drawing.text([left + 36.0, y], &text, style);
        y += 24.0;
    }
    let mut lines = vec![
        (
            GREEN,
            "",
            "theory’s lines of equal wavelength, mm".to_owned(),
        ),
        (RED, "6 4", "the same, measured".to_owned()),
        (RED, "", "cells: linear elements".to_owned()),
        (BLUE, "", "cells: quadratic elements".to_owned()),
    ];
    for own in &findings.localities {
        let outside = 100.0 * own.outside;
        let text = format!("bar, {}: {outside:.2} % of squares outside", own.coupling);
        lines.push((coupling_colour(&own.coupling), "", text));
    }
    for (colour, dash, text) in lines {
        let stroke = [[left, y - 4.5], [left + 26.0, y - 4.5]];
        drawing.line(&stroke, colour, 2.2, dash);
        drawing.text([left + 36.0, y], &text, style);
        y += 24.0;
    }
}
