//! The panels of the page.

use std::f64::consts::TAU;

use ruga_validation::body::Isocontour;
use ruga_validation::plot::colours::{BLUE, FAINT, GREEN, INK, ORANGE, PAPER, RED, SKY};
use ruga_validation::plot::{
    Axis, Colour, Drawn, HEADING, Lettering, NOTE, PLAIN, Page, Panel, Shape, Stroke, Title, stroke,
};

use crate::contour::contour;
use crate::findings::{Findings, HARD_ROWS, HYBRID};
use crate::words::VOLUME;

/// Errors up to which a sample has a colour, and the colour of what has none.
const COLOURS: [(f64, Colour, &str); 4] = [
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

/// A line of measured wavelengths that are equal.
const MEASURED: Stroke = dashed(RED, 1.6);

const fn dashed(colour: Colour, width: f64) -> Stroke {
    Stroke {
        dashed: true,
        ..stroke(colour, width)
    }
}

/// Lines of equal wavelength over thickness and modulus ratio, and samples by their errors.
pub(crate) fn isocontours(
    page: &Page<'_>,
    frame: [f64; 4],
    findings: &Findings,
    coupling: &str,
) -> Drawn {
    let samples: Vec<&Isocontour> = findings.of_coupling(coupling).collect();
    let thicknesses = distinct(samples.iter().map(|own| 1e3 * own.sample.thickness));
    let ratios = distinct(samples.iter().map(|own| own.sample.ratio));
    let rounded = thicknesses.iter().map(|t| (1e3 * t).round() / 1e3);
    let x = Axis::logarithmic(thicknesses.iter().copied(), ROOM).with_ticks(rounded.collect());
    let y = Axis::logarithmic(ratios.iter().copied(), 1.35).with_ticks(ratios.clone());
    let median = findings.median_error(coupling, 1);
    let median = median.map_or(String::new(), |e| {
        format!("; median error {:.1} %", 100.0 * e)
    });
    let title = Title {
        name: match coupling {
            HYBRID => "Wavelengths with the default coupling",
            _ => "Wavelengths with hard rows",
        },
        note: &format!("upwards: Young’s modulus of skin over inside{median}"),
        across: "thickness, mm",
    };
    let panel = Panel::draw(page, frame, title, [x, y])?;
    for level in LEVELS {
        predicted_line(page, &panel, level, (&thicknesses, &ratios))?;
        for piece in contour(&samples, level) {
            let ends = piece.map(|[thickness, ratio]| panel.place([1e3 * thickness, ratio]));
            page.line(&ends, MEASURED)?;
        }
    }
    for own in samples {
        let place = panel.place([1e3 * own.sample.thickness, own.sample.ratio]);
        let colours = match own.errors()[1] {
            Some(error) => [colour(error), PAPER],
            None => [PAPER, INK],
        };
        page.mark(place, Shape::Round, DOT, colours)?;
    }
    Ok(())
}

/// Where theory has a wavelength (m), as far as the samples go.
fn predicted_line(
    page: &Page<'_>,
    panel: &Panel<'_>,
    wavelength: f64,
    (thicknesses, ratios): (&[f64], &[f64]),
) -> Drawn {
    let ends = [thicknesses, ratios].map(|all| Some((*all.first()?, *all.last()?)));
    let [Some((thin, thick)), Some((low, high))] = ends else {
        return Ok(());
    };
    let line: Vec<[f64; 2]> = (0..=100)
        .map(|step| low * (high / low).powf(f64::from(step) / 100.0))
        .map(|ratio| [1e3 * thickness(wavelength, ratio), ratio])
        .filter(|[mm, _]| (thin / ROOM..=thick * ROOM).contains(mm))
        .collect();
    let places = panel.places(&line);
    page.line(&places, stroke(GREEN, 1.8))?;
    if let Some([x, y]) = places.last().filter(|_| line.len() > 8) {
        let style = Lettering {
            colour: GREEN,
            size: 11.5,
            ..NOTE
        };
        let text = format!("{:.0}", 1e3 * wavelength);
        page.text([x + 3.0, y - 8.0], &text, style)?;
    }
    Ok(())
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

fn colour(error: f64) -> Colour {
    let found = COLOURS.iter().find(|(most, _, _)| error.abs() <= *most);
    found.map_or(RED, |(_, colour, _)| *colour)
}

/// Wavelengths of embedded skins against those of volumes.
pub(crate) fn volumes(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let pairs = findings.dense.iter();
    let lengths = pairs.flat_map(|own| [Some(own.volume), own.embedded]);
    let axis = Axis::logarithmic(lengths.flatten().map(|m| 1e3 * m), 1.15);
    let title = Title {
        name: "Against a volume",
        note: "upwards: that of the embedded skin; lines: equal, 10 % off",
        across: "wavelength of a volume of skin and block, mm",
    };
    let panel = Panel::draw(page, frame, title, [axis.clone(), axis])?;
    let lengths = findings.dense.iter().map(|own| 1e3 * own.volume);
    let (low, high) = lengths.fold((f64::MAX, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low < high {
        let off = dashed(FAINT, 1.2);
        for (share, style) in [
            (1.0, stroke(FAINT, 1.2)),
            (1.0 - VOLUME, off),
            (1.0 + VOLUME, off),
        ] {
            let ends = [low, high].map(|length| panel.place([length, share * length]));
            page.line(&ends, style)?;
        }
    }
    for own in &findings.dense {
        if let (Some(embedded), Some(error)) = (own.embedded, own.error()) {
            let place = panel.place([1e3 * own.volume, 1e3 * embedded]);
            page.mark(place, Shape::Round, DOT, [colour(error), PAPER])?;
        }
    }
    Ok(())
}

/// What lattices of different fineness do to a wavelength.
pub(crate) fn cell_limits(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let limits = findings.cell_limits.iter();
    let points: Vec<[f64; 2]> = limits
        .filter_map(|own| Some([own.cell, 100.0 * own.found.errors()[1]?]))
        .collect();
    let ends = points
        .iter()
        .fold([-20.0, 20.0], |[low, high]: [f64; 2], p| {
            [low.min(p[1]), high.max(1.1 * p[1])]
        });
    let cells: Vec<f64> = points.iter().map(|p| p[0]).collect();
    let x = Axis::logarithmic(cells.iter().copied(), ROOM).with_ticks(cells);
    let title = Title {
        name: "Fineness of the lattice",
        note: "upwards: error of the wavelength, %, with the default coupling",
        across: "wavelengths to a cell",
    };
    let y = Axis::linear(ends, multiples(20.0, ends));
    let panel = Panel::draw(page, frame, title, [x, y])?;
    page.line(&panel.places(&points), stroke(BLUE, 1.8))?;
    for point in points {
        let fill = colour(point[1] / 100.0);
        page.mark(panel.place(point), Shape::Round, DOT, [fill, PAPER])?;
    }
    Ok(())
}

/// Multiples of a step within a range.
fn multiples(step: f64, [low, high]: [f64; 2]) -> Vec<f64> {
    let counts = (low / step).ceil() as i32..=(high / step).floor() as i32;
    counts.map(|count| step * f64::from(count)).collect()
}

/// How the angle of a bent skin follows the cells.
pub(crate) fn cells(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let points = findings.artefacts.iter().flat_map(|own| &own.profile);
    let (mut x, mut y) = ([f64::MAX, 0.0_f64], 0.01_f64);
    for [place, angle] in points {
        x = [x[0].min(*place), x[1].max(*place)];
        y = y.max(angle.abs());
    }
    let x = if x[0] < x[1] { x } else { [0.0, 1.0] };
    let times = findings.smoother().map_or(String::new(), |times| {
        format!("; {times:.0} times less bending energy")
    });
    let title = Title {
        name: "Cells under a bent skin",
        note: &format!("upwards: degrees beside a smooth skin{times}"),
        across: "cells along the slab",
    };
    let tick = 0.1 * (10.0 * 0.7 * y).ceil();
    let axes = [
        Axis::linear(x, multiples(1.0, x)),
        Axis::linear([-1.1 * y, 1.1 * y], vec![-tick, 0.0, tick]),
    ];
    let panel = Panel::draw(page, frame, title, axes)?;
    for own in &findings.artefacts {
        let colour = if own.shape == "linear" { RED } else { BLUE };
        page.line(&panel.places(&own.profile), stroke(colour, 2.2))?;
    }
    Ok(())
}

/// Where a bar wrinkles that is bent at one end.
pub(crate) fn bars(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let points = findings.localities.iter().flat_map(|own| &own.profile);
    let [along, up] = points.fold([1.0_f64, 0.1], |[x, y], point| {
        [x.max(point[0]), y.max(1.05 * point[1])]
    });
    let title = Title {
        name: "A bar bent at one end",
        note: "upwards: RMS height in thicknesses; bent between the dashed lines",
        across: "along the bar, wavelengths",
    };
    let axes = [(along, 2.0), (up, 0.5)].map(|(high, step)| {
        let range = [0.0, high];
        Axis::linear(range, multiples(step, range))
    });
    let panel = Panel::draw(page, frame, title, axes)?;
    for end in findings.localities.first().map_or([0.0; 2], |own| own.bent) {
        let line = [[end, 0.0], [end, up]];
        page.line(&panel.places(&line), dashed(INK, 1.2))?;
    }
    for own in &findings.localities {
        let style = stroke(coupling_colour(&own.coupling), 1.8);
        page.line(&panel.places(&own.profile), style)?;
    }
    Ok(())
}

fn coupling_colour(coupling: &str) -> Colour {
    match coupling {
        HYBRID => BLUE,
        HARD_ROWS => RED,
        "spectral" => ORANGE,
        _ => GREEN,
    }
}

/// What marks and lines mean.
pub(crate) fn key(page: &Page<'_>, [left, top]: [f64; 2], findings: &Findings) -> Drawn {
    page.text([left, top - 6.0], "Key", HEADING)?;
    let mut y = top + 24.0;
    for (_, colour, words) in COLOURS {
        page.mark([left + 12.0, y], Shape::Round, DOT, [colour, PAPER])?;
        let text = format!("error of a wavelength {words}");
        page.text([left + 36.0, y], &text, PLAIN)?;
        y += 24.0;
    }
    let mut lines = vec![
        (
            stroke(GREEN, 2.2),
            "theory’s lines of equal wavelength, mm".to_owned(),
        ),
        (MEASURED, "the same, measured".to_owned()),
        (stroke(RED, 2.2), "cells: linear elements".to_owned()),
        (stroke(BLUE, 2.2), "cells: quadratic elements".to_owned()),
    ];
    for own in &findings.localities {
        let outside = 100.0 * own.outside;
        let text = format!("bar, {}: {outside:.2} % of squares outside", own.coupling);
        lines.push((stroke(coupling_colour(&own.coupling), 2.2), text));
    }
    for (style, text) in lines {
        page.line(&[[left, y], [left + 26.0, y]], style)?;
        page.text([left + 36.0, y], &text, PLAIN)?;
        y += 24.0;
    }
    Ok(())
}
