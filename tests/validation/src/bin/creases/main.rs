//! Sharp creases, ours and those of Patkar, Jin and Fedkiw 2014, measured and drawn:
//! `cargo xtask validate creases`.
//!
//! What was measured is in `findings.json`, as words in `creases.txt`, and on the page `creases.png`; beside it
//! lie pictures of folded sheets.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "progress and findings are what the program is for"
)]

mod block;
mod drifts;
mod findings;
mod hung;
mod onsets;
mod page;
mod panels;
mod pictures;
mod sheets;
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
        let mut findings = Findings::measure(quick);
        findings.pictures = pictures::draw_all(&folder)?;
        eprintln!("cloths hung by corners");
        findings.cloths = hung::draw_hung(&folder)?;
        eprintln!("pressed blocks");
        findings.blocks = block::draw_blocks(&folder)?;
        fs::write(&file, serde_json::to_string_pretty(&findings)?)?;
        findings
    };
    let words = words::words(&findings);
    fs::write(folder.join("creases.txt"), &words)?;
    let command = match quick {
        true => "cargo xtask validate creases --quick",
        false => "cargo xtask validate creases",
    };
    write_page(&folder.join("creases.png"), page::SIZE, 2, |own| {
        page::page(own, &findings, command)
    })?;
    print!("\n{words}");
    println!("\nPictures and numbers are in {}", folder.display());
    Ok(())
}
