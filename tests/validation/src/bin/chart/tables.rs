//! The points and what they say as one table, for programs.

use ruga_validation::curl_panel::CurlRun;
use ruga_validation::fold_panel::FoldRun;
use serde_json::{Value, json};

use crate::plan::QUALITIES;
use crate::results::{Measure, Point};
use crate::verdict::{acceptance, distance_from_pareto, ratios};

/// The points, and what they say about the default. Errors are absolute: shares, and degrees for normals.
pub(crate) fn json(points: &[Point], folds: &[FoldRun], curls: &[CurlRun]) -> Value {
    let pareto = Measure::ALL.iter().flat_map(|&measure| {
        QUALITIES.map(|(name, quality)| {
            let cost = distance_from_pareto(points, measure, quality);
            json!({ "measure": measure, "quality": name, "cost_over_pareto": cost })
        })
    });
    json!({
        "points": points,
        "default_against_papers": ratios(points),
        "acceptance": acceptance(points),
        "default_against_pareto": pareto.collect::<Vec<_>>(),
        "crease_elements": folds,
        "curl": curls,
    })
}
