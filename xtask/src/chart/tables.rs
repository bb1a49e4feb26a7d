//! The points as tables, for programs.

use serde_json::{Value, json};

use super::plan::QUALITIES;
use super::results::{Measure, Point, Spread};
use super::verdict::{acceptance, distance_from_pareto, ratios};

/// One row per setting; empty where nothing was measured. Errors are absolute: shares, and degrees
/// for normals.
pub(super) fn csv(points: &[Point]) -> String {
    let mut header =
        "problem,points_per_wavelength,coupling,sampling,bending,mesh,solver,runs,failed,vertices,\
                      seconds_per_frame,seconds_low,seconds_high,seconds_per_thousand_vertices"
            .to_owned();
    for measure in Measure::ALL {
        let name = measure.name();
        header += &format!(",{name},{name}_low,{name}_high");
    }
    let mut csv = header + "\n";
    for point in points {
        let method = &point.setting.method;
        let mut cells = vec![
            point.setting.problem.name().to_owned(),
            point.setting.points.to_string(),
            method.coupling.to_owned(),
            method.sampling.to_owned(),
            method.bending.to_owned(),
            method.mesh.to_owned(),
            method.solver.to_owned(),
            point.runs.to_string(),
            point.failed.to_string(),
            point.vertices.map_or(String::new(), |n| format!("{n:.0}")),
        ];
        cells.extend(cells_of(point.seconds.as_ref()));
        let per_thousand = point.seconds_per_thousand.as_ref();
        cells.push(per_thousand.map_or(String::new(), |s| number(s.median)));
        for measure in Measure::ALL {
            cells.extend(cells_of(point.errors.get(&measure)));
        }
        csv += &(cells.join(",") + "\n");
    }
    csv
}

fn cells_of(spread: Option<&Spread>) -> [String; 3] {
    match spread {
        Some(s) => [s.median, s.low, s.high].map(number),
        None => Default::default(),
    }
}

fn number(value: f64) -> String {
    format!("{value:.6}")
}

/// The points and what they say.
pub(super) fn json(points: &[Point]) -> Value {
    let spread = |s: &Spread| json!({ "median": s.median, "low": s.low, "high": s.high });
    let of_point = |point: &Point| {
        let method = &point.setting.method;
        let errors = point.errors.iter();
        let errors: serde_json::Map<_, _> = errors
            .map(|(measure, s)| (measure.name().to_owned(), spread(s)))
            .collect();
        json!({
            "problem": point.setting.problem.name(),
            "points_per_wavelength": point.setting.points,
            "coupling": method.coupling,
            "sampling": method.sampling,
            "bending": method.bending,
            "mesh": method.mesh,
            "solver": method.solver,
            "runs": point.runs,
            "failed": point.failed,
            "failures": point.failures,
            "vertices": point.vertices,
            "seconds_per_frame": point.seconds.as_ref().map(spread),
            "seconds_per_thousand_vertices": point.seconds_per_thousand.as_ref().map(spread),
            "errors": errors,
        })
    };
    let ratios = ratios(points);
    let ratios = ratios.iter().map(|r| {
        json!({
            "measure": r.measure.name(), "ratio": r.value(), "is_lower_bound": r.is_bound,
            "error": r.error, "papers_points_per_wavelength": r.points,
            "papers_seconds": r.seconds[0], "default_seconds": r.seconds[1],
            "papers_resolutions_more_accurate_than_any_default": r.unreached,
        })
    });
    let acceptance = acceptance(points);
    let acceptance = acceptance.iter().map(|a| {
        json!({
            "points_per_wavelength": a.points, "measure": a.measure.name(),
            "accepted": a.accepted, "error": a.error, "is_met": a.is_met(),
        })
    });
    let pareto = Measure::ALL.iter().flat_map(|&measure| {
        QUALITIES.map(|(name, quality)| {
            let cost = distance_from_pareto(points, measure, quality);
            json!({ "measure": measure.name(), "quality": name, "cost_over_pareto": cost })
        })
    });
    json!({
        "points": points.iter().map(of_point).collect::<Vec<_>>(),
        "default_against_papers": ratios.collect::<Vec<_>>(),
        "acceptance": acceptance.collect::<Vec<_>>(),
        "default_against_pareto": pareto.collect::<Vec<_>>(),
    })
}
