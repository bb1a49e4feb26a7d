//! One run at a time in an output folder; of tasks, one at a time on a pose.
//!
//! `poses/.lock` is an empty file that a run locks for itself, and tasks lock together; each task then
//! has `poses/.tasks/<pose>.lock` for itself. The operating system unlocks a file when the process
//! ends, however it ends, so that a run that was killed keeps nobody out. Only who has the folder
//! for itself removes locks, and those of tasks alone: between one run's opening and locking, another
//! could lock a new file of that name. Who holds a lock stands beside it in a file of its own, because
//! Windows lets nobody read a locked file.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use ruga_io::write_atomically;
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use crate::messages;
use crate::table::duration;

/// Folder of the tasks' locks, in that of the records.
const TASKS: &str = ".tasks";

/// The locks of a run; dropping them lets the next run in.
#[derive(Debug)]
pub(crate) struct FolderLock {
    folder: PathBuf,
    /// Files that name this run.
    holders: Vec<PathBuf>,
    /// Open for as long as the locks are held.
    files: Vec<File>,
}

/// The run that has a lock.
#[derive(Debug, Serialize, Deserialize)]
struct Holder {
    process: u32,
    host: String,
    /// Seconds since 1970.
    started_unix_s: u64,
    command: String,
}

impl FolderLock {
    /// Locks `folder`, which exists, for a run of `command` alone.
    ///
    /// # Errors
    /// [`CliError::Busy`] naming the run that has it, or a task that works there;
    /// [`CliError::Output`] where no file can be made.
    pub(crate) fn take(folder: &Path, command: &str) -> Result<Self, CliError> {
        let mut lock = Self::none(folder);
        let is_locked = lock.add(&folder_lock(folder), "in this folder", File::try_lock)?;
        if is_locked {
            // What is there is of tasks that have ended, or were killed.
            let _ = fs::remove_dir_all(folder.join("poses").join(TASKS));
        }
        lock.sign(folder_holder(folder), command)?;
        Ok(lock)
    }

    /// Locks `poses` of `folder`, which exists, for a task; other tasks may have other poses.
    ///
    /// # Errors
    /// [`CliError::Busy`] naming the run that has the folder or one of the poses;
    /// [`CliError::Output`] where no file can be made.
    pub(crate) fn share(folder: &Path, poses: &[String], command: &str) -> Result<Self, CliError> {
        let mut lock = Self::none(folder);
        let is_locked = lock.add(
            &folder_lock(folder),
            "in this folder",
            File::try_lock_shared,
        )?;
        if is_locked {
            // It names a run that was killed.
            let _ = fs::remove_file(folder_holder(folder));
        }
        let tasks = folder.join("poses").join(TASKS);
        for pose in poses {
            let path = tasks.join(format!("{pose}.lock"));
            lock.add(&path, &format!("on pose `{pose}`"), File::try_lock)?;
            lock.sign(
                tasks.join(format!("{pose}.json")),
                &format!("{command} --pose {pose}"),
            )?;
        }
        Ok(lock)
    }

    fn none(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            holders: Vec::new(),
            files: Vec::new(),
        }
    }

    /// Locks one more file, or says what another run is working on; whether the drive can lock.
    fn add(
        &mut self,
        path: &Path,
        work: &str,
        lock: impl Fn(&File) -> Result<(), TryLockError>,
    ) -> Result<bool, CliError> {
        let file = open(path).map_err(|error| CliError::Output {
            path: self.folder.clone(),
            reason: error.to_string(),
        })?;
        match lock(&file) {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(CliError::Busy {
                    path: self.folder.clone(),
                    work: work.to_owned(),
                    holder: described(&self.folder, path),
                });
            }
            // Some network drives cannot lock. A guard that is missing is no reason not to work.
            Err(TryLockError::Error(error)) => {
                if self.files.is_empty() {
                    messages::warning(&format!(
                        "{}: cannot be locked ({error}), so nothing keeps two runs from mixing their files; \
                         start no second one in it, unless both are tasks with different poses",
                        self.folder.display()
                    ));
                }
                self.files.push(file);
                return Ok(false);
            }
        }
        self.files.push(file);
        Ok(true)
    }

    /// Names this run in a file.
    fn sign(&mut self, holder: PathBuf, command: &str) -> Result<(), CliError> {
        let text = serde_json::to_vec_pretty(&Holder::this_process(command))
            .expect("numbers and strings always serialise");
        write_atomically(&holder, &text)?;
        self.holders.push(holder);
        Ok(())
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        for holder in &self.holders {
            // What stays behind names a run that has no lock any more; the next one writes over it.
            let _ = fs::remove_file(holder);
        }
    }
}

fn folder_lock(folder: &Path) -> PathBuf {
    folder.join("poses").join(".lock")
}

fn folder_holder(folder: &Path) -> PathBuf {
    folder.join("poses").join(".run.json")
}

fn open(path: &Path) -> io::Result<File> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut options = OpenOptions::new();
    // Network drives share a lock only among those who may read the file.
    options.read(true).write(true).create(true).truncate(false);
    options.open(path)
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

/// The run that has `lock`, in words; of several tasks in `folder` the first.
fn described(folder: &Path, lock: &Path) -> String {
    let mut holders = vec![lock.with_extension("json")];
    if lock == folder_lock(folder) {
        holders = vec![folder_holder(folder)];
        holders.extend(tasks(folder));
    }
    let mut known = holders.iter().filter_map(|path| {
        let text = fs::read(path).ok()?;
        serde_json::from_slice::<Holder>(&text).ok()
    });
    // Between locking and writing there is a moment without a name.
    let Some(holder) = known.next() else {
        return "it has just started".to_owned();
    };
    let age = duration(now().saturating_sub(holder.started_unix_s) as f64);
    let more = match known.count() {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    format!(
        "process {} on `{}`, `{}`, started {age} ago{more}",
        holder.process, holder.host, holder.command
    )
}

/// Files that name the tasks in `folder`, sorted.
fn tasks(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.join("poses").join(TASKS));
    let paths = entries.into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = paths.map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "json"));
    paths.sort();
    paths
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
