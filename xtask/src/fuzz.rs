//! `fuzz`: random input for everything that reads, and new cases for the property tests.

use std::error::Error;
use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::repository::{Outcome, run, target_folder};

/// Rounds of the property tests unless it is said otherwise: a thousand times as many cases as a
/// run of the test suite.
const DEFAULT_ROUNDS: u64 = 1000;

/// Crates with property tests, each with the files that hold them.
const SUITES: [(&str, &[&str]); 6] = [
    ("ruga-bake", &["packing", "padding", "rasterisation"]),
    ("ruga-io", &["damaged_files"]),
    (
        "ruga-material",
        &[
            "bad_input",
            "critical_wave",
            "inverse_design",
            "property_map",
            "relative",
            "stack",
        ],
    ),
    ("ruga-mesh", &["properties"]),
    ("ruga-remesh", &["properties"]),
    ("ruga-scene", &["damaged_scenes"]),
];

/// What may follow `fuzz`.
pub(crate) const HELP: &str = "\
[SECONDS] [--from NUMBER] [TARGET]...  random input for SECONDS [default: 600]; targets: scene, gltf,
                                       obj, png, exr, remesh, program [default: all]
again TARGET-NUMBER                    one input again
properties [ROUNDS] [CRATE]...         the property tests of the named crates [default: all] with new
                                       cases, ROUNDS times [default: 1000], until one fails; the
                                       echoed command runs a round again";

/// Runs the fuzzer with what was typed after `fuzz`; finds go to `target/fuzz`.
///
/// In the dev profile, whose arithmetic is checked for overflow: more is found than in release.
pub(crate) fn fuzz(words: &[String]) -> Outcome {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    if let ["properties", words @ ..] = words.as_slice() {
        return properties(words);
    }
    let folder = target_folder()?.join("fuzz");
    let folder = folder.to_string_lossy();
    let program = ["run", "--quiet", "--bin", "fuzz", "--", &folder];
    let failed = run(&[], &[&program, words.as_slice()].concat())?;
    Ok(failed.unwrap_or(ExitCode::SUCCESS))
}

/// Runs the property tests round after round, each with cases never drawn before, until one fails
/// or the rounds that were asked for are over. The command that is echoed runs a round again.
fn properties(words: &[&str]) -> Outcome {
    let (rounds, packages) = match words.split_first() {
        Some((first, rest)) if first.parse::<u64>().is_ok() => (first.parse()?, rest),
        _ => (DEFAULT_ROUNDS, words),
    };
    let arguments = test_command(packages)?;
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

/// The test command for the property tests of the named crates, of all if none is named.
fn test_command<'a>(packages: &[&'a str]) -> Result<Vec<&'a str>, Box<dyn Error>> {
    let known: Vec<&str> = SUITES.iter().map(|suite| suite.0).collect();
    if let Some(unknown) = packages.iter().find(|&name| !known.contains(name)) {
        let known = known.join(", ");
        return Err(format!("no crate `{unknown}` has property tests; these do: {known}").into());
    }
    let mut arguments = vec!["test", "--quiet"];
    for (package, files) in SUITES {
        if packages.is_empty() || packages.contains(&package) {
            arguments.extend(["--package", package]);
            arguments.extend(files.iter().flat_map(|name| ["--test", name]));
        }
    }
    Ok(arguments)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_named_crate_runs_its_own_property_tests_only() {
        let command = test_command(&["ruga-mesh"]).expect("a known crate");
        let expected = [
            "test",
            "--quiet",
            "--package",
            "ruga-mesh",
            "--test",
            "properties",
        ];
        assert_eq!(command, expected);
        let error = test_command(&["ruga-mish"]).expect_err("no such crate");
        assert!(error.to_string().contains("`ruga-mish`"));
    }

    #[test]
    fn every_file_with_property_tests_is_run() {
        let crates = crate::repository::root().join("crates");
        let mut found = Vec::new();
        for folder in std::fs::read_dir(&crates).expect("the crates").flatten() {
            let package = folder.file_name().to_string_lossy().into_owned();
            let Ok(files) = std::fs::read_dir(folder.path().join("tests")) else {
                continue;
            };
            for path in files.flatten().map(|file| file.path()) {
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                if text.contains("proptest! {") {
                    let name = path.file_stem().unwrap_or_default().to_string_lossy();
                    found.push((package.clone(), name.into_owned()));
                }
            }
        }
        found.sort();
        let listed = SUITES.iter().flat_map(|&(package, files)| {
            let files = files.iter();
            files.map(move |&name| (package.to_owned(), name.to_owned()))
        });
        assert_eq!(found, listed.collect::<Vec<_>>());
    }
}
