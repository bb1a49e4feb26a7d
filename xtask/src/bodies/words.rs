//! What was found, against its goals, in words.

use serde_json::Value;

use super::findings::{Findings, HARD_ROWS, HYBRID, Locality, Thrown};
use super::speed::speeds;
use super::verdict::Verdict;

/// Median error of the wavelength that the default may have, and samples that it takes to tell.
pub(super) const WAVELENGTH: f64 = 0.05;
const SAMPLES: usize = 25;

/// Error against a volume that none may have, and volumes that it takes to tell.
pub(super) const VOLUME: f64 = 0.1;
const VOLUMES: usize = 9;

/// How many times less cells have to show with quadratic elements.
const SMOOTHER: f64 = 5.0;

/// Share of the squared heights that local coupling may leave outside.
const OUTSIDE: f64 = 0.05;

/// Couplings of the bar. Global functions are there for comparison.
const BARS: [&str; 4] = [HYBRID, "elastic", HARD_ROWS, GLOBAL];
const GLOBAL: &str = "spectral";

/// All of it, a goal to a line.
pub(super) fn words(findings: &Findings) -> String {
    let mut lines = vec![
        wavelengths(findings, HYBRID),
        wavelengths(findings, HARD_ROWS),
        volumes(findings),
        cell_limits(findings),
        smoother(findings),
    ];
    lines.extend(findings.artefacts.iter().map(|own| {
        format!(
            "  {}: {:.4} of the smooth skin's energy, {:.3} degrees RMS",
            own.shape, own.energy, own.angle_deg
        )
    }));
    lines.extend(BARS.map(|coupling| {
        let mut all = findings.localities.iter();
        let found = match all.find(|own| own.coupling == coupling) {
            Some(own) => locality(own),
            None => Verdict::NotMeasured.to_string(),
        };
        format!("locality (figure 3), {coupling}: {found}")
    }));
    match findings.thrown.as_slice() {
        [] => lines.push(format!("thrown: {}", Verdict::NotMeasured)),
        all => lines.extend(all.iter().map(thrown)),
    }
    lines.extend(speeds(findings));
    lines.join("\n") + "\n"
}

fn wavelengths(findings: &Findings, coupling: &str) -> String {
    let goal = format!("wavelength (figure 7), {coupling}");
    let [Some(early), Some(late)] = [0, 1].map(|key| findings.median_error(coupling, key)) else {
        return format!("{goal}: {}", Verdict::NotMeasured);
    };
    let errors: Vec<f64> = findings.of(coupling).map(|own| own.error_size(1)).collect();
    let worst = errors.iter().fold(0.0, |m: f64, error| m.max(*error));
    let count = errors.len();
    let failed = errors.iter().filter(|error| error.is_infinite()).count();
    let demands = findings.of(coupling).map(|own| own.demand[1]);
    let (low, high) = demands.fold((f64::MAX, 0.0_f64), |(l, h), d| (l.min(d), h.max(d)));
    let verdict = match coupling {
        HYBRID => format!(
            "; under {:.0} %: {}",
            100.0 * WAVELENGTH,
            Verdict::of(late < WAVELENGTH && failed == 0, count, SAMPLES)
        ),
        _ => String::new(),
    };
    format!(
        "{goal}: median error {:.1} % of {count} samples at {low:.2} to {high:.2} critical strains, worst {:.1} %; {:.1} % soon after the onset; {failed} failed{verdict}",
        100.0 * late,
        100.0 * worst,
        100.0 * early,
    )
}

fn volumes(findings: &Findings) -> String {
    let errors = findings.dense.iter().map(|own| own.error_size());
    let worst = errors.fold(0.0, f64::max);
    let count = findings.dense.len();
    format!(
        "against volumes (figure 6): {count} compared, worst {:.1} %, at most {:.0} %: {}",
        100.0 * worst,
        100.0 * VOLUME,
        Verdict::of(worst <= VOLUME, count, VOLUMES)
    )
}

fn cell_limits(findings: &Findings) -> String {
    let limits = findings.cell_limits.iter();
    let each: Vec<String> = limits
        .map(|own| format!("{} at {}", per_cent(own.error), own.cell))
        .collect();
    let each = match each.as_slice() {
        [] => Verdict::NotMeasured.to_string(),
        all => all.join(", "),
    };
    format!("lattice: error of the wavelength over wavelengths to a cell: {each}")
}

fn smoother(findings: &Findings) -> String {
    let found = match findings.smoother() {
        Some(times) => format!(
            "{times:.0} times less bending energy beside a smooth skin with quadratic elements, at least {SMOOTHER:.0}: {}",
            Verdict::one(times >= SMOOTHER)
        ),
        None => Verdict::NotMeasured.to_string(),
    };
    format!("cells (figure 4): {found}")
}

fn locality(own: &Locality) -> String {
    let failed = if own.converged { "" } else { ", NOT CONVERGED" };
    let goal = match own.coupling.as_str() {
        GLOBAL => String::new(),
        _ => format!(
            ", at most {:.0} %: {}",
            100.0 * OUTSIDE,
            Verdict::one(own.converged && own.outside <= OUTSIDE)
        ),
    };
    format!(
        "{:.2} % of the squared heights outside the bent part{goal}{failed}",
        100.0 * own.outside
    )
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
        Verdict::one(holds)
    )
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Good samples of the default.
    fn samples(count: usize) -> Vec<Value> {
        let sample = json!({
            "part": "isocontours", "coupling": HYBRID, "predicted_m": 0.01,
            "measured_m": [0.01, 0.0102], "demand": [1.2, 1.5], "converged": true,
        });
        vec![sample; count]
    }

    fn volumes(count: usize) -> Vec<Value> {
        vec![json!({ "part": "dense", "volume_m": 0.01, "embedded_m": 0.0102 }); count]
    }

    /// The line that begins like this.
    fn told(lines: &[Value], beginning: &str) -> String {
        let text = words(&Findings::read(lines));
        let found = text.lines().find(|line| line.starts_with(beginning));
        found.expect("a goal has a line").to_owned()
    }

    #[test]
    fn a_failed_sample_misses_the_goal() {
        let wavelength = |lines: &[Value]| told(lines, "wavelength (figure 7), hybrid");
        assert!(wavelength(&samples(SAMPLES)).ends_with("0 failed; under 5 %: met"));
        assert!(wavelength(&samples(SAMPLES - 1)).ends_with("too few to tell"));
        assert!(wavelength(&[]).ends_with("not measured"));
        let failures = [
            ("converged", json!(false)),
            ("measured_m", json!([0.01, null])),
        ];
        for (key, value) in failures {
            for count in [2, SAMPLES] {
                let mut lines = samples(count);
                lines[1][key] = value.clone();
                assert!(wavelength(&lines).ends_with("1 failed; under 5 %: MISSED"));
            }
        }
    }

    #[test]
    fn a_volume_without_waves_misses_the_goal() {
        let volume = |lines: &[Value]| told(lines, "against volumes");
        assert!(volume(&volumes(VOLUMES)).ends_with(": met"));
        assert!(volume(&volumes(VOLUMES - 1)).ends_with("too few to tell"));
        assert!(volume(&[]).ends_with("not measured"));
        let mut lines = volumes(2);
        lines[0]["embedded_m"] = Value::Null;
        assert!(volume(&lines).ends_with("MISSED"));
    }

    #[test]
    fn what_is_absent_is_said_to_be() {
        let lines = [
            json!({ "part": "artefact", "shape": "linear", "energy": 1.0 }),
            json!({ "part": "locality", "coupling": HYBRID, "outside": 0.01, "converged": true }),
        ];
        assert_eq!(told(&lines, "cells"), "cells (figure 4): not measured");
        assert!(told(&lines, "locality (figure 3), hybrid").ends_with(": met"));
        for absent in ["locality (figure 3), elastic", "lattice", "thrown"] {
            assert!(told(&lines, absent).ends_with(": not measured"), "{absent}");
        }
    }
}
