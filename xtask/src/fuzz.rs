//! `fuzz`: random input for everything that reads, and new cases for the property tests.

use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::repository::{Outcome, run, target_folder};

/// Rounds of the property tests unless it is said otherwise: a thousand times as many cases as a
/// run of the test suite.
const DEFAULT_ROUNDS: u64 = 1000;

/// Crates with property tests, and their tests' files.
const PACKAGES: [&str; 5] = [
    "ruga-bake",
    "ruga-io",
    "ruga-material",
    "ruga-mesh",
    "ruga-remesh",
];
const FILES: [&str; 10] = [
    "bad_input",
    "critical_wave",
    "damaged_files",
    "inverse_design",
    "padding",
    "properties",
    "property_map",
    "rasterisation",
    "relative",
    "stack",
];

/// Runs the fuzzer with what was typed after `fuzz`; finds go to `target/fuzz`.
///
/// In the dev profile, whose arithmetic is checked for overflow: more is found than in release.
pub(crate) fn fuzz(words: &[&str]) -> Outcome {
    if let ["properties", words @ ..] = words {
        return properties(words);
    }
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

/// Runs the property tests round after round, each with cases never drawn before, until one fails
/// or the rounds that were asked for are over. The command that is echoed runs a round again.
fn properties(words: &[&str]) -> Outcome {
    let (rounds, packages) = match words.split_first() {
        Some((first, rest)) if first.parse::<u64>().is_ok() => (first.parse()?, rest),
        _ => (DEFAULT_ROUNDS, words),
    };
    let packages = if packages.is_empty() {
        &PACKAGES[..]
    } else {
        packages
    };
    let mut arguments = vec!["test", "--quiet"];
    arguments.extend(packages.iter().flat_map(|name| ["--package", name]));
    arguments.extend(FILES.iter().flat_map(|name| ["--test", name]));
    let since = SystemTime::now().duration_since(UNIX_EPOCH)?;
    let first = since.as_secs() << 24;
    for round in 0..rounds {
        let seed = (first + round).to_string();
        if let Some(failed) = run(&[("PROPTEST_RNG_SEED", &seed)], &arguments)? {
            return Ok(failed);
        }
    }
    eprintln!("{rounds} rounds, none failed");
    Ok(ExitCode::SUCCESS)
}
