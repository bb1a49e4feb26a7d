//! Runs, measured two at a time and kept as they come.
//!
//! Every finished run is a line of `runs.jsonl`. An interruption costs the runs under way; what is
//! there is not measured again.

use std::collections::VecDeque;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use rayon::ThreadPoolBuilder;

use crate::plan::REFERENCE;
use crate::setting::{Line, Outcome, PatchShape, Problem, Run, word};
use crate::{film, patch};

/// Runs at a time, each on a thread of its own whose time is taken, so that they do not disturb each
/// other much.
const WORKERS: usize = 2;

/// What `file` has, without a line that an interruption cut off; nothing of a file that is not there.
pub(crate) fn read(file: &Path) -> io::Result<Vec<Line>> {
    if !file.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(file)?;
    let lines = text.lines();
    Ok(lines.filter_map(|l| serde_json::from_str(l).ok()).collect())
}

/// Those of `runs` that `file` has.
pub(crate) fn measured(runs: &[Run], file: &Path) -> io::Result<Vec<Line>> {
    let mut lines = read(file)?;
    lines.retain(|line| runs.iter().any(|run| is_same(run, &line.request)));
    Ok(lines)
}

/// Whether two runs differ at most in the time that they may take.
fn is_same(a: &Run, b: &Run) -> bool {
    (a.setting, a.seed) == (b.setting, b.seed)
}

/// Measures what `file` does not have yet of `runs`.
pub(crate) fn measure(runs: &[Run], file: &Path) -> io::Result<()> {
    let known = read(file)?;
    let is_missing = |run: &&Run| !known.iter().any(|line| is_same(run, &line.request));
    let missing: VecDeque<Run> = runs.iter().filter(is_missing).copied().collect();
    // A run that panics is told in its line.
    set_hook(Box::new(|_| {}));
    let queue = Queue {
        total: missing.len(),
        state: Mutex::new(State {
            file: OpenOptions::new().create(true).append(true).open(file)?,
            missing,
            done: 0,
        }),
    };
    let reference = queue.reference(&known)?;
    std::thread::scope(|scope| -> io::Result<()> {
        let work = || queue.work(reference.as_ref());
        let workers: Vec<_> = (0..WORKERS).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            // A thread of ours that panics is our bug.
            worker.join().expect("a worker that returns")?;
        }
        Ok(())
    })
}

/// What the workers share.
struct Queue {
    total: usize,
    state: Mutex<State>,
}

struct State {
    missing: VecDeque<Run>,
    file: File,
    done: usize,
}

impl Queue {
    /// What the patches among the missing runs are compared with: known, or measured and kept.
    fn reference(&self, known: &[Line]) -> io::Result<Option<PatchShape>> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let is_patch = |run: &Run| run.setting.problem == Problem::Patch;
        if !state.missing.iter().any(is_patch) {
            return Ok(None);
        }
        let kept = known.iter().filter(|l| is_same(&l.request, &REFERENCE));
        if let Some(shape) = kept.filter_map(|line| line.outcome.shape.clone()).next() {
            return Ok(Some(shape));
        }
        eprintln!("measuring the fine mesh that patches are compared with ...");
        let line = measured_alone(REFERENCE, None)?;
        state.write(&line)?;
        let failure = line.outcome.failure.unwrap_or_default();
        let shape = line.outcome.shape;
        let missing = || io::Error::other(format!("no reference: {failure}"));
        shape.ok_or_else(missing).map(Some)
    }

    fn work(&self, reference: Option<&PatchShape>) -> io::Result<()> {
        loop {
            let lock = || self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let Some(run) = lock().missing.pop_front() else {
                return Ok(());
            };
            let line = measured_alone(run, reference)?;
            let mut state = lock();
            state.write(&line)?;
            state.done += 1;
            eprintln!("{:4} of {}  {}", state.done, self.total, told(&line));
        }
    }
}

impl State {
    fn write(&mut self, line: &Line) -> io::Result<()> {
        let line = serde_json::to_string(line)?;
        // In one piece, and behind what an interruption may have cut off.
        self.file.write_all(format!("\n{line}\n").as_bytes())
    }
}

fn told(Line { request, outcome }: &Line) -> String {
    let failure = outcome.failure.as_ref();
    let failure = failure.map_or(String::new(), |failure| format!("  ({failure})"));
    format!(
        "{:<5} {:>2} points  {:<80}  seed {}  {:7.2} s{failure}",
        word(request.setting.problem),
        request.setting.points,
        request.setting.method.words(),
        request.seed,
        outcome.cpu_s,
    )
}

/// One run on one thread, whatever becomes of it.
fn measured_alone(request: Run, reference: Option<&PatchShape>) -> io::Result<Line> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let run = || match request.setting.problem {
        Problem::Film => film::measure(&request),
        Problem::Patch => patch::measure(&request, reference),
    };
    let run = || catch_unwind(AssertUnwindSafe(run));
    let outcome = pool.map_err(io::Error::other)?.install(run);
    let outcome = outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or(panic.downcast_ref::<&str>().copied());
        Outcome::failed(format!("panicked: {}", text.unwrap_or("without a word")))
    });
    Ok(Line { request, outcome })
}
