//! `check`: what a change must pass besides the tests.

use std::collections::BTreeSet;
use std::error::Error;
use std::process::ExitCode;

use crate::book;
use crate::repository::{Outcome, cargo, run};

/// An environment and cargo's arguments.
type Step = (
    &'static [(&'static str, &'static str)],
    &'static [&'static str],
);

/// Quickest first. In the release profile, so that macros and build scripts are those of the tests.
const STEPS: [Step; 3] = [
    (&[], &["fmt", "--all", "--check"]),
    (
        &[],
        &[
            "clippy",
            "--release",
            "--workspace",
            "--all-targets",
            "--",
            "-D",
            "warnings",
        ],
    ),
    (
        &[("RUSTDOCFLAGS", "-D warnings")],
        &["doc", "--release", "--workspace", "--no-deps"],
    ),
];

/// Runs the steps in order and stops at the first that fails, with its exit code.
pub(crate) fn check() -> Outcome {
    let wrong: Vec<String> = book::broken_links()?
        .into_iter()
        .chain(twice_built()?)
        .collect();
    if !wrong.is_empty() {
        return Err(wrong.join("\n").into());
    }
    for (environment, arguments) in STEPS {
        if let Some(code) = run(environment, arguments)? {
            return Ok(code);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// A line for every dependency of the command that tests want with other features than `cargo run`
/// does: each of them, and all that depends on it, would be built once more.
fn twice_built() -> Result<impl Iterator<Item = String>, Box<dyn Error>> {
    let tests = features(&["--workspace", "--edges", "normal,build,dev"])?;
    // Of the whole workspace, as `cargo run` unifies features without `--package`.
    let run = features(&["--workspace", "--edges", "normal,build"])?;
    let command = features(&["--package", "ruga-cli", "--edges", "normal,build"])?;
    let name = |line: &str| line.split(" [").next().unwrap_or_default().to_owned();
    let needed: BTreeSet<String> = command.iter().map(|line| name(line)).collect();
    let twice = move |line: &String| needed.contains(&name(line)) && !tests.contains(line);
    let message = "tests want other features; name what does in tests/validation/Cargo.toml";
    Ok(run
        .into_iter()
        .filter(twice)
        .map(move |line| format!("{line}: {message}")))
}

/// Packages with their versions and features.
fn features(selection: &[&str]) -> Result<BTreeSet<String>, Box<dyn Error>> {
    let arguments = ["tree", "--locked", "--prefix", "none", "--no-dedupe"];
    let format = ["--format", "{p} [{f}]"];
    let output = cargo(&[&arguments, &format, selection].concat()).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let text = String::from_utf8(output.stdout)?;
    Ok(text.lines().map(str::to_owned).collect())
}
