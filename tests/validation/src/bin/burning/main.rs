//! Curl of burning sheets, ours and that of Jeong, Kim and Kim 2011, against processor time:
//! `cargo xtask validate burning`.
//!
//! What was measured is in `findings.json`, as words in `burning.txt`, and on the page `burning.png`; beside it lie
//! pictures of sheets of springs after the paper's figures. Of these only captions and text were at hand, so that
//! nothing here can be said to look like them.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "progress and findings are what the program is for"
)]

mod findings;
mod fires;
mod large;
mod ours;
mod page;
mod pictures;
mod sheets;
mod squares;
mod stiffness;
mod torus;
mod words;

use std::error::Error;
use std::fs;

use clap::Parser;
use ruga_validation::Drawing;
use ruga_validation::plot::write_page;

use findings::Findings;

/// Measures, draws, and prints what was found.
fn main() -> Result<(), Box<dyn Error>> {
    let Drawing {
        folder,
        quick,
        redraw,
    } = Drawing::parse();
    fs::create_dir_all(&folder)?;
    let file = folder.join("findings.json");
    let findings: Findings = if redraw {
        serde_json::from_str(&fs::read_to_string(&file)?)?
    } else {
        let mut findings = Findings::measure(quick)?;
        findings.pictures = pictures::draw_all(&folder, quick)?;
        findings.large = large::measure(quick)?;
        fs::write(&file, serde_json::to_string_pretty(&findings)?)?;
        findings
    };
    let words = words::words(&findings);
    fs::write(folder.join("burning.txt"), &words)?;
    let command = match quick {
        true => "cargo xtask validate burning --quick",
        false => "cargo xtask validate burning",
    };
    write_page(&folder.join("burning.png"), page::SIZE, 2, |own| {
        page::page(own, &findings, command)
    })?;
    print!("\n{words}");
    println!("\nPictures and numbers are in {}", folder.display());
    Ok(())
}
