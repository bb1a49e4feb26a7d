//! `test`: every test that takes seconds, packed over the processor's cores.

use std::process::ExitCode;

use crate::repository::{Outcome, run};

/// In the profile of `cargo run --release`, whose dependencies then are there already.
const TESTS: [&str; 5] = [
    "test",
    "--release",
    "--workspace",
    "--exclude",
    "ruga-validation",
];

/// Runs the tests.
pub(crate) fn test() -> Outcome {
    let failed = run(&[], &TESTS)?;
    Ok(failed.unwrap_or(ExitCode::SUCCESS))
}
