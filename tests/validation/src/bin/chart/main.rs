//! Speed against accuracy, measured and drawn: `cargo xtask validate chart`.
//!
//! Combinations of resolution, coupling, sampling, mesh and solver are run on a film whose wrinkles are
//! known, and some of them on a patch that is compressed unevenly, all through the product. Runs are kept in
//! `runs.jsonl`, and a later chart into the same folder goes on from there, so a changed solver wants
//! a new folder. What they say together is in `chart.json` and the page `chart.png`;
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

use clap::Parser;
use ruga_validation::Drawing;
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
    let json = format!("{:#}\n", tables::json(&points));
    fs::write(folder.join("chart.json"), json)?;
    let command = match quick {
        true => "cargo xtask validate chart --quick",
        false => "cargo xtask validate chart",
    };
    write_page(&folder.join("chart.png"), PAGE.size, 2, |own| {
        page(own, &points, command)
    })?;
    write_page(&folder.join("summary.png"), SUMMARY.size, 3, |own| {
        summary(own, &points, command)
    })?;
    print!("\n{}", words::words(&points));
    println!("\nChart and tables are in {}", folder.display());
    Ok(())
}
