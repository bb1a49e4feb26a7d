//! `chart`: speed against accuracy, measured and drawn.
//!
//! Every combination of resolution, coupling, sampling, mesh and solver that makes sense is run by
//! `tests/examples/measure_chart`: on a film whose wrinkles are known, and some of them on a patch
//! through the product. Runs are kept in `runs.jsonl`, and a later chart into the same folder goes on
//! from there, so a changed solver wants a new folder. What they say together is in `chart.csv`,
//! `chart.json` and the page `chart.svg` and `chart.png`; `summary.png` is the picture in the README.

mod measure;
mod plan;
mod results;
mod tables;
mod verdict;
mod words;

mod key;
mod labels;
mod page;
mod panel;

use std::fs;
use std::process::ExitCode;

use crate::repository::Outcome;
use crate::wanted::Wanted;

/// Finished runs, one to a line.
const RUNS: &str = "runs.jsonl";

/// Pixels per unit of the page.
const SCALE: f32 = 1.6;

/// Measures what is missing, draws, and prints what the chart says.
pub(crate) fn chart(wanted: &Wanted) -> Outcome {
    let program = match measure::build()? {
        Ok(program) => program,
        Err(code) => return Ok(code),
    };
    let file = wanted.folder("chart")?.join(RUNS);
    measure::measure(&program, &plan::runs(wanted.quick), &file)?;
    redraw(wanted)
}

/// The same with the runs that there are.
pub(crate) fn redraw(wanted: &Wanted) -> Outcome {
    let folder = wanted.folder("chart")?;
    let runs = plan::runs(wanted.quick);
    let lines = measure::measured(&runs, &folder.join(RUNS))?;
    let points = results::points(&runs, &lines);
    fs::write(folder.join("chart.csv"), tables::csv(&points))?;
    let json = format!("{:#}\n", tables::json(&points));
    fs::write(folder.join("chart.json"), json)?;
    let command = match wanted.quick {
        true => "cargo xtask chart --quick",
        false => "cargo xtask chart",
    };
    let page = page::page(&points, command);
    fs::write(folder.join("chart.svg"), page.svg())?;
    fs::write(folder.join("chart.png"), page.png(SCALE)?)?;
    let summary = page::summary(&points, command);
    fs::write(folder.join("summary.png"), summary.png(1.0)?)?;
    print!("\n{}", words::words(&points));
    println!("\nChart and tables are in {}", folder.display());
    Ok(ExitCode::SUCCESS)
}
