//! `test`: every test that takes seconds, packed over the processor's cores.
//!
//! `cargo test` runs one program after another, and many have one long test at their end, during which
//! the other cores wait. So cargo builds, and the programs run side by side.

use std::collections::VecDeque;
use std::error::Error;
use std::io;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Output, Stdio};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use serde_json::Value;

use crate::repository::{Outcome, cargo, run};

/// In the profile of `cargo run --release`, whose dependencies then are there already.
const TESTS: [&str; 5] = [
    "test",
    "--release",
    "--workspace",
    "--exclude",
    "ruga-validation",
];

/// Builds and runs all tests, the examples of the documentation last.
pub(crate) fn test() -> Outcome {
    let Some(programs) = built()? else {
        return Ok(ExitCode::FAILURE);
    };
    let failed = run_all(programs)?;
    if !failed.is_empty() {
        return Err(format!("failed: {}", failed.join(", ")).into());
    }
    let documentation = [TESTS.as_slice(), &["--quiet", "--doc"]].concat();
    Ok(run(&[], &documentation)?.unwrap_or(ExitCode::SUCCESS))
}

/// A program with tests.
struct Program {
    name: String,
    path: PathBuf,
    /// Folder of its package, in which it expects to be.
    folder: PathBuf,
}

/// Builds the tests; `None` if that fails.
fn built() -> Result<Option<Vec<Program>>, Box<dyn Error>> {
    let format = ["--no-run", "--message-format", "json-render-diagnostics"];
    let mut command = cargo(&[TESTS.as_slice(), &format].concat());
    let output = command.stderr(Stdio::inherit()).output()?;
    let text = String::from_utf8(output.stdout)?;
    let messages: Result<Vec<Value>, _> = text.lines().map(serde_json::from_str).collect();
    let programs = messages?.iter().filter_map(Program::of).collect();
    Ok(output.status.success().then_some(programs))
}

impl Program {
    /// What a message of cargo's says was built, if that has tests.
    fn of(message: &Value) -> Option<Self> {
        let manifest = PathBuf::from(message["manifest_path"].as_str()?);
        let folder = manifest.parent()?.to_owned();
        let package = folder.file_name()?.to_string_lossy().into_owned();
        let target = message["target"]["name"].as_str()?;
        let is_test = message["profile"]["test"] == true;
        is_test.then_some(Self {
            name: format!("{package} {target}"),
            path: message["executable"].as_str()?.into(),
            folder,
        })
    }
}

/// Runs programs, as many at a time as there are cores, the last ones first: the long ones are of crates
/// that stand on the others. Gives the names of those that failed.
fn run_all(programs: Vec<Program>) -> io::Result<Vec<String>> {
    let cores = thread::available_parallelism()?.get();
    let (waiting, failed) = (Mutex::new(VecDeque::from(programs)), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        let work = || -> io::Result<()> {
            loop {
                let next = waiting
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .pop_back();
                let Some(program) = next else {
                    return Ok(());
                };
                let start = Instant::now();
                let Output {
                    status,
                    stdout,
                    stderr,
                } = Command::new(&program.path)
                    .current_dir(&program.folder)
                    .env("CARGO_MANIFEST_DIR", &program.folder)
                    .output()?;
                let word = if status.success() { "ok" } else { "FAILED" };
                println!(
                    "{word:<6} {:6.1} s  {}",
                    start.elapsed().as_secs_f64(),
                    program.name
                );
                if !status.success() {
                    println!("{}", String::from_utf8_lossy(&[stdout, stderr].concat()));
                    failed
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .push(program.name);
                }
            }
        };
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        let mut ends = workers.into_iter().map(|worker| {
            // A thread of ours that panics is our bug.
            worker.join().expect("a worker that returns")
        });
        ends.try_for_each(|end| end)
    })?;
    Ok(failed.into_inner().unwrap_or_else(PoisonError::into_inner))
}
