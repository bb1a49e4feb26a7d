//! What the chart says, in words.

use ruga_validation::curl_panel::{CurlRun, THICKNESSES, times_sooner};

use crate::plan::{PAPERS, QUALITIES};
use crate::results::{Measure, Point};
use crate::setting::word;
use crate::verdict::{Acceptance, Ratio, acceptance, distance_from_pareto, ratios};

/// How many times cheaper than the papers' way the default is meant to be.
const CHEAPER: f64 = 5.0;

/// All of it, for people.
pub(crate) fn words(points: &[Point], own: &[CurlRun]) -> String {
    let mut lines = promises(&acceptance(points));
    lines.push(String::new());
    lines.extend(costs(&ratios(points)));
    lines.push(String::new());
    lines.extend(distances(points));
    lines.push(String::new());
    lines.extend(curls(own));
    lines.push(String::new());
    lines.extend(failures(points));
    lines.join("\n") + "\n"
}

fn promises(all: &[Acceptance]) -> Vec<String> {
    let title = "The default against the film that is known, median of the seeds:".to_owned();
    let line = |a: &Acceptance| {
        let error = a
            .error
            .map_or("not measured".to_owned(), |e| a.measure.words(e));
        let mark = if a.is_met() { "kept" } else { "MISSED" };
        format!(
            "  {:>2} points  {:<10} {error:>12}, promised {:<7} {mark}",
            a.points,
            a.measure.name(),
            a.measure.words(a.accepted),
        )
    };
    std::iter::once(title).chain(all.iter().map(line)).collect()
}

fn costs(ratios: &[Ratio]) -> Vec<String> {
    let way = PAPERS.words();
    let mut lines = vec![format!(
        "The papers' way ({way}) over the default, in cost at equal error:"
    )];
    lines.extend(ratios.iter().map(cost));
    if let Some(least) = ratios.iter().map(Ratio::value).min_by(f64::total_cmp) {
        let is_reached = ratios.iter().all(|ratio| ratio.unreached == 0);
        let verdict = match (least >= CHEAPER, is_reached) {
            (true, true) => "holds",
            (true, false) => "holds where the default is as accurate at all",
            (false, _) => "FAILS",
        };
        lines.push(format!(
            "  least {least:.1} x; `at least {CHEAPER} times cheaper` {verdict}"
        ));
    }
    let note = "\
        \x20 (at the resolution that suits the papers best; the default's cost by a straight line of\n\
        \x20 logarithms between its two nearest resolutions; `more than`: its coarsest mesh has a smaller\n\
        \x20 error already)";
    lines.push(note.to_owned());
    lines
}

fn cost(ratio: &Ratio) -> String {
    let unreached = match ratio.unreached {
        0 => String::new(),
        count => format!("; at {count} of its resolutions no default is as accurate"),
    };
    format!(
        "  {:<16} {}{:.1} x: {} at {} points in {:.3} s per key, the default in {:.4} s{unreached}",
        ratio.measure.name(),
        if ratio.is_bound { "more than " } else { "" },
        ratio.value(),
        ratio.measure.words(ratio.error),
        ratio.points,
        ratio.seconds[0],
        ratio.seconds[1],
    )
}

fn distances(points: &[Point]) -> Vec<String> {
    let title =
        "Cost of the default over the cheapest way to be as accurate (1: on the Pareto line):";
    let line = |measure: &Measure| {
        let of_quality = |(name, quality): (&str, u32)| {
            let distance = distance_from_pareto(points, *measure, quality);
            let distance = distance.map_or("-".to_owned(), |d| format!("{d:.2}"));
            format!("{name} {distance:>6}")
        };
        let all = QUALITIES.map(of_quality).join("   ");
        format!("  {:<16} {all}", measure.name())
    };
    let lines = Measure::ALL.iter().map(line);
    std::iter::once(title.to_owned()).chain(lines).collect()
}

/// Speed against the paper's springs at the error of the curl that these reach.
pub(crate) fn curls(runs: &[CurlRun]) -> Vec<String> {
    let mut lines =
        vec!["Curl of a strip against the springs of Jeong, Kim and Kim 2011:".to_owned()];
    for thickness in THICKNESSES {
        let springs = runs
            .iter()
            .filter(|own| own.is_springs && own.thickness == thickness);
        let best = springs.min_by(|a, b| a.error().total_cmp(&b.error()));
        let Some((best, times)) = best.zip(times_sooner(runs, thickness)) else {
            continue;
        };
        lines.push(format!(
            "  layers {thickness} of a cell apart: springs are off by {:.0} %",
            100.0 * best.error()
        ));
        lines.push(format!(
            "    after {} projections, ruga is as near {times:.1} times sooner",
            best.number
        ));
    }
    lines
}

fn failures(points: &[Point]) -> Vec<String> {
    let line = |point: &Point| {
        format!(
            "  {} of {}  {}: {} at {} points: {}",
            point.failed,
            point.runs,
            word(point.setting.problem),
            point.setting.method.words(),
            point.setting.points,
            point.failures[0],
        )
    };
    let failed = points.iter().filter(|point| point.failed > 0);
    std::iter::once("Runs that failed:".to_owned())
        .chain(failed.map(line))
        .collect()
}
