//! `check`: everything a change must pass.

use std::process::ExitCode;

use crate::repository::{Outcome, run};

/// An environment and cargo's arguments.
type Step = (
    &'static [(&'static str, &'static str)],
    &'static [&'static str],
);

/// Quickest first, so that a slip in formatting does not wait for the tests.
const STEPS: [Step; 4] = [
    (&[], &["fmt", "--all", "--check"]),
    (
        &[],
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--",
            "-D",
            "warnings",
        ],
    ),
    (
        &[("RUSTDOCFLAGS", "-D warnings")],
        &["doc", "--workspace", "--no-deps"],
    ),
    (&[], &["test", "--workspace"]),
];

/// Runs the steps in order and stops at the first that fails, with its exit code.
pub(crate) fn check() -> Outcome {
    for (environment, arguments) in STEPS {
        if let Some(code) = run(environment, arguments)? {
            return Ok(code);
        }
    }
    Ok(ExitCode::SUCCESS)
}
