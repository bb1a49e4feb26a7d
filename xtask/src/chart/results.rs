//! What was measured, put together over seeds.

use std::collections::BTreeMap;

use serde_json::Value;

use super::plan::{Method, Problem, Run, Setting};

/// What is compared with the known film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Measure {
    /// RMS angle between normals, degrees.
    Normals,
    Wavelength,
    /// The worse of the amplitudes at two and at four critical strains.
    Amplitude,
    Onset,
    Gap,
    PatchNormals,
    PatchWavelength,
    PatchAmplitude,
}

impl Measure {
    pub(super) const ALL: [Self; 8] = [
        Self::Normals,
        Self::Wavelength,
        Self::Amplitude,
        Self::Onset,
        Self::Gap,
        Self::PatchNormals,
        Self::PatchWavelength,
        Self::PatchAmplitude,
    ];

    pub(super) fn problem(self) -> Problem {
        match self {
            Self::PatchNormals | Self::PatchWavelength | Self::PatchAmplitude => Problem::Patch,
            _ => Problem::Film,
        }
    }

    /// Whether it is measured in degrees; else it is a share.
    pub(super) fn is_angle(self) -> bool {
        matches!(self, Self::Normals | Self::PatchNormals)
    }

    /// In tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::Wavelength => "wavelength",
            Self::Amplitude => "amplitude",
            Self::Onset => "onset",
            Self::Gap => "gap",
            Self::PatchNormals => "patch-normals",
            Self::PatchWavelength => "patch-wavelength",
            Self::PatchAmplitude => "patch-amplitude",
        }
    }

    /// The measuring program's names for it, of which the worst counts.
    fn sources(self) -> &'static [&'static str] {
        match self {
            Self::Normals => &["normals"],
            Self::Wavelength => &["wavelength"],
            Self::Amplitude => &["amplitude-2", "amplitude-4"],
            Self::Onset => &["onset"],
            Self::Gap => &["gap"],
            Self::PatchNormals => &["patch-normals"],
            Self::PatchWavelength => &["patch-wavelength"],
            Self::PatchAmplitude => &["patch-amplitude"],
        }
    }

    /// Whether it belongs to the discretisation alone, whatever solves the linear systems.
    fn is_of_discretisation(self) -> bool {
        matches!(self, Self::Wavelength | Self::Onset)
    }

    /// An error for people: degrees, or per cent.
    pub(super) fn words(self, error: f64) -> String {
        match self.is_angle() {
            true => format!("{error:.2}°"),
            false => format!("{:.2} %", 100.0 * error),
        }
    }
}

/// Median and extremes over seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    pub(super) low: f64,
    pub(super) median: f64,
    pub(super) high: f64,
}

impl Spread {
    /// Of some values; `None` of none.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
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
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) setting: Setting,
    pub(super) runs: usize,
    /// Runs that did not get through the load, or ended on a saddle; no error counts of these.
    pub(super) failed: usize,
    pub(super) failures: Vec<String>,
    /// Seconds of the processor per frame, of the runs that succeeded, or else of all; `None` where
    /// every run crashed.
    pub(super) seconds: Option<Spread>,
    /// The same per thousand vertices.
    pub(super) seconds_per_thousand: Option<Spread>,
    pub(super) vertices: Option<f64>,
    /// Absolute errors of the runs that succeeded.
    pub(super) errors: BTreeMap<Measure, Spread>,
}

impl Point {
    /// Median of the seconds; infinite where nobody knows.
    pub(super) fn cost(&self) -> f64 {
        self.seconds.as_ref().map_or(f64::INFINITY, |s| s.median)
    }

    /// Median error.
    pub(super) fn error(&self, measure: Measure) -> Option<f64> {
        self.errors.get(&measure).map(|spread| spread.median)
    }
}

/// Points in the order of the plan; a run that was planned and not measured is missing.
pub(super) fn points(runs: &[Run], lines: &[Value]) -> Vec<Point> {
    let mut settings: Vec<Setting> = Vec::new();
    for run in runs {
        if !settings.contains(&run.setting) {
            settings.push(run.setting);
        }
    }
    let of = |setting: Setting| -> Vec<&Value> {
        let is_of = |line: &&Value| request_of(line) == Some(setting_key(setting));
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

type Key<'a> = ([&'a str; 6], u32);

fn setting_key(setting: Setting) -> Key<'static> {
    let Method {
        coupling,
        sampling,
        bending,
        mesh,
        solver,
    } = setting.method;
    (
        [
            setting.problem.name(),
            coupling,
            sampling,
            bending,
            mesh,
            solver,
        ],
        setting.points,
    )
}

fn request_of(line: &Value) -> Option<Key<'_>> {
    let request = &line["request"];
    let names = [
        "problem", "coupling", "sampling", "bending", "mesh", "solver",
    ];
    let words = names.map(|name| request[name].as_str().unwrap_or_default());
    Some((words, request["points"].as_f64()? as u32))
}

fn point(setting: Setting, lines: &[&Value], factorised: &[&Value]) -> Option<Point> {
    if lines.is_empty() {
        return None;
    }
    let (failed, fine): (Vec<&Value>, Vec<&Value>) =
        lines.iter().partition(|line| line["failure"].is_string());
    let timed = if fine.is_empty() { lines } else { &fine };
    let number = |line: &Value, name: &str| line[name].as_f64().filter(|n| *n > 0.0);
    let per_frame = |line: &Value| Some(number(line, "cpu_s")? / number(line, "frames")?);
    let per_thousand = |line: &Value| Some(1e3 * per_frame(line)? / number(line, "vertices")?);
    let over = |value: &dyn Fn(&Value) -> Option<f64>| {
        Spread::of(timed.iter().filter_map(|line| value(line)).collect())
    };
    let errors = Measure::ALL.iter().filter_map(|&measure| {
        let sources = match measure.is_of_discretisation() && !fine.is_empty() {
            true => factorised,
            false => &fine,
        };
        let values = sources.iter().filter_map(|line| error(line, measure));
        Some((measure, Spread::of(values.collect())?))
    });
    Some(Point {
        setting,
        runs: lines.len(),
        failed: failed.len(),
        failures: failed
            .iter()
            .filter_map(|line| line["failure"].as_str().map(str::to_owned))
            .collect(),
        seconds: over(&per_frame),
        seconds_per_thousand: over(&per_thousand),
        vertices: over(&|line| number(line, "vertices")).map(|spread| spread.median),
        errors: errors.collect(),
    })
}

fn error(line: &Value, measure: Measure) -> Option<f64> {
    let values = measure
        .sources()
        .iter()
        .map(|name| line["errors"][name].as_f64());
    let worst = values.collect::<Option<Vec<f64>>>()?;
    Some(worst.into_iter().map(f64::abs).fold(0.0, f64::max))
}

#[cfg(test)]
pub(super) mod tests {
    use serde_json::json;

    use super::super::plan::{DEFAULT, PAPERS};
    use super::*;

    /// A line as the measuring program writes it.
    fn line(run: &Run, failure: Option<&str>, cpu_s: f64, error: f64) -> Value {
        json!({
            "request": run.request(), "failure": failure, "cpu_s": cpu_s, "frames": 8,
            "vertices": 2000,
            "errors": {
                "normals": error, "amplitude-2": -error, "amplitude-4": 0.5 * error,
                "wavelength": error, "onset": error, "gap": error,
            },
        })
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
        let lines: Vec<Value> = (0..4)
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
    fn a_setting_whose_runs_all_crash_is_counted() {
        let run = run(PAPERS, 1);
        let crashed = json!({ "request": run.request(), "failure": "crashed" });
        let points = points(&[run], &[crashed]);
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
        lines[0]["errors"] = json!({ "normals": 3.0, "gap": 0.3 });
        let points = points(&runs, &lines);
        assert_eq!(points[0].error(Measure::Onset), Some(0.1));
        assert_eq!(points[0].error(Measure::Gap), Some(0.3));
        assert_eq!(points[0].error(Measure::Amplitude), None);
    }

    #[test]
    fn a_setting_without_a_run_is_no_point() {
        assert!(points(&[run(DEFAULT, 1)], &[]).is_empty());
        assert_eq!(Spread::of(Vec::new()), None);
        assert_eq!(Spread::of(vec![2.0, 1.0]).map(|s| s.median), Some(1.5));
    }
}
