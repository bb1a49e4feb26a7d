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

/// A line for every package that `cargo run` builds with other features than the tests: it and all that
/// depends on it would be built once more.
fn twice_built() -> Result<Vec<String>, Box<dyn Error>> {
    let run = features("normal,build")?;
    let tests = features("normal,build,dev")?;
    let message = "tests want other features; name what does in tests/validation/Cargo.toml";
    let twice = run.difference(&tests);
    Ok(twice.map(|line| format!("{line}: {message}")).collect())
}

/// Packages with their versions and features, over the whole workspace.
fn features(edges: &str) -> Result<BTreeSet<String>, Box<dyn Error>> {
    let arguments = ["tree", "--workspace", "--prefix", "none", "--no-dedupe"];
    let format = ["--format", "{p} [{f}]", "--edges", edges];
    let output = cargo(&[arguments.as_slice(), &format].concat()).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let text = String::from_utf8(output.stdout)?;
    Ok(text.lines().map(str::to_owned).collect())
}
