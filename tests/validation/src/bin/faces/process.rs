//! A command that is watched while it runs: its time, its memory, how it ended.

use std::error::Error;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

/// What a command took, over all of its runs until it ended by itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Process {
    /// Seconds of the wall clock.
    pub(crate) wall_s: f64,
    /// Seconds of the processor, all threads together; 0 where the system does not tell.
    pub(crate) cpu_s: f64,
    /// Largest resident memory, bytes; 0 where the system does not tell.
    pub(crate) peak: u64,
    /// Why it has ended, when it has.
    pub(crate) ending: Option<String>,
}

/// Time between two looks at the command.
const STEP: Duration = Duration::from_millis(100);

/// Looks between two notes in the file, so that an interrupted run loses a second.
const NOTE: u32 = 10;

/// Looks between two words about the progress.
const WORD: u32 = 600;

/// Clock ticks per second in `/proc`, on every Linux.
const TICKS: f64 = 100.0;

impl Process {
    /// Fraction of the wall clock in which one thread had the processor.
    pub(crate) fn busy(&self) -> f64 {
        match self.cpu_s > 0.0 {
            true => (self.cpu_s / self.wall_s).min(1.0),
            false => 1.0,
        }
    }

    /// Runs `command`, unless it has ended in an earlier run, and goes on counting in `file`; what it
    /// writes to standard error goes to `log`. After `limit_s` it is stopped.
    pub(crate) fn run(
        command: &mut Command,
        (file, log): (&Path, &Path),
        (name, limit_s): (&str, f64),
    ) -> Result<Self, Box<dyn Error>> {
        let earlier: Self = match fs::read(file) {
            Ok(bytes) => serde_json::from_slice(&bytes)?,
            Err(error) if error.kind() == ErrorKind::NotFound => Self::default(),
            Err(error) => return Err(error.into()),
        };
        if earlier.ending.is_some() {
            eprintln!("{name}: measured before");
            return Ok(earlier);
        }
        command.stdout(Stdio::null()).stderr(fs::File::create(log)?);
        let start = Instant::now();
        let mut child = command.spawn()?;
        let mut now = earlier.clone();
        let mut looks = 0;
        let status = loop {
            if let Some(status) = child.try_wait()? {
                break Some(status);
            }
            now.look(child.id(), &earlier);
            now.wall_s = earlier.wall_s + start.elapsed().as_secs_f64();
            looks += 1;
            if looks % NOTE == 0 {
                now.note(file)?;
            }
            if looks % WORD == 0 {
                let (minutes, peak) = (now.wall_s / 60.0, now.peak as f64 / 1e6);
                eprintln!("{name}: {minutes:.0} min, up to {peak:.0} MB");
            }
            if now.wall_s > limit_s {
                child.kill()?;
                child.wait()?;
                break None;
            }
            thread::sleep(STEP);
        };
        now.wall_s = earlier.wall_s + start.elapsed().as_secs_f64();
        let messages = fs::read_to_string(log)?;
        if messages
            .lines()
            .any(|line| line.starts_with("interrupted: "))
        {
            now.note(file)?;
            return Err(format!("{name} was interrupted").into());
        }
        now.ending = Some(match status {
            None => format!("stopped after {:.0} s", now.wall_s),
            Some(status) if status.code().is_some() => first_error(&messages),
            Some(status) => status.to_string(),
        });
        now.note(file)?;
        Ok(now)
    }

    /// Takes time and memory of a running process from where Linux shows them.
    fn look(&mut self, id: u32, earlier: &Self) {
        let read = |name: &str| fs::read_to_string(format!("/proc/{id}/{name}"));
        if let Some(ticks) = read("stat").ok().and_then(|stat| ticks(&stat)) {
            self.cpu_s = earlier.cpu_s + ticks / TICKS;
        }
        if let Some(bytes) = read("status").ok().and_then(|status| peak(&status)) {
            self.peak = self.peak.max(bytes);
        }
    }

    fn note(&self, file: &Path) -> io::Result<()> {
        let text = serde_json::to_vec(self).map_err(io::Error::other)?;
        let new = file.with_extension("new");
        fs::write(&new, text)?;
        fs::rename(new, file)
    }
}

/// Clock ticks in user and in kernel mode, fields 14 and 15; the second field, a name in brackets, may
/// have spaces.
fn ticks(stat: &str) -> Option<f64> {
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some(next()? + next()?)
}

/// Largest resident memory so far, bytes.
fn peak(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024 * kibibytes)
}

/// The first error in the words of `ruga`; empty without one.
pub(crate) fn first_error(messages: &str) -> String {
    let mut lines = messages.lines();
    let error = lines.find_map(|line| line.strip_prefix("error: "));
    error.unwrap_or_default().trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_where_linux_writes_them() {
        let stat = "12 (a (b) c) S 1 2 3 4 5 6 7 8 9 10 250 50 0 0 20 0 2";
        assert_eq!(ticks(stat), Some(300.0));
        let status = "Name:\truga\nVmPeak:\t  900 kB\nVmHWM:\t  500 kB\n";
        assert_eq!(peak(status), Some(512_000));
        assert_eq!(
            first_error("warning: this\nerror: that\nhelp: do so\n"),
            "that"
        );
    }
}
