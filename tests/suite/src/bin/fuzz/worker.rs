//! The process that tries inputs of one target until its time is over, or until one kills it.

use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use ruga_tests::{Target, Verdict};

/// Memory that a target may ask for, bytes: what goes beyond is refused and ends the process.
const MOST_MEMORY: u64 = 1 << 30;
/// The same for the whole program, whose threads reserve some before they begin.
const MOST_PROGRAM_MEMORY: u64 = 3 << 30;

/// Where and why the last panic was.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Tries inputs from number `first` on. Each is announced before and judged after, a line each.
pub(crate) fn run(folder: &Path, target: &str, first: &str, seconds: &str) -> ExitCode {
    let (Some(target), Ok(first), Ok(seconds)) =
        (Target::named(target), first.parse::<u64>(), seconds.parse())
    else {
        return ExitCode::from(2);
    };
    limit_memory(target);
    panic::set_hook(Box::new(|info| {
        let mut last = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        *last = info.to_string();
    }));
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut number = first;
    while Instant::now() < end {
        println!("begin {number}");
        let verdict = tried(folder, target, number);
        println!("{}", verdict_line(&verdict));
        number = number.wrapping_add(1);
    }
    ExitCode::SUCCESS
}

/// Tries one input again, panics and all, and leaves its files in the folder.
pub(crate) fn again(folder: &Path, input: &str) -> Option<ExitCode> {
    let (target, number) = input.rsplit_once('-')?;
    let (target, number) = (Target::named(target)?, number.parse().ok()?);
    limit_memory(target);
    let folder = fresh(folder, target, number);
    let verdict = target.try_input(number, &folder, &own_path());
    println!("{}: {verdict:?}", folder.display());
    Some(match verdict {
        Verdict::Find(_) => ExitCode::FAILURE,
        _ => ExitCode::SUCCESS,
    })
}

/// Tries an input in a folder of its own, which stays if there is a find.
fn tried(folder: &Path, target: Target, number: u64) -> Verdict {
    let folder = fresh(folder, target, number);
    let started = cpu_seconds();
    let fuzzer = own_path();
    let tried = panic::catch_unwind(AssertUnwindSafe(|| {
        target.try_input(number, &folder, &fuzzer)
    }));
    let seconds = cpu_seconds() - started;
    let verdict = match tried {
        Ok(verdict) if seconds <= target.patience() => verdict,
        Ok(verdict) => Verdict::Find(format!("slow: {seconds:.0} s, then {verdict:?}")),
        Err(_) => {
            let last = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
            Verdict::Find(last.clone())
        }
    };
    if !matches!(verdict, Verdict::Find(_)) {
        // A folder that stays does no harm.
        let _ = fs::remove_dir_all(&folder);
    }
    verdict
}

fn fresh(folder: &Path, target: Target, number: u64) -> std::path::PathBuf {
    let folder = folder.join(format!("{}-{number}", target.name()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the fuzzer's folder takes folders");
    folder
}

fn own_path() -> std::path::PathBuf {
    std::env::current_exe().expect("a program that runs has a path")
}

fn verdict_line(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Accepted => "accepted".to_owned(),
        Verdict::Rejected => "rejected".to_owned(),
        Verdict::Find(what) => format!("find {}", what.replace(['\n', '\r'], " ")),
    }
}

/// Seconds that this process has computed, whatever else the machine does.
#[cfg(unix)]
fn cpu_seconds() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(not(unix))]
fn cpu_seconds() -> f64 {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// Lets the system refuse absurd demands for memory, which would otherwise only be reserved.
#[cfg(unix)]
fn limit_memory(target: Target) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let most = match target {
        Target::Program => MOST_PROGRAM_MEMORY,
        _ => MOST_MEMORY,
    };
    let limit = Rlimit {
        current: Some(most),
        maximum: Some(most),
    };
    // Without a limit the search is worth less, but not nothing.
    let _ = setrlimit(Resource::As, limit);
}

#[cfg(not(unix))]
fn limit_memory(_: Target) {
    let _ = (MOST_MEMORY, MOST_PROGRAM_MEMORY);
}
