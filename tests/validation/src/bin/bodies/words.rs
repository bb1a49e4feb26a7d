//! What was found, against its goals, in words.

use ruga_validation::body::Locality;

use crate::findings::{Finding, Findings, HARD_ROWS, HYBRID, Throw, sample_error, size_of};
use crate::speed::speeds;
use crate::verdict::Verdict;

/// Median error of the wavelength that the default may have, and samples that it takes to tell.
pub(crate) const WAVELENGTH: f64 = 0.05;
const SAMPLES: usize = 25;

/// Error against a volume that none may have, and volumes that it takes to tell.
pub(crate) const VOLUME: f64 = 0.1;
const VOLUMES: usize = 9;

/// How many times less cells have to show with quadratic elements.
const SMOOTHER: f64 = 5.0;

/// Share of the squared heights that local coupling may leave outside.
const OUTSIDE: f64 = 0.05;

/// Couplings of the bar. Global functions are there for comparison.
const BARS: [&str; 4] = [HYBRID, "elastic", HARD_ROWS, GLOBAL];
const GLOBAL: &str = "spectral";

/// All of it, a goal to a line.
pub(crate) fn words(findings: &Findings) -> String {
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
    let errors: Vec<f64> = findings
        .of_coupling(coupling)
        .map(|own| sample_error(own, 1))
        .collect();
    let worst = errors.iter().fold(0.0, |m: f64, error| m.max(*error));
    let count = errors.len();
    let failed = errors.iter().filter(|error| error.is_infinite()).count();
    let demands = findings.of_coupling(coupling).map(|own| own.demand[1]);
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
    let errors = findings.dense.iter().map(|own| size_of(own.error()));
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
        .map(|own| format!("{} at {}", per_cent(own.found.errors()[1]), own.cell))
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

fn thrown(own: &Throw) -> String {
    let [low, high] = own.heights;
    let is_whole = low > HEIGHTS[0] && high < HEIGHTS[1] && own.outside < OUTSIDE_ROOM;
    let holds = own.converged && own.frames == own.steps as usize && is_whole;
    format!(
        "thrown, steps of {} s: {} of {} made, {:.2} to {:.2} of its height, {:.3} of it out of its room, {:.1} factorisations a step: {}",
        own.time_step,
        own.frames,
        own.steps,
        low,
        high,
        own.outside,
        own.factorizations as f64 / own.frames as f64,
        Verdict::one(holds)
    )
}

/// A finding as it comes.
pub(crate) fn line(finding: &Finding) -> String {
    match finding {
        Finding::Artefact(own) => format!("bent: {}", own.shape),
        Finding::Locality(own) => format!("bent: {}", own.coupling),
        Finding::CellLimit(own) => format!(
            "cells of {} wavelengths: {}",
            own.cell,
            per_cent(own.found.errors()[1])
        ),
        Finding::Isocontour(own) => format!(
            "{} skin {:.3} mm, {} times as stiff: {} after the onset, {} at {:.2} critical strains{}",
            own.coupling,
            1e3 * own.sample.thickness,
            own.sample.ratio,
            per_cent(own.errors()[0]),
            per_cent(own.errors()[1]),
            own.demand[1],
            if own.converged { "" } else { ", NOT CONVERGED" },
        ),
        Finding::Dense(own) => format!(
            "skin {:.3} mm, {} times as stiff, against a volume: {}",
            1e3 * own.sample.thickness,
            own.sample.ratio,
            per_cent(own.error()),
        ),
        Finding::Thrown(own) => thrown(own),
        Finding::Size(own) => format!(
            "{}, {} unknowns, {} constraints: {:.2} s a frame",
            own.body.kind.name(),
            own.own.counts[0],
            own.own.counts[1],
            own.own.seconds[1],
        ),
    }
}

fn per_cent(error: Option<f64>) -> String {
    error.map_or("no wrinkles".to_owned(), |error| {
        format!("{:+.1} %", 100.0 * error)
    })
}

#[cfg(test)]
mod tests {
    use ruga_validation::body::{Dense, Isocontour, Sample};

    use super::*;
    use crate::findings::tests::{artefact, sample};

    /// Good samples of the default.
    fn samples(count: usize) -> Findings {
        Findings {
            samples: vec![sample(5e-4, 100.0, Some(0.0102)); count],
            ..Findings::default()
        }
    }

    fn volumes(count: usize) -> Findings {
        let own = Dense {
            sample: Sample {
                thickness: 5e-4,
                ratio: 100.0,
            },
            volume: 0.01,
            onset: 1.0,
            embedded: Some(0.0102),
        };
        Findings {
            dense: vec![own; count],
            ..Findings::default()
        }
    }

    /// The line that begins like this.
    fn told(findings: &Findings, beginning: &str) -> String {
        let text = words(findings);
        let found = text.lines().find(|line| line.starts_with(beginning));
        found.expect("a goal has a line").to_owned()
    }

    #[test]
    fn a_failed_sample_misses_the_goal() {
        let wavelength = |own: &Findings| told(own, "wavelength (figure 7), hybrid");
        assert!(wavelength(&samples(SAMPLES)).ends_with("0 failed; under 5 %: met"));
        assert!(wavelength(&samples(SAMPLES - 1)).ends_with("too few to tell"));
        assert!(wavelength(&Findings::default()).ends_with("not measured"));
        let failures: [fn(&mut Isocontour); 2] =
            [|own| own.converged = false, |own| own.measured[1] = None];
        for fail in failures {
            for count in [2, SAMPLES] {
                let mut own = samples(count);
                fail(&mut own.samples[1]);
                assert!(wavelength(&own).ends_with("1 failed; under 5 %: MISSED"));
            }
        }
    }

    #[test]
    fn a_volume_without_waves_misses_the_goal() {
        let volume = |own: &Findings| told(own, "against volumes");
        assert!(volume(&volumes(VOLUMES)).ends_with(": met"));
        assert!(volume(&volumes(VOLUMES - 1)).ends_with("too few to tell"));
        assert!(volume(&Findings::default()).ends_with("not measured"));
        let mut own = volumes(2);
        own.dense[0].embedded = None;
        assert!(volume(&own).ends_with("MISSED"));
    }

    #[test]
    fn what_is_absent_is_said_to_be() {
        let bar = Locality {
            coupling: HYBRID.to_owned(),
            outside: 0.01,
            amplitude: 1.0,
            profile: Vec::new(),
            bent: [0.0; 2],
            converged: true,
        };
        let own = Findings {
            artefacts: vec![artefact("linear", 1.0)],
            localities: vec![bar],
            ..Findings::default()
        };
        assert_eq!(told(&own, "cells"), "cells (figure 4): not measured");
        assert!(told(&own, "locality (figure 3), hybrid").ends_with(": met"));
        for absent in ["locality (figure 3), elastic", "lattice", "thrown"] {
            assert!(told(&own, absent).ends_with(": not measured"), "{absent}");
        }
    }
}
