//! Project tasks, started as `cargo xtask TASK`: a task's name in, its effect on the repository out.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a task reports to the person who started it"
)]

mod assets;
mod bench;
mod book;
mod check;
mod fuzz;
mod page;
mod repository;
mod test;
mod validate;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use validate::Study;

/// Tasks of this project.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Checks format, lints, documentation, the links of the book, and that nothing is built twice
    Check,
    /// Runs the tests, in minutes
    Test,
    /// Runs what takes long: one of the studies, or all of them and the long tests
    Validate {
        study: Option<Study>,
        /// Where to draw [default: target/STUDY]; a chart goes on where an earlier run into the same
        /// folder ended, so measure changed code into another one
        #[arg(long)]
        folder: Option<PathBuf>,
        /// Takes coarser meshes, fewer samples and fewer load steps
        #[arg(long)]
        quick: bool,
        /// Draws what an earlier run measured: chart, bodies, creases and burning
        #[arg(long)]
        redraw: bool,
    },
    /// Regenerates the meshes and painted images under assets/
    Assets,
    /// Runs the benchmarks on one thread and compares them, then measures faces and a hand against goals
    Bench {
        #[command(subcommand)]
        part: Option<bench::Part>,
    },
    /// Tries random input, or new cases of the property tests; inputs with finds go to target/fuzz
    #[command(after_help = fuzz::HELP)]
    Fuzz {
        /// `[SECONDS] [--from NUMBER] [TARGET]...`, `again TARGET-NUMBER`, or
        /// `properties [ROUNDS] [CRATE]...`
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        words: Vec<String>,
    },
    /// Bundles the scripts of the preview page with three.js into one committed file; needs Node and npm
    Page,
    /// Draws the face with the maps that `ruga bake assets/face/scene.toml -o DIR` left in DIR
    Picture {
        #[arg(value_name = "DIR")]
        bake: PathBuf,
    },
}

fn main() -> ExitCode {
    let done = match Arguments::parse().task {
        Task::Check => check::check(),
        Task::Test => test::test(),
        Task::Validate {
            study,
            folder,
            quick,
            redraw,
        } => validate::validate(study, folder, [("--quick", quick), ("--redraw", redraw)]),
        Task::Assets => assets::regenerate(),
        Task::Bench { part } => bench::bench(part),
        Task::Fuzz { words } => fuzz::fuzz(&words),
        Task::Page => page::bundle(),
        Task::Picture { bake } => validate::picture(&bake),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}
