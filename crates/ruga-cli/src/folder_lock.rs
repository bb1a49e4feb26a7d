//! One run at a time in an output folder.
//!
//! `poses/.lock` is an empty file that the run locks; the operating system unlocks it when the
//! process ends, however it ends, so that a run that was killed keeps nobody out. It is never removed:
//! between one run's opening and locking, another could lock a new file of that name. Who holds it
//! stands beside it in `poses/.run.json`, because Windows lets nobody read a locked file.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use ruga_io::write_atomically;
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use crate::messages;
use crate::table::duration;

/// The folder's lock; dropping it lets the next run in.
#[derive(Debug)]
pub(crate) struct FolderLock {
    holder: PathBuf,
    /// Open for as long as the lock is held.
    _file: File,
}

/// The run that has the lock.
#[derive(Debug, Serialize, Deserialize)]
struct Holder {
    process: u32,
    host: String,
    /// Seconds since 1970.
    started_unix_s: u64,
    command: String,
}

impl FolderLock {
    /// Locks `folder`, which exists, for a run of `command`.
    ///
    /// # Errors
    /// [`CliError::Busy`] naming the run that has it; [`CliError::Output`] where no file can be made.
    pub(crate) fn take(folder: &Path, command: &str) -> Result<Self, CliError> {
        let holder = folder.join("poses").join(".run.json");
        let file = open(&folder.join("poses")).map_err(|error| CliError::Output {
            path: folder.to_owned(),
            reason: error.to_string(),
        })?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(CliError::Busy {
                    path: folder.to_owned(),
                    holder: described(&holder),
                });
            }
            // Some network drives cannot lock. A guard that is missing is no reason not to work.
            Err(TryLockError::Error(error)) => messages::warning(&format!(
                "{}: cannot be locked ({error}), so nothing keeps two runs from mixing their files; start no \
                 second one in it",
                folder.display()
            )),
        }
        let text = serde_json::to_vec_pretty(&Holder::this_process(command))
            .expect("numbers and strings always serialise");
        write_atomically(&holder, &text)?;
        Ok(Self {
            holder,
            _file: file,
        })
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // What stays behind names a run that has no lock any more; the next one writes over it.
        let _ = fs::remove_file(&self.holder);
    }
}

fn open(folder: &Path) -> std::io::Result<File> {
    fs::create_dir_all(folder)?;
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false);
    options.open(folder.join(".lock"))
}

impl Holder {
    fn this_process(command: &str) -> Self {
        Self {
            process: std::process::id(),
            host: host(),
            started_unix_s: now(),
            command: command.to_owned(),
        }
    }
}

/// The run that has the lock, in words.
fn described(path: &Path) -> String {
    let text = fs::read(path).ok();
    // Between locking and writing there is a moment without a name.
    let Some(holder) = text.and_then(|text| serde_json::from_slice::<Holder>(&text).ok()) else {
        return "it has just started".to_owned();
    };
    let age = duration(now().saturating_sub(holder.started_unix_s) as f64);
    format!(
        "process {} on `{}`, `{}`, started {age} ago",
        holder.process, holder.host, holder.command
    )
}

fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

#[cfg(unix)]
fn host() -> String {
    rustix::system::uname()
        .nodename()
        .to_string_lossy()
        .into_owned()
}

#[cfg(not(unix))]
fn host() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_default()
}
