//! Tries random input for as long as it is told to: `cargo xtask fuzz`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what was tried and found is what this is for"
)]

mod finds;
mod search;
mod worker;

use std::path::Path;
use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

use ruga_tests::Target;

const USAGE: &str = "\
usage: fuzz FOLDER [SECONDS] [--from NUMBER] [TARGET]...   search, keep finds in FOLDER
       fuzz FOLDER again TARGET-NUMBER                     try one input again
targets: scene gltf obj png exr remesh program
";

/// Seconds for all targets together unless it is said otherwise.
const DEFAULT_SECONDS: u64 = 600;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        // The program that is tried, in a process that may die.
        ["ruga", ..] => ruga_cli::run(&arguments),
        ["worker", folder, target, first, seconds] => {
            worker::run(Path::new(folder), target, first, seconds)
        }
        [folder, "again", input] => match worker::again(Path::new(folder), input) {
            Some(code) => code,
            None => wrong_usage(),
        },
        [folder, words @ ..] => match Wanted::read(words) {
            Some(wanted) => search::search(Path::new(folder), &wanted),
            None => wrong_usage(),
        },
        [] => wrong_usage(),
    }
}

fn wrong_usage() -> ExitCode {
    eprint!("{USAGE}");
    ExitCode::from(2)
}

/// What is to be tried, and for how long.
pub(crate) struct Wanted {
    /// For all targets together.
    pub(crate) seconds: u64,
    /// Number of the first input.
    pub(crate) first: u64,
    /// In the order of trial.
    pub(crate) targets: Vec<Target>,
}

impl Wanted {
    fn read(words: &[&str]) -> Option<Self> {
        // Every search sees other inputs: a find is known by its number.
        let since = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        let mut wanted = Self {
            seconds: DEFAULT_SECONDS,
            first: since.as_secs() << 24,
            targets: Vec::new(),
        };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            if *word == "--from" {
                wanted.first = words.next()?.parse().ok()?;
            } else if let Ok(seconds) = word.parse() {
                wanted.seconds = seconds;
            } else {
                wanted.targets.push(Target::named(word)?);
            }
        }
        if wanted.targets.is_empty() {
            wanted.targets = Target::ALL.to_vec();
        }
        Some(wanted)
    }
}
