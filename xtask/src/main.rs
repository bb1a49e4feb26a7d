//! Project tasks, started as `cargo xtask TASK`: a task's name in, its effect on the repository out.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a task reports to the person who started it"
)]

mod assets;
mod bench;
mod bodies;
mod chart;
mod check;
mod drawing;
mod figures;
mod fuzz;
mod light;
mod picture;
mod repository;
mod stability;
mod wanted;

use std::path::Path;
use std::process::ExitCode;

use wanted::Wanted;

const USAGE: &str = "\
usage: cargo xtask TASK

  check        format, lints, documentation and tests, as CI runs them
  assets       regenerate the meshes and painted images under assets/
  bench        run the benchmarks on one thread and compare them
  stability    run the stability suite and print what each method does in it
  patterns     run labyrinths, herringbone and pulled sheet at length
  fuzz [SECONDS] [--from NUMBER] [TARGET]...
               try random input for SECONDS [default: 600]; inputs with finds go to target/fuzz;
               targets: scene, gltf, obj, png, exr, remesh, program [default: all];
               fuzz again TARGET-NUMBER tries one input again
  fuzz properties [ROUNDS] [CRATE]...
               run the property tests ROUNDS times [default: 1000] with new random cases,
               of the named crates [default: all], until one fails; the echoed command
               runs a round again
  figures [DIR] [--quick]
               draw the figures and tables after Li 2014 and Rémillard and Kry 2013 into DIR
               [default: target/figures]: simulate the scenes under assets/, then do what
               `bodies` does in DIR/bodies; --quick takes coarse meshes, few load steps
               and few samples
  chart [DIR] [--quick] [--redraw]
               measure speed against accuracy and draw the chart into DIR
               [default: target/chart]; goes on where an earlier run ended,
               so measure changed code into another folder; takes about an
               hour of processor time, on two cores half as long;
               --quick takes fewer and coarser runs, six minutes of it;
               --redraw draws the runs that there are
  bodies [DIR] [--quick]
               measure what skins on soft bodies must show, after Rémillard and Kry 2013:
               wavelengths over thickness and stiffness, against volumes, on lattices of
               different cells, where a bent bar wrinkles; draw it into DIR
               [default: target/bodies], with a body thrown for a thousand steps and times at
               the paper's sizes; takes about half an hour of processor time;
               --quick takes fewer samples, about two minutes
  picture DIR  shade the maps that `ruga bake assets/forearm/scene.toml -o DIR` left in DIR
";

/// The task was not understood; clap's and grep's convention too.
const WRONG_USAGE: u8 = 2;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["check"] => check::check(),
        ["assets"] => assets::regenerate(),
        ["bench"] => bench::bench(),
        ["stability"] => stability::stability(),
        ["patterns"] => patterns(),
        ["fuzz", words @ ..] => fuzz::fuzz(words),
        ["figures", words @ ..] => match Wanted::read(words) {
            Some(wanted) => figures::figures(&wanted),
            None => return wrong_usage("`figures` takes a folder and `--quick`"),
        },
        ["chart", words @ ..] => {
            let others = words.iter().copied().filter(|word| *word != "--redraw");
            let others: Vec<&str> = others.collect();
            match Wanted::read(&others) {
                Some(wanted) if others.len() < words.len() => chart::redraw(&wanted),
                Some(wanted) => chart::chart(&wanted),
                None => return wrong_usage("`chart` takes a folder, `--quick` and `--redraw`"),
            }
        }
        ["bodies", words @ ..] => match Wanted::read(words) {
            Some(wanted) => bodies::bodies(&wanted),
            None => return wrong_usage("`bodies` takes a folder and `--quick`"),
        },
        ["picture", folder] => picture::picture(Path::new(folder)),
        ["picture"] => return wrong_usage("`picture` needs the folder of a finished bake"),
        ["help" | "--help" | "-h"] => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        [] => return wrong_usage("no task given"),
        other => return wrong_usage(&format!("no task `{}`", other.join(" "))),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs the program with the long comparisons of patterns.
fn patterns() -> repository::Outcome {
    let program = [
        "run",
        "--release",
        "--package",
        "ruga-tests",
        "--example",
        "patterns",
    ];
    let failed = repository::run(&[], &program)?;
    Ok(failed.unwrap_or(ExitCode::SUCCESS))
}

fn wrong_usage(reason: &str) -> ExitCode {
    eprint!("xtask: {reason}\n\n{USAGE}");
    ExitCode::from(WRONG_USAGE)
}
