//! What soft bodies under a skin have to show, measured and drawn (Rémillard and Kry 2013, figures 3, 4,
//! 6 and 7 and table 1): `cargo xtask validate bodies`.
//!
//! All findings are in `findings.jsonl`, times at the papers' sizes in `sizes.txt`, the page is
//! `bodies.png`, and what it says against its goals is printed.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "progress and findings are what the program is for"
)]

mod contour;
mod findings;
mod page;
mod panels;
mod speed;
mod tables;
mod verdict;
mod words;

use std::error::Error;
use std::fs::{self, File};
use std::io::Write;
use std::time::Instant;

use clap::Parser;
use ruga_solver::minimise;
use ruga_stepper::Coupling;
use ruga_validation::Drawing;
use ruga_validation::body::{
    Cushion, Extent, artefact, cell_limit, dense, is_compared, isocontours, locality, sizes,
};
use ruga_validation::plot::write_page;

use findings::{Finding, Findings, HYBRID, Throw};

/// Measures, draws, and prints what was found.
fn main() -> Result<(), Box<dyn Error>> {
    let Drawing {
        folder,
        quick,
        redraw,
    } = Drawing::parse();
    fs::create_dir_all(&folder)?;
    let file = folder.join("findings.jsonl");
    if !redraw {
        let extent = if quick { Extent::Quick } else { Extent::Full };
        let mut log = Log {
            file: File::create(&file)?,
            start: Instant::now(),
        };
        measure(extent, &mut |finding| log.keep(&finding))?;
    }
    let lines = fs::read_to_string(&file)?;
    let lines: Result<Vec<Finding>, _> = lines.lines().map(serde_json::from_str).collect();
    let findings = Findings::of(lines?);
    let sizes = tables::sizes(&findings);
    fs::write(folder.join("sizes.txt"), &sizes)?;
    let command = match quick {
        true => "cargo xtask validate bodies --quick",
        false => "cargo xtask validate bodies",
    };
    write_page(&folder.join("bodies.png"), page::SIZE, 2, |own| {
        page::page(own, &findings, command)
    })?;
    print!("\n{}\n{sizes}", words::words(&findings));
    println!("\nPicture and tables are in {}", folder.display());
    Ok(())
}

/// Where findings go as they come.
struct Log {
    file: File,
    start: Instant,
}

impl Log {
    fn keep(&mut self, finding: &Finding) {
        let line = serde_json::to_string(finding).expect("numbers and names");
        let written = writeln!(self.file, "{line}");
        written.expect("a file that could be created can be written");
        let seconds = self.start.elapsed().as_secs_f64();
        eprintln!("{seconds:7.1} s  {}", words::line(finding));
    }
}

/// Lengths of a step in time, s.
const TIME_STEPS: [f64; 3] = [0.005, 0.02, 0.05];

fn measure(extent: Extent, each: &mut dyn FnMut(Finding)) -> Result<(), Box<dyn Error>> {
    artefact()?
        .into_iter()
        .for_each(|own| each(Finding::Artefact(own)));
    locality()?
        .into_iter()
        .for_each(|own| each(Finding::Locality(own)));
    cell_limit(extent, &mut |own| each(Finding::CellLimit(own.clone())))?;
    let mut samples = Vec::new();
    isocontours(extent, &mut |own| {
        each(Finding::Isocontour(own.clone()));
        samples.push(own.clone());
    })?;
    let is_dense = |own: &&_| is_hybrid_and_compared(own);
    for own in samples.iter().filter(is_dense) {
        each(Finding::Dense(dense(own)?));
    }
    let steps = match extent {
        Extent::Full => 1000,
        Extent::Quick => 50,
    };
    for time_step in TIME_STEPS {
        each(Finding::Thrown(throw(time_step, steps)?));
    }
    sizes(extent, &mut |own| each(Finding::Size(*own)))
}

fn is_hybrid_and_compared(own: &ruga_validation::body::Isocontour) -> bool {
    own.coupling == HYBRID && is_compared(own.sample)
}

fn throw(time_step: f64, steps: u32) -> Result<Throw, Box<dyn Error>> {
    let cushion = Cushion {
        scale: 1.0,
        thickness: 1.2e-3,
        ratio: 1000.0,
        cells: 3,
        points: 5.0,
        is_fitted: true,
        coupling: Coupling::Hybrid,
        time_step,
        steps,
        minimise,
    };
    let own = cushion.throw()?;
    Ok(Throw {
        time_step,
        steps,
        frames: own.frames,
        outside: own.outside,
        heights: own.heights,
        factorizations: own.report.factorizations,
        converged: own.converged,
    })
}
