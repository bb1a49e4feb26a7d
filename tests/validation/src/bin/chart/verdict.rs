//! What the points say: which are best, what the papers' way costs, whether the default is accurate.

use serde::Serialize;

use crate::plan::{DEFAULT, PAPERS};
use crate::results::{Measure, Point};
use crate::setting::{Method, Setting};

/// Largest median errors that the default may have, by points per wavelength; normals are not
/// promised. The border of the patch on which the film lies takes one per cent of the onset at any
/// resolution: it stiffens the softest mode by two.
const ACCEPTED: [(u32, [(Measure, f64); 3]); 2] = [
    (
        12,
        [
            (Measure::Wavelength, 0.015),
            (Measure::Amplitude, 0.02),
            (Measure::Onset, 0.02),
        ],
    ),
    (
        24,
        [
            (Measure::Wavelength, 0.007),
            (Measure::Amplitude, 0.015),
            (Measure::Onset, 0.02),
        ],
    ),
];

/// One promise about the default, and what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Acceptance {
    pub(crate) points: u32,
    pub(crate) measure: Measure,
    pub(crate) accepted: f64,
    /// `None` where nothing was measured.
    pub(crate) error: Option<f64>,
}

impl Acceptance {
    pub(crate) fn is_met(&self) -> bool {
        self.error.is_some_and(|error| error <= self.accepted)
    }
}

/// What the papers' way costs over what the default costs with the same error, at the resolution
/// that suits the papers best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Ratio {
    pub(crate) measure: Measure,
    /// That resolution, in points per wavelength.
    pub(crate) points: u32,
    /// The papers' error there.
    pub(crate) error: f64,
    /// Seconds per key, the papers' and the default's.
    pub(crate) seconds: [f64; 2],
    /// Whether the default is more accurate even where it is coarsest, so that the true ratio is
    /// greater.
    pub(crate) is_bound: bool,
    /// Resolutions at which the papers' way is more accurate than the default at any.
    pub(crate) unreached: usize,
}

impl Ratio {
    pub(crate) fn value(&self) -> f64 {
        self.seconds[0] / self.seconds[1]
    }
}

/// Points of a method that have an error, by cost; those of which half or more failed are out.
pub(crate) fn curve(points: &[Point], method: Method, measure: Measure) -> Vec<(&Point, f64)> {
    let own = points.iter().filter(|point| point.setting.method == method);
    let mut curve: Vec<_> = own
        .filter(|point| 2 * point.failed < point.runs)
        .filter_map(|point| Some((point, point.error(measure)?)))
        .collect();
    curve.sort_by(|a, b| a.0.cost().total_cmp(&b.0.cost()));
    curve
}

/// Runs that a point on the Pareto line has at least: one lucky seed is no method.
const FEWEST_RUNS: usize = 3;

/// Points that no other beats in both cost and error, by cost. Points of few runs are out, and those
/// of which half or more failed.
pub(crate) fn pareto(points: &[Point], measure: Measure) -> Vec<(&Point, f64)> {
    let mut all: Vec<_> = points
        .iter()
        .filter(|point| point.runs >= FEWEST_RUNS && 2 * point.failed < point.runs)
        .filter_map(|point| Some((point, point.error(measure)?)))
        .collect();
    all.sort_by(|a, b| a.0.cost().total_cmp(&b.0.cost()));
    let mut least = f64::INFINITY;
    all.retain(|(_, error)| {
        let is_better = *error < least;
        least = least.min(*error);
        is_better
    });
    all
}

/// Seconds that it takes to reach `error`, between the points of a curve along a straight line of
/// logarithms; `None` where no point is that accurate. A point with a greater error than a cheaper
/// one is passed over.
fn seconds_for(curve: &[(&Point, f64)], error: f64) -> Option<f64> {
    let mut before: Option<(f64, f64)> = None;
    for (point, reached) in curve {
        let seconds = point.cost();
        match before {
            _ if *reached > error => {
                if before.is_none_or(|(_, least)| *reached < least) {
                    before = Some((seconds, *reached));
                }
            }
            None => return Some(seconds),
            Some((cheaper, above)) => {
                let share = (above / error).ln() / (above / reached).ln();
                return Some(cheaper * (seconds / cheaper).powf(share));
            }
        }
    }
    None
}

/// The default against the papers' way, where both were measured.
pub(crate) fn ratios(points: &[Point]) -> Vec<Ratio> {
    let of = |&measure: &Measure| {
        let default = curve(points, DEFAULT, measure);
        let papers = curve(points, PAPERS, measure);
        let ratio = |&(point, error): &(&Point, f64)| {
            Some(Ratio {
                measure,
                points: point.setting.points,
                error,
                seconds: [point.cost(), seconds_for(&default, error)?],
                is_bound: default.first()?.1 <= error,
                unreached: 0,
            })
        };
        let all: Vec<Ratio> = papers.iter().filter_map(ratio).collect();
        let least = all.iter().min_by(|a, b| a.value().total_cmp(&b.value()))?;
        Some(Ratio {
            unreached: papers.len() - all.len(),
            ..*least
        })
    };
    Measure::ALL.iter().filter_map(of).collect()
}

/// The default at a resolution, on the problem of a measure.
pub(crate) fn default_at(points: u32, measure: Measure) -> Setting {
    Setting {
        problem: measure.problem(),
        method: DEFAULT,
        points,
    }
}

/// What was promised of the default, kept or not.
pub(crate) fn acceptance(points: &[Point]) -> Vec<Acceptance> {
    let promise = |resolution: u32, (measure, accepted): (Measure, f64)| {
        let is_it = |p: &&Point| p.setting == default_at(resolution, measure);
        Acceptance {
            points: resolution,
            measure,
            accepted,
            error: points.iter().find(is_it).and_then(|p| p.error(measure)),
        }
    };
    let all = ACCEPTED.iter();
    all.flat_map(|(resolution, limits)| limits.map(|limit| promise(*resolution, limit)))
        .collect()
}

/// What the default costs at a quality, over the cheapest way to be as accurate; 1 on the Pareto
/// line.
pub(crate) fn distance_from_pareto(
    points: &[Point],
    measure: Measure,
    quality: u32,
) -> Option<f64> {
    let default = curve(points, DEFAULT, measure);
    let (point, error) = default.iter().find(|(p, _)| p.setting.points == quality)?;
    let best = pareto(points, measure);
    let cheapest = best.iter().find(|(_, reached)| reached <= error)?;
    Some(point.cost() / cheapest.0.cost())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Spread;
    use crate::setting::{Coupling, Problem};

    fn point(method: Method, points: u32, seconds: f64, error: f64) -> Point {
        let exact = |value| Spread {
            low: value,
            median: value,
            high: value,
        };
        Point {
            setting: Setting {
                problem: Problem::Film,
                method,
                points,
            },
            runs: 5,
            failed: 0,
            failures: Vec::new(),
            seconds: Some(exact(seconds)),
            seconds_per_thousand: Some(exact(seconds)),
            vertices: Some(1000.0),
            errors: Measure::ALL.iter().map(|&m| (m, exact(error))).collect(),
        }
    }

    /// Second order: four times the cost, a quarter of the error.
    fn default_curve() -> Vec<Point> {
        vec![
            point(DEFAULT, 6, 0.1, 0.16),
            point(DEFAULT, 12, 0.4, 0.04),
            point(DEFAULT, 24, 1.6, 0.01),
        ]
    }

    #[test]
    fn equal_error_is_found_between_resolutions() {
        let mut points = default_curve();
        points.push(point(PAPERS, 12, 8.0, 0.08));
        for ratio in ratios(&points) {
            assert_eq!((ratio.points, ratio.is_bound), (12, false));
            assert!((ratio.value() - 40.0).abs() < 1e-9);
        }
        points.push(point(PAPERS, 6, 2.0, 0.3));
        for ratio in ratios(&points) {
            // What suits the papers best counts.
            assert_eq!((ratio.points, ratio.is_bound), (6, true));
            assert!((ratio.value() - 20.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_default_that_is_always_more_accurate_gives_a_bound() {
        let mut points = default_curve();
        points.push(point(PAPERS, 12, 8.0, 0.5));
        let ratio = ratios(&points)[0];
        assert!(ratio.is_bound && (ratio.value() - 80.0).abs() < 1e-9);
        // And what it cannot reach at all gives nothing.
        points.push(point(PAPERS, 24, 80.0, 0.001));
        assert_eq!(ratios(&points)[0].unreached, 1);
        points.retain(|p| p.setting.method == DEFAULT || p.setting.points == 24);
        assert!(ratios(&points).is_empty());
    }

    #[test]
    fn the_pareto_line_is_of_points_that_nothing_beats() {
        let elastic = Method {
            coupling: Coupling::Elastic,
            ..DEFAULT
        };
        let mut points = default_curve();
        points.push(point(elastic, 12, 0.2, 0.04));
        points.push(point(PAPERS, 12, 8.0, 0.02));
        let costs: Vec<f64> = pareto(&points, Measure::Amplitude)
            .iter()
            .map(|p| p.0.cost())
            .collect();
        assert_eq!(costs, [0.1, 0.2, 1.6]);
        assert_eq!(
            distance_from_pareto(&points, Measure::Amplitude, 6),
            Some(1.0)
        );
        assert_eq!(
            distance_from_pareto(&points, Measure::Amplitude, 12),
            Some(2.0)
        );
    }

    #[test]
    fn promises_are_kept_or_not_or_not_measured() {
        let points = [point(DEFAULT, 12, 0.4, 0.019)];
        let met: Vec<bool> = acceptance(&points).iter().map(Acceptance::is_met).collect();
        assert_eq!(met, [false, true, true, false, false, false]);
    }
}
