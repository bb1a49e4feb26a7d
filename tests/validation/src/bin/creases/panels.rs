//! The panels of the page.

use ruga_material::crease_onset;
use ruga_validation::plot::colours::{BLUE, FAINT, GREEN, INK, ORANGE, PAPER, RED};
use ruga_validation::plot::{
    Axis, Colour, Drawn, HEADING, Lettering, PLAIN, Page, Panel, Shape, Stroke, Title, stroke,
};

use crate::drifts::{TIME, TIME_STEPS};
use crate::findings::Findings;
use crate::onsets::{ASLANT, FACTOR, NO_LINE, ON_LINE, kappa};
use crate::words;

/// Gaps below this are rounding and drawn at the lower edge, m.
const LEAST_GAP: f64 = 1e-17;

const STEP_COLOURS: [Colour; 3] = [RED, ORANGE, GREEN];

/// Gap of the paper's cut over time.
pub(crate) fn drifts(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let title = Title {
        name: "Drift of the paper’s cut",
        note: "upwards: log10 of the gap, m; a swinging cloth of a metre",
        across: "time, s",
    };
    let x = Axis::linear([0.0, TIME], vec![0.0, 1.0, 2.0, 3.0, 4.0]);
    let y = Axis::linear([-17.5, 0.0], vec![-16.0, -12.0, -8.0, -4.0, 0.0]);
    let panel = Panel::draw(page, frame, title, [x, y])?;
    for (i, time_step) in TIME_STEPS.into_iter().enumerate() {
        let own = findings.drifts.iter();
        for drift in own.filter(|drift| drift.time_step == time_step) {
            let values: Vec<_> = drift
                .gaps
                .iter()
                .step_by((0.02 / time_step).round() as usize)
                .map(|[t, gap]| [*t, gap.max(LEAST_GAP).log10()])
                .collect();
            let style = Stroke {
                dashed: drift.way == "pre",
                ..stroke(STEP_COLOURS[i], 2.0)
            };
            page.line(&panel.places(&values), style)?;
        }
    }
    let [_, _, right, _] = frame;
    let at = |value: f64| [right - 10.0, panel.place([TIME, value])[1]];
    let end = Lettering {
        anchor: 1.0,
        ..PLAIN
    };
    page.text(at(-5.0), "equal velocities alone (post)", end)?;
    page.text(at(-13.0), "positions too (pre dashed, both)", end)?;
    for (i, time_step) in TIME_STEPS.into_iter().enumerate() {
        let style = Lettering {
            colour: STEP_COLOURS[i],
            ..end
        };
        let text = format!("steps of {:.2} ms", 1e3 * time_step);
        page.text(at(-7.2 - 1.3 * i as f64), &text, style)?;
    }
    Ok(())
}

/// Load at which a film folds along a line.
pub(crate) fn onsets(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let title = Title {
        name: "Load at which a film folds along a line",
        note: "upwards: over that at which it wrinkles; dashed: closed form",
        across: "points per wavelength",
    };
    let ticks = vec![6.0, 12.0, 24.0, 48.0];
    let x = Axis::logarithmic(ticks.iter().copied(), 1.25).with_ticks(ticks);
    let y = Axis::linear([0.5, 1.05], vec![0.5, 0.6, 0.7, 0.8, 0.9, 1.0]);
    let panel = Panel::draw(page, frame, title, [x, y])?;
    let closed = [5.0, 60.0].map(|points| panel.place([points, crease_onset(kappa())]));
    let dashed = Stroke {
        dashed: true,
        ..stroke(INK, 1.4)
    };
    page.line(&closed, dashed)?;
    let [_, _, right, bottom] = frame;
    let ways = [
        (FACTOR, RED),
        (ASLANT, GREEN),
        (ON_LINE, BLUE),
        (NO_LINE, FAINT),
    ];
    for (line, (way, colour)) in ways.into_iter().enumerate() {
        let own = findings.onsets.iter().filter(|onset| onset.way == way);
        let values: Vec<_> = own.map(|own| [own.points as f64, own.load]).collect();
        let places = panel.places(&values);
        page.line(&places, stroke(colour, 2.4))?;
        for at in places {
            page.mark(at, Shape::Round, 5.0, [colour, PAPER])?;
        }
        let style = Lettering {
            colour,
            anchor: 1.0,
            ..PLAIN
        };
        page.text(
            [right - 10.0, bottom - 14.0 - 19.0 * line as f64],
            way,
            style,
        )?;
    }
    Ok(())
}

/// Energy on the paper's quasistatic way.
pub(crate) fn rest(page: &Page<'_>, frame: [f64; 4], findings: &Findings) -> Drawn {
    let energies = findings.rest.as_ref().map(|rest| &rest.energies[..]);
    let energies = energies.unwrap_or_default();
    let highest = energies.iter().copied().fold(1.2, f64::max);
    let title = Title {
        name: "Where the paper’s quasistatic way rests",
        note: "upwards: energy over the least, which hard rows find (dashed)",
        across: "Newton steps, each followed by a push that closes the cut",
    };
    let steps = energies.len().max(1) as f64;
    let x = Axis::linear([0.0, steps], vec![0.0, 10.0, 20.0, 30.0]);
    let ticks = (9..=30).map(|i| 0.1 * f64::from(i));
    let ticks = ticks.filter(|tick| *tick < 1.05 * highest).collect();
    let y = Axis::linear([0.95, 1.05 * highest], ticks);
    let panel = Panel::draw(page, frame, title, [x, y])?;
    let least = [0.0, steps].map(|step| panel.place([step, 1.0]));
    let dashed = Stroke {
        dashed: true,
        ..stroke(INK, 1.4)
    };
    page.line(&least, dashed)?;
    let numbered = energies.iter().zip(1..);
    let values: Vec<_> = numbered.map(|(&e, i)| [f64::from(i), e]).collect();
    page.line(&panel.places(&values), stroke(RED, 2.4))
}

/// What was found, in lines.
pub(crate) fn numbers(page: &Page<'_>, [left, top]: [f64; 2], findings: &Findings) -> Drawn {
    page.text([left, top - 29.0], "Numbers", HEADING)?;
    let style = Lettering {
        size: 12.5,
        colour: FAINT,
        ..PLAIN
    };
    for (i, line) in words::lines(findings).iter().enumerate() {
        page.text([left, top - 4.0 + 19.0 * i as f64], line, style)?;
    }
    Ok(())
}
