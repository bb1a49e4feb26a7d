//! Speed against accuracy, measured and drawn: `cargo xtask validate chart`.
//!
//! Combinations of resolution, coupling, sampling, mesh and solver are run on a film whose wrinkles are
//! known, and some of them on a patch that is compressed unevenly, all through the product. Runs are kept in
//! `runs.jsonl`, and a later chart into the same folder goes on from there, so a changed solver wants
//! a new folder. Crease elements, ours and the paper's, are in `folds.json`, curl of a strip,
//! ours and by the paper's springs, in `curls.json`. What they say together is in `chart.json` and the page `chart.png`;
//! `summary.png` is the picture in the README.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "progress and what the chart says are what the program is for"
)]

mod film;
mod key;
mod measure;
mod page;
mod panel;
mod patch;
mod plan;
mod product;
mod results;
mod setting;
mod tables;
mod verdict;
mod words;

use std::error::Error;
use std::fs;
use std::path::Path;

use clap::Parser;
use ruga_validation::Drawing;
use ruga_validation::curl_panel::{CurlRun, measure_curls};
use ruga_validation::fold_panel::{FoldRun, measure_folds};
use ruga_validation::plot::write_page;

use page::{PAGE, SUMMARY, page, summary};

/// Measures what is missing, draws, and prints what the chart says.
fn main() -> Result<(), Box<dyn Error>> {
    let Drawing {
        folder,
        quick,
        redraw,
    } = Drawing::parse();
    fs::create_dir_all(&folder)?;
    let (runs, file) = (plan::runs(quick), folder.join("runs.jsonl"));
    if !redraw {
        measure::measure(&runs, &file)?;
    }
    let points = results::points(&runs, &measure::measured(&runs, &file)?);
    let folds = folds(&folder, quick, redraw)?;
    let curls = curls(&folder, quick, redraw)?;
    let json = format!("{:#}\n", tables::json(&points, &folds, &curls));
    fs::write(folder.join("chart.json"), json)?;
    let command = match quick {
        true => "cargo xtask validate chart --quick",
        false => "cargo xtask validate chart",
    };
    write_page(&folder.join("chart.png"), PAGE.size, 2, |own| {
        page(own, (&points, &folds, &curls), command)
    })?;
    write_page(&folder.join("summary.png"), SUMMARY.size, 3, |own| {
        summary(own, &points, command)
    })?;
    print!("\n{}", words::words(&points, &curls));
    println!("\nChart and tables are in {}", folder.display());
    Ok(())
}

/// Crease elements, from the file of an earlier chart into the same folder if there is one.
fn folds(folder: &Path, quick: bool, redraw: bool) -> Result<Vec<FoldRun>, Box<dyn Error>> {
    let file = folder.join("folds.json");
    match fs::read_to_string(&file) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(_) if redraw => Ok(Vec::new()),
        Err(_) => {
            let folds = measure_folds(quick);
            fs::write(&file, serde_json::to_string_pretty(&folds)?)?;
            Ok(folds)
        }
    }
}

/// Curl of strips, from the file of an earlier chart into the same folder if there is one.
fn curls(folder: &Path, quick: bool, redraw: bool) -> Result<Vec<CurlRun>, Box<dyn Error>> {
    let file = folder.join("curls.json");
    match fs::read_to_string(&file) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(_) if redraw => Ok(Vec::new()),
        Err(_) => {
            let curls = measure_curls(quick)?;
            fs::write(&file, serde_json::to_string_pretty(&curls)?)?;
            Ok(curls)
        }
    }
}
