//! Runs, measured by processes of their own and kept as they come.
//!
//! Every finished run is a line of `runs.jsonl`. A crash costs the run that crashed, an interruption
//! those under way; what is there is not measured again.

use std::collections::{BTreeSet, VecDeque};
use std::error::Error;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitCode, Stdio};
use std::sync::{Mutex, PoisonError};

use serde_json::{Value, json};

use super::plan::{REFERENCE, Run};
use crate::repository::{run, target_folder};

/// Processes at a time; times are those of the processor, so that they do not disturb each other
/// much.
const WORKERS: usize = 2;

const EXAMPLE: &str = "measure_chart";

/// Builds the measuring program; its path, or the exit code of the cargo that could not.
pub(super) fn build() -> Result<Result<PathBuf, ExitCode>, Box<dyn Error>> {
    let package = ["--package", "ruga-tests", "--example", EXAMPLE];
    let arguments = [["build", "--release"].as_slice(), &package].concat();
    if let Some(code) = run(&[], &arguments)? {
        return Ok(Err(code));
    }
    let name = format!("{EXAMPLE}{}", std::env::consts::EXE_SUFFIX);
    Ok(Ok(target_folder()?.join("release/examples").join(name)))
}

/// Those of `runs` that `file` has.
pub(super) fn measured(runs: &[Run], file: &Path) -> io::Result<Vec<Value>> {
    let wanted: BTreeSet<String> = runs.iter().map(|run| key(&run.request())).collect();
    let mut lines = read(file)?;
    lines.retain(|line| wanted.contains(&key(&line["request"])));
    Ok(lines)
}

/// Measures what `file` does not have yet of `runs`.
pub(super) fn measure(program: &Path, runs: &[Run], file: &Path) -> io::Result<()> {
    let known: BTreeSet<String> = read(file)?
        .iter()
        .map(|line| key(&line["request"]))
        .collect();
    let missing = runs.iter().map(Run::request);
    let missing: VecDeque<Value> = missing.filter(|r| !known.contains(&key(r))).collect();
    let queue = Queue {
        reference: reference(program, &missing, file)?,
        total: missing.len(),
        state: Mutex::new(State {
            missing,
            file: OpenOptions::new().create(true).append(true).open(file)?,
            done: 0,
        }),
    };
    std::thread::scope(|scope| -> io::Result<()> {
        let workers: Vec<_> = (0..WORKERS)
            .map(|_| scope.spawn(|| work(program, &queue)))
            .collect();
        for worker in workers {
            // A thread of ours that panics is our bug.
            worker.join().expect("a worker that returns")?;
        }
        Ok(())
    })
}

/// What the patches among `missing` are compared with: kept in `file`, or measured and kept there.
fn reference(program: &Path, missing: &VecDeque<Value>, file: &Path) -> io::Result<Value> {
    if !missing.iter().any(|request| request["problem"] == "patch") {
        return Ok(Value::Null);
    }
    let wanted = key(&REFERENCE.request());
    let is_it = |line: &Value| key(&line["request"]) == wanted && line["shape"].is_object();
    if let Some(known) = read(file)?.into_iter().find(is_it) {
        return Ok(known["shape"].clone());
    }
    eprintln!("measuring the fine mesh that patches are compared with ...");
    let (line, _) = Worker::start(program)?.measure(&REFERENCE.request(), &Value::Null);
    let mut known = OpenOptions::new().create(true).append(true).open(file)?;
    known.write_all(format!("{line}\n").as_bytes())?;
    match &line["shape"] {
        Value::Null => Err(io::Error::other(format!(
            "no reference: {}",
            line["failure"]
        ))),
        shape => Ok(shape.clone()),
    }
}

/// What makes a run the same as another: all that is asked for but the time that it may take.
fn key(request: &Value) -> String {
    let mut request = request.clone();
    if let Some(object) = request.as_object_mut() {
        object.remove("limit_s");
    }
    request.to_string()
}

/// The lines of a file, without one that an interruption cut off; none of a file that is not there.
fn read(file: &Path) -> io::Result<Vec<Value>> {
    if !file.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(file)?;
    Ok(text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect())
}

/// What the workers share.
struct Queue {
    /// What patches are compared with; nothing where none is missing.
    reference: Value,
    total: usize,
    state: Mutex<State>,
}

struct State {
    missing: VecDeque<Value>,
    file: File,
    done: usize,
}

impl Queue {
    fn next(&self) -> Option<Value> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.missing.pop_front()
    }

    fn keep(&self, line: &Value) -> io::Result<()> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        // In one piece, and behind what an interruption may have cut off.
        state.file.write_all(format!("\n{line}\n").as_bytes())?;
        state.done += 1;
        let request = &line["request"];
        let word = |name: &str| request[name].as_str().unwrap_or_default().to_owned();
        let failure = line["failure"]
            .as_str()
            .map_or(String::new(), |f| format!("  ({f})"));
        eprintln!(
            "{:4} of {}  {:<5} {:>2} points  {:<10} {:<10} {:<7} {:<12} {:<6}  seed {}  {:7.2} s{failure}",
            state.done,
            self.total,
            word("problem"),
            request["points"].as_f64().unwrap_or_default(),
            word("coupling"),
            word("sampling"),
            word("bending").split('-').next().unwrap_or_default(),
            word("mesh"),
            word("solver"),
            request["seed"],
            line["cpu_s"].as_f64().unwrap_or_default(),
        );
        Ok(())
    }
}

fn work(program: &Path, queue: &Queue) -> io::Result<()> {
    let mut worker = None;
    while let Some(request) = queue.next() {
        let alive = match worker.take() {
            Some(worker) => worker,
            None => Worker::start(program)?,
        };
        let (line, survivor) = alive.measure(&request, &queue.reference);
        worker = survivor;
        queue.keep(&line)?;
    }
    Ok(())
}

/// A measuring process, killed when it is no longer wanted.
struct Worker {
    process: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Worker {
    fn start(program: &Path) -> io::Result<Self> {
        let mut process = Command::new(program)
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let pipes = (process.stdin.take(), process.stdout.take());
        let (Some(requests), Some(answers)) = pipes else {
            return Err(io::Error::other("a process without pipes"));
        };
        Ok(Self {
            process,
            requests,
            answers: BufReader::new(answers),
        })
    }

    /// The answer, and the worker unless it died of the question.
    fn measure(mut self, request: &Value, reference: &Value) -> (Value, Option<Self>) {
        let mut question = request.clone();
        if request["problem"] == "patch" {
            question["reference"] = reference.clone();
        }
        match self.ask(&question) {
            Some(answer) => (answer, Some(self)),
            None => (json!({ "request": request, "failure": "crashed" }), None),
        }
    }

    fn ask(&mut self, request: &Value) -> Option<Value> {
        writeln!(self.requests, "{request}").ok()?;
        let mut line = String::new();
        self.answers.read_line(&mut line).ok()?;
        serde_json::from_str(&line).ok()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
