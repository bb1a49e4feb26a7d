//! What was measured, put together over seeds.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::setting::{Line, Problem, Run, Setting, word};

/// What is compared with the known film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Measure {
    /// RMS angle between normals, degrees.
    Normals,
    /// At two critical strains.
    Wavelength,
    /// The worse of the amplitudes at two and at four critical strains.
    Amplitude,
    Onset,
    PatchNormals,
    PatchWavelength,
    PatchAmplitude,
}

impl Measure {
    pub(crate) const ALL: [Self; 7] = [
        Self::Normals,
        Self::Wavelength,
        Self::Amplitude,
        Self::Onset,
        Self::PatchNormals,
        Self::PatchWavelength,
        Self::PatchAmplitude,
    ];

    pub(crate) fn problem(self) -> Problem {
        match self {
            Self::PatchNormals | Self::PatchWavelength | Self::PatchAmplitude => Problem::Patch,
            _ => Problem::Film,
        }
    }

    /// Whether it is measured in degrees; else it is a share.
    pub(crate) fn is_angle(self) -> bool {
        matches!(self, Self::Normals | Self::PatchNormals)
    }

    /// In tables.
    pub(crate) fn name(self) -> String {
        word(self)
    }

    /// Whether it belongs to the discretisation alone, whatever solves the linear systems.
    fn is_of_discretisation(self) -> bool {
        self == Self::Onset
    }

    /// An error for people: degrees, or per cent.
    pub(crate) fn words(self, error: f64) -> String {
        match self.is_angle() {
            true => format!("{error:.2}°"),
            false => format!("{:.2} %", 100.0 * error),
        }
    }
}

/// Median and extremes over seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Spread {
    pub(crate) low: f64,
    pub(crate) median: f64,
    pub(crate) high: f64,
}

impl Spread {
    /// Of some values; `None` of none.
    pub(crate) fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let middle = values.len() / 2;
        let median = match values.len() % 2 {
            0 => 0.5 * (values.get(middle.checked_sub(1)?)? + values[middle]),
            _ => values[middle],
        };
        Some(Self {
            low: values[0],
            median,
            high: *values.last()?,
        })
    }
}

/// One setting over all its seeds.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Point {
    #[serde(flatten)]
    pub(crate) setting: Setting,
    pub(crate) runs: usize,
    /// Runs that did not get through the load, or ended on a saddle; no error counts of these.
    pub(crate) failed: usize,
    pub(crate) failures: Vec<String>,
    /// Seconds of the processor per key, of the runs that succeeded, or else of all; `None` where
    /// every run crashed.
    pub(crate) seconds: Option<Spread>,
    /// The same per thousand vertices.
    pub(crate) seconds_per_thousand: Option<Spread>,
    pub(crate) vertices: Option<f64>,
    /// Absolute errors of the runs that succeeded.
    pub(crate) errors: BTreeMap<Measure, Spread>,
}

impl Point {
    /// Median of the seconds; infinite where nobody knows.
    pub(crate) fn cost(&self) -> f64 {
        self.seconds.as_ref().map_or(f64::INFINITY, |s| s.median)
    }

    /// Median error.
    pub(crate) fn error(&self, measure: Measure) -> Option<f64> {
        self.errors.get(&measure).map(|spread| spread.median)
    }
}

/// Points in the order of the plan; a run that was planned and not measured is missing.
pub(crate) fn points(runs: &[Run], lines: &[Line]) -> Vec<Point> {
    let mut settings: Vec<Setting> = Vec::new();
    for run in runs {
        if !settings.contains(&run.setting) {
            settings.push(run.setting);
        }
    }
    let of = |setting: Setting| -> Vec<&Line> {
        let is_of = |line: &&Line| line.request.setting == setting;
        lines.iter().filter(is_of).collect()
    };
    let point = |&setting: &Setting| {
        let factorised = Setting {
            method: setting.method.factorised(),
            ..setting
        };
        point(setting, &of(setting), &of(factorised))
    };
    settings.iter().filter_map(point).collect()
}

fn point(setting: Setting, lines: &[&Line], factorised: &[&Line]) -> Option<Point> {
    if lines.is_empty() {
        return None;
    }
    let has_failed = |line: &&&Line| line.outcome.failure.is_some();
    let (failed, fine): (Vec<&Line>, Vec<&Line>) = lines.iter().partition(has_failed);
    let timed = if fine.is_empty() { lines } else { &fine };
    // Of a run that panicked nothing is known.
    let known = timed.iter().map(|line| &line.outcome);
    let known = known.filter(|outcome| outcome.cpu_s > 0.0 && outcome.vertices > 0);
    let mut seconds = Vec::new();
    let mut per_thousand = Vec::new();
    let mut vertices = Vec::new();
    for outcome in known {
        let (per_frame, count) = (
            outcome.cpu_s / outcome.frames as f64,
            outcome.vertices as f64,
        );
        seconds.push(per_frame);
        per_thousand.push(1e3 * per_frame / count);
        vertices.push(count);
    }
    let errors = Measure::ALL.iter().filter_map(|&measure| {
        let sources = match measure.is_of_discretisation() && !fine.is_empty() {
            true => factorised,
            false => &fine,
        };
        let values = sources
            .iter()
            .filter_map(|l| l.outcome.errors.get(&measure));
        Some((measure, Spread::of(values.map(|e| e.abs()).collect())?))
    });
    Some(Point {
        setting,
        runs: lines.len(),
        failed: failed.len(),
        failures: failed
            .iter()
            .filter_map(|line| line.outcome.failure.clone())
            .collect(),
        seconds: Spread::of(seconds),
        seconds_per_thousand: Spread::of(per_thousand),
        vertices: Spread::of(vertices).map(|spread| spread.median),
        errors: errors.collect(),
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::plan::{DEFAULT, PAPERS};
    use crate::setting::{Method, Outcome};

    fn line(run: &Run, failure: Option<&str>, cpu_s: f64, error: f64) -> Line {
        let of_film = Measure::ALL
            .into_iter()
            .filter(|m| m.problem() == Problem::Film);
        let outcome = Outcome {
            failure: failure.map(str::to_owned),
            cpu_s,
            frames: 8,
            vertices: 2000,
            errors: of_film.map(|measure| (measure, -error)).collect(),
            ..Outcome::default()
        };
        let request = *run;
        Line { request, outcome }
    }

    fn run(method: Method, seed: u64) -> Run {
        Run {
            setting: Setting {
                problem: Problem::Film,
                method,
                points: 12,
            },
            seed,
            limit_s: 60.0,
        }
    }

    #[test]
    fn errors_are_of_runs_that_succeeded() {
        let runs: Vec<Run> = (1..=4).map(|seed| run(DEFAULT, seed)).collect();
        let failures = [None, Some("gave up"), None, None];
        let lines = [0.01, 9.0, 0.03, 0.02];
        let lines: Vec<Line> = (0..4)
            .map(|i| line(&runs[i], failures[i], 16.0, lines[i]))
            .collect();
        let points = points(&runs, &lines);
        assert_eq!(points.len(), 1);
        assert_eq!((points[0].runs, points[0].failed), (4, 1));
        let wanted = Spread {
            low: 0.01,
            median: 0.02,
            high: 0.03,
        };
        assert_eq!(points[0].errors[&Measure::Amplitude], wanted);
        assert_eq!(points[0].cost(), 2.0);
        let per_thousand = points[0].seconds_per_thousand.as_ref();
        assert_eq!(per_thousand.map(|spread| spread.median), Some(1.0));
    }

    #[test]
    fn a_setting_whose_runs_all_panic_is_counted() {
        let run = run(PAPERS, 1);
        let panicked = Line {
            request: run,
            outcome: Outcome::failed("panicked".to_owned()),
        };
        let points = points(&[run], &[panicked]);
        assert_eq!((points[0].runs, points[0].failed), (1, 1));
        assert!(points[0].seconds.is_none() && points[0].vertices.is_none());
    }

    #[test]
    fn what_is_of_the_discretisation_is_taken_from_the_factorised_run() {
        let runs = [run(PAPERS, 1), run(PAPERS.factorised(), 1)];
        let mut lines = [
            line(&runs[0], None, 80.0, 0.3),
            line(&runs[1], None, 8.0, 0.1),
        ];
        lines[0].outcome.errors = [(Measure::Normals, 3.0), (Measure::Amplitude, 0.3)].into();
        let points = points(&runs, &lines);
        assert_eq!(points[0].error(Measure::Onset), Some(0.1));
        assert_eq!(points[0].error(Measure::Amplitude), Some(0.3));
        assert_eq!(points[0].error(Measure::PatchAmplitude), None);
    }

    #[test]
    fn a_setting_without_a_run_is_no_point() {
        assert!(points(&[run(DEFAULT, 1)], &[]).is_empty());
        assert_eq!(Spread::of(Vec::new()), None);
        assert_eq!(Spread::of(vec![2.0, 1.0]).map(|s| s.median), Some(1.5));
    }

    #[test]
    fn a_line_is_read_as_it_was_written() {
        let written = line(&run(PAPERS, 3), Some("gave up"), 2.5, 0.125);
        let text = serde_json::to_string(&written).expect("a line");
        let read: Line = serde_json::from_str(&text).expect("the same line");
        assert_eq!(read.request, written.request);
        assert_eq!(read.outcome.errors, written.outcome.errors);
    }
}
