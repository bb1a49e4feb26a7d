//! What was found, against its goals, in words.

use std::fmt::Write;

use serde_json::Value;

use super::findings::{Findings, HARD_ROWS, HYBRID, Thrown};

/// Median error of the wavelength that the default may have.
pub(super) const WAVELENGTH: f64 = 0.05;

/// Error against a volume that none may have.
pub(super) const VOLUME: f64 = 0.1;

/// How many times less cells have to show with quadratic elements.
const SMOOTHER: f64 = 5.0;

/// Share of the squared heights that local coupling may leave outside.
const OUTSIDE: f64 = 0.05;

/// All of it, a goal to a line.
pub(super) fn words(findings: &Findings) -> String {
    let mut text = String::new();
    for coupling in [HYBRID, HARD_ROWS] {
        wavelengths(&mut text, findings, coupling);
    }
    volumes(&mut text, findings);
    cell_limits(&mut text, findings);
    if let Some(times) = findings.smoother() {
        let verdict = verdict(times >= SMOOTHER);
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(
            text,
            "cells (figure 4): {times:.0} times less bending energy beside a smooth skin with quadratic elements, at least {SMOOTHER:.0}: {verdict}"
        );
    }
    for own in &findings.artefacts {
        let _ = writeln!(
            text,
            "  {}: {:.4} of the smooth skin's energy, {:.3} degrees RMS",
            own.shape, own.energy, own.angle_deg
        );
    }
    for own in &findings.localities {
        let failed = if own.converged { "" } else { ", NOT CONVERGED" };
        // Global functions are there for comparison.
        let goal = match own.coupling.as_str() {
            "spectral" => String::new(),
            _ => format!(
                ", at most {:.0} %: {}",
                100.0 * OUTSIDE,
                verdict(own.outside <= OUTSIDE)
            ),
        };
        let _ = writeln!(
            text,
            "locality (figure 3), {}: {:.2} % of the squared heights outside the bent part{goal}{failed}",
            own.coupling,
            100.0 * own.outside
        );
    }
    for own in &findings.thrown {
        let _ = writeln!(text, "{}", thrown(own));
    }
    text
}

/// Way out of its room, in heights, that a cushion may have: obstacles give a little; and heights
/// between which it may be.
const OUTSIDE_ROOM: f64 = 0.05;
const HEIGHTS: [f64; 2] = [0.3, 1.2];

fn thrown(own: &Thrown) -> String {
    let [low, high] = own.heights;
    let is_whole = low > HEIGHTS[0] && high < HEIGHTS[1] && own.outside < OUTSIDE_ROOM;
    let holds = own.converged && own.frames == own.steps && is_whole;
    format!(
        "thrown, steps of {} s: {} of {} made, {:.2} to {:.2} of its height, {:.3} of it out of its room, {:.1} factorisations a step: {}",
        own.time_step,
        own.frames,
        own.steps,
        low,
        high,
        own.outside,
        own.factorizations / own.frames,
        verdict(holds)
    )
}

fn verdict(is_met: bool) -> &'static str {
    if is_met { "met" } else { "MISSED" }
}

fn wavelengths(text: &mut String, findings: &Findings, coupling: &str) {
    let [Some(early), Some(late)] = [0, 1].map(|key| findings.median_error(coupling, key)) else {
        return;
    };
    let errors = findings.of(coupling).filter_map(|own| own.errors()[1]);
    let worst = errors.fold(0.0, |m: f64, error| m.max(error.abs()));
    let count = findings.of(coupling).count();
    let failed = findings
        .of(coupling)
        .filter(|own| !own.converged || own.measured[1].is_none());
    let demands = findings.of(coupling).map(|own| own.demand[1]);
    let (low, high) = demands.fold((f64::MAX, 0.0_f64), |(l, h), d| (l.min(d), h.max(d)));
    let _ = write!(
        text,
        "wavelength (figure 7), {coupling}: median error {:.1} % of {count} samples at {low:.2} to {high:.2} critical strains, worst {:.1} %; {:.1} % soon after the onset; {} failed",
        100.0 * late,
        100.0 * worst,
        100.0 * early,
        failed.count(),
    );
    let goal = match coupling {
        HYBRID => format!(
            "; under {:.0} %: {}",
            100.0 * WAVELENGTH,
            verdict(late < WAVELENGTH)
        ),
        _ => String::new(),
    };
    let _ = writeln!(text, "{goal}");
}

fn volumes(text: &mut String, findings: &Findings) {
    let errors = findings.dense.iter().map(|own| own.error());
    let worst = errors.fold(0.0, |m: f64, error| {
        m.max(error.map_or(f64::INFINITY, f64::abs))
    });
    let _ = writeln!(
        text,
        "against volumes (figure 6): {} compared, worst {:.1} %, at most {:.0} %: {}",
        findings.dense.len(),
        100.0 * worst,
        100.0 * VOLUME,
        verdict(worst <= VOLUME)
    );
}

fn cell_limits(text: &mut String, findings: &Findings) {
    let limits = findings.cell_limits.iter();
    let each: Vec<String> = limits
        .map(|own| format!("{} at {}", per_cent(own.error), own.cell))
        .collect();
    let _ = writeln!(
        text,
        "lattice: error of the wavelength over wavelengths to a cell: {}",
        each.join(", ")
    );
}

/// A finding as it comes.
pub(super) fn line(line: &Value) -> String {
    let own = Findings::read(std::slice::from_ref(line));
    if let Some(own) = own.samples.first() {
        let failed = if own.converged { "" } else { ", NOT CONVERGED" };
        return format!(
            "{} skin {:.3} mm, {} times as stiff: {} after the onset, {} at {:.2} critical strains{failed}",
            own.coupling,
            1e3 * own.thickness,
            own.ratio,
            per_cent(own.errors()[0]),
            per_cent(own.errors()[1]),
            own.demand[1],
        );
    }
    if let Some(own) = own.dense.first() {
        return format!(
            "skin {:.3} mm, {} times as stiff, against a volume: {}",
            1e3 * own.thickness,
            own.ratio,
            per_cent(own.error()),
        );
    }
    if let Some(own) = own.cell_limits.first() {
        return format!("cells of {} wavelengths: {}", own.cell, per_cent(own.error));
    }
    if let Some(own) = own.thrown.first() {
        return thrown(own);
    }
    if let Some(own) = own.sizes.first() {
        let [unknowns, constraints, ..] = own.own.counts;
        return format!(
            "{}, {unknowns} unknowns, {constraints} constraints: {:.2} s a frame",
            own.body, own.own.seconds[1]
        );
    }
    let artefacts = own.artefacts.iter().map(|own| &own.shape);
    let bars = own.localities.iter().map(|own| &own.coupling);
    let names: Vec<&str> = artefacts.chain(bars).map(String::as_str).collect();
    format!("bent: {}", names.join(", "))
}

fn per_cent(error: Option<f64>) -> String {
    error.map_or("no wrinkles".to_owned(), |error| {
        format!("{:+.1} %", 100.0 * error)
    })
}
