//! The search: a worker per target, watched from outside, started again when an input kills it.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use ruga_tests::Target;

use crate::Wanted;
use crate::finds::Finds;

/// What became of a target's inputs.
struct Tally {
    target: Target,
    seconds: f64,
    rejected: u64,
    accepted: u64,
    finds: Finds,
}

/// Searches all wanted targets and prints a table.
pub(crate) fn search(folder: &Path, wanted: &Wanted) -> ExitCode {
    if let Err(error) = std::fs::create_dir_all(folder) {
        eprintln!("fuzz: {}: {error}", folder.display());
        return ExitCode::from(2);
    }
    let parts: u64 = wanted.targets.iter().map(|target| share(*target)).sum();
    let mut tallies = Vec::new();
    for target in &wanted.targets {
        let seconds = (wanted.seconds * share(*target) / parts).max(1);
        eprintln!("{}: {seconds} s from input {}", target.name(), wanted.first);
        tallies.push(search_target(folder, *target, wanted.first, seconds));
    }
    print_table(&tallies);
    match tallies.iter().all(|tally| tally.finds.is_empty()) {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}

/// The whole program gets as much time as all else: its inputs take the longest.
fn share(target: Target) -> u64 {
    if target == Target::Program { 6 } else { 1 }
}

fn search_target(folder: &Path, target: Target, first: u64, seconds: u64) -> Tally {
    let started = Instant::now();
    let mut tally = Tally {
        target,
        seconds: 0.0,
        rejected: 0,
        accepted: 0,
        finds: Finds::new(folder, target),
    };
    let mut next = first;
    loop {
        let left = seconds.saturating_sub(started.elapsed().as_secs());
        if left == 0 {
            break;
        }
        match watch(folder, target, next, left, &mut tally) {
            Some(killer) => next = killer.wrapping_add(1),
            None => break,
        }
    }
    tally.seconds = started.elapsed().as_secs_f64();
    tally
}

/// Runs a worker to its end; returns the input that ended it before its time.
fn watch(
    folder: &Path,
    target: Target,
    first: u64,
    seconds: u64,
    tally: &mut Tally,
) -> Option<u64> {
    let mut child = start(folder, target, first, seconds);
    let lines = lines(&mut child);
    let complaints = complaints(&mut child);
    let patience = Duration::from_secs_f64(10.0 * target.patience() + 30.0);
    let mut current = None;
    loop {
        match lines.recv_timeout(patience) {
            Ok(line) => match line.split_once(' ').unwrap_or((&line, "")) {
                ("begin", number) => current = number.parse().ok(),
                ("accepted", _) => {
                    tally.accepted += 1;
                    current = None;
                }
                ("rejected", _) => {
                    tally.rejected += 1;
                    current = None;
                }
                (_, what) => {
                    if let Some(number) = current.take() {
                        tally.finds.add(number, what);
                    }
                }
            },
            Err(RecvTimeoutError::Timeout) => {
                // It may have ended by itself meanwhile; either way it is waited for.
                let _ = child.kill();
                let _ = child.wait();
                let number = current?;
                tally.finds.add(number, "hangs");
                return Some(number);
            }
            Err(RecvTimeoutError::Disconnected) => {
                let status = child
                    .wait()
                    .map_or_else(|e| e.to_string(), |s| s.to_string());
                let number = current?;
                let said = complaints.recv().unwrap_or_default();
                tally.finds.add(number, &format!("dies: {status}: {said}"));
                return Some(number);
            }
        }
    }
}

fn start(folder: &Path, target: Target, first: u64, seconds: u64) -> Child {
    let program = std::env::current_exe().expect("a program that runs has a path");
    Command::new(program)
        .arg("worker")
        .arg(folder)
        .args([target.name(), &first.to_string(), &seconds.to_string()])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the fuzzer can start itself")
}

/// The worker's lines as they come.
fn lines(child: &mut Child) -> Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    let output = child.stdout.take().expect("stdout is a pipe");
    thread::spawn(move || {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    receiver
}

/// What the worker says on stderr, the end of it.
fn complaints(child: &mut Child) -> Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    let mut output = child.stderr.take().expect("stderr is a pipe");
    thread::spawn(move || {
        let mut bytes = Vec::new();
        // What can be read of it will do.
        let _ = output.read_to_end(&mut bytes);
        let text =
            String::from_utf8_lossy(&bytes[bytes.len().saturating_sub(300)..]).replace('\n', " ");
        let _ = sender.send(text);
    });
    receiver
}

fn print_table(tallies: &[Tally]) {
    println!(
        "{:<8} {:>8} {:>9} {:>9} {:>9} {:>6}",
        "target", "seconds", "inputs", "rejected", "accepted", "finds"
    );
    for tally in tallies {
        let finds = tally.finds.count();
        println!(
            "{:<8} {:>8.0} {:>9} {:>9} {:>9} {:>6}",
            tally.target.name(),
            tally.seconds,
            tally.rejected + tally.accepted + finds,
            tally.rejected,
            tally.accepted,
            finds
        );
    }
    for tally in tallies {
        tally.finds.print();
    }
}
