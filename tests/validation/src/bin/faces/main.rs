//! Speed and steadiness of the product at the scale of a face: `cargo xtask bench faces`.
//!
//! Each row of the table bakes a scene with the command `ruga`, as a user would, and compares what that
//! took with a goal. Scenes and results are kept in the folder; what was measured there is not measured
//! again, so a changed product wants an empty folder. Faces and a hand come from `../shared/data`; where
//! that is not, their rows are skipped.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "progress and the table are what the program is for"
)]

mod baking;
mod creases;
mod factorisation;
mod mixtures;
mod process;
mod retouching;
mod rows;
mod scenes;
mod speckle;
mod steadiness;
mod table;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use clap::builder::PossibleValuesParser;

use baking::Quality;
use rows::{Bench, Lines};
use table::Line;

/// What is measured, and how finely.
#[derive(Parser)]
struct Arguments {
    /// Folder of scenes and results
    folder: PathBuf,
    /// Rows of the table [default: all]
    #[arg(value_name = "ROW", value_parser = PossibleValuesParser::new(ROWS.map(|row| row.0)))]
    rows: Vec<String>,
    /// Mesh points per wavelength [default: draft for the mixtures, standard for all others]
    #[arg(long)]
    quality: Option<Quality>,
}

/// What measures a row.
type Measure = fn(&Bench) -> Lines;

/// The rows by name.
const ROWS: [(&str, Measure); 9] = [
    ("smile", Bench::smile),
    ("shapes", Bench::shapes),
    ("brows", Bench::brows),
    ("hand", Bench::hand),
    ("area", Bench::area),
    ("mixtures", Bench::mixtures),
    ("mirror", Bench::mirror),
    ("retouching", Bench::retouching),
    ("creases", Bench::creases),
];

/// Measures the rows that are asked for and prints the table.
fn main() -> Result<(), Box<dyn Error>> {
    let wanted = Arguments::parse();
    let bench = Bench {
        folder: std::path::absolute(wanted.folder)?,
        quality: wanted.quality,
    };
    let is_wanted =
        |name: &str| wanted.rows.is_empty() || wanted.rows.iter().any(|row| row == name);
    let mut table = Vec::new();
    for (name, measure) in ROWS.into_iter().filter(|(name, _)| is_wanted(name)) {
        // What keeps one row from being measured need not keep the others.
        let lines = measure(&bench).unwrap_or_else(|error| {
            eprintln!("{name}: {error}");
            vec![Line::note(format!("not measured: {error}"))]
        });
        table.extend(lines.into_iter().map(|line| (name, line)));
    }
    print!("\n{}", table::text(&table));
    println!("\nScenes and results are in {}", bench.folder.display());
    Ok(())
}
