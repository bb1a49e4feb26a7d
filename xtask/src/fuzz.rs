//! `fuzz`: random input for everything that reads.

use std::process::ExitCode;

use crate::repository::{Outcome, run, target_folder};

/// Runs the fuzzer with what was typed after `fuzz`; finds go to `target/fuzz`.
///
/// In the dev profile, whose arithmetic is checked for overflow: more is found than in release.
pub(crate) fn fuzz(words: &[&str]) -> Outcome {
    let folder = target_folder()?.join("fuzz");
    let folder = folder.to_string_lossy();
    let program = [
        "run",
        "--quiet",
        "--package",
        "ruga-tests",
        "--bin",
        "fuzz",
        "--",
        &folder,
    ];
    let failed = run(&[], &[&program, words].concat())?;
    Ok(failed.unwrap_or(ExitCode::SUCCESS))
}
