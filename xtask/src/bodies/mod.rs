//! `bodies`: what soft bodies under a skin have to show, measured and drawn (Rémillard and Kry 2013,
//! figures 3, 4, 6 and 7 and table 1).
//!
//! The measuring is done by the program `bodies` of the tests, a line of JSON for each finding. All
//! lines are in `findings.jsonl`, the samples in `isocontours.csv` and `dense.csv`, times at the papers'
//! sizes in `sizes.txt`, the page is `bodies.svg` and `bodies.png`, and what it says against its goals is
//! printed.

mod contour;
mod findings;
mod page;
mod panel;
mod panels;
mod ruler;
mod speed;
mod tables;
mod verdict;
mod words;

use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{ExitCode, Stdio};
use std::time::Instant;

use serde_json::Value;

use crate::repository::{Outcome, cargo, run};
use crate::wanted::Wanted;
use findings::Findings;

/// Pixels per unit of the page.
const SCALE: f32 = 1.6;

const PACKAGE: [&str; 5] = ["--release", "--package", "ruga-tests", "--bin", "bodies"];

/// Measures, draws, and prints what was found.
pub(crate) fn bodies(wanted: &Wanted) -> Outcome {
    let folder = wanted.folder("bodies")?;
    if let Some(code) = run(&[], &[["build"].as_slice(), &PACKAGE].concat())? {
        return Ok(code);
    }
    let lines = measure(wanted.quick)?;
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    fs::write(folder.join("findings.jsonl"), text)?;
    let findings = Findings::read(&lines);
    fs::write(
        folder.join("isocontours.csv"),
        tables::isocontours(&findings),
    )?;
    fs::write(folder.join("dense.csv"), tables::dense(&findings))?;
    let sizes = tables::sizes(&findings);
    fs::write(folder.join("sizes.txt"), &sizes)?;
    let command = match wanted.quick {
        true => "cargo xtask bodies --quick",
        false => "cargo xtask bodies",
    };
    let page = page::page(&findings, command);
    fs::write(folder.join("bodies.svg"), page.svg())?;
    fs::write(folder.join("bodies.png"), page.png(SCALE)?)?;
    print!("\n{}\n{sizes}", words::words(&findings));
    println!("\nPicture and tables are in {}", folder.display());
    Ok(ExitCode::SUCCESS)
}

/// The findings, told as they come; measured on one thread, so that times can be compared.
fn measure(quick: bool) -> Result<Vec<Value>, Box<dyn Error>> {
    let start = Instant::now();
    let mut command = cargo(&["run", "--quiet"]);
    command.env("RAYON_NUM_THREADS", "1");
    command.args(PACKAGE).stdout(Stdio::piped());
    if quick {
        command.args(["--", "--quick"]);
    }
    let mut process = command.spawn()?;
    let output = process.stdout.take().ok_or("a process without a pipe")?;
    let mut lines = Vec::new();
    for line in BufReader::new(output).lines() {
        let line: Value = serde_json::from_str(&line?)?;
        let seconds = start.elapsed().as_secs_f64();
        eprintln!("{seconds:7.1} s  {}", words::line(&line));
        lines.push(line);
    }
    let status = process.wait()?;
    if !status.success() {
        return Err(format!("measuring ended with {status}").into());
    }
    Ok(lines)
}
