//! Files that appear whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::IoError;

/// A file being written beside its final place; it moves there on [`AtomicFile::commit`].
///
/// Dropped without a commit it leaves nothing behind. Missing parent folders are made.
#[derive(Debug)]
pub struct AtomicFile {
    target: PathBuf,
    temporary: PathBuf,
    /// `None` once committed: then there is nothing left to remove.
    writer: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Opens the temporary sibling of `target`.
    ///
    /// # Errors
    /// [`IoError::Unwritable`] when the folder cannot be made or written to.
    pub fn create(target: &Path) -> Result<Self, IoError> {
        let unwritable = |source| IoError::unwritable(target, source);
        let name = target.file_name().ok_or_else(|| {
            unwritable(io::Error::new(
                io::ErrorKind::InvalidInput,
                "the path has no file name",
            ))
        })?;
        if target.is_dir() {
            return Err(unwritable(io::ErrorKind::IsADirectory.into()));
        }
        let folder = target.parent().unwrap_or(Path::new(""));
        if !folder.as_os_str().is_empty() {
            fs::create_dir_all(folder).map_err(unwritable)?;
        }
        let temporary = folder.join(temporary_name(&name.to_string_lossy()));
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&temporary)
            .map_err(unwritable)?;
        Ok(Self {
            target: target.to_owned(),
            temporary,
            writer: Some(BufWriter::new(file)),
        })
    }

    /// Puts the file in its place, over an older one of that name.
    ///
    /// # Errors
    /// [`IoError::Unwritable`] naming the target; the temporary is gone then.
    pub fn commit(mut self) -> Result<(), IoError> {
        let written = self.flush_to_disk();
        let moved = written.and_then(|()| fs::rename(&self.temporary, &self.target));
        if moved.is_err() {
            // The first error is the one worth telling; a failed clean-up adds nothing to it.
            let _ = fs::remove_file(&self.temporary);
        }
        moved.map_err(|source| IoError::unwritable(&self.target, source))
    }

    fn flush_to_disk(&mut self) -> io::Result<()> {
        match self.writer.take() {
            Some(writer) => writer
                .into_inner()
                .map_err(io::IntoInnerError::into_error)?
                .sync_all(),
            None => Ok(()),
        }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.writer {
            Some(writer) => writer.write(bytes),
            None => Err(io::ErrorKind::BrokenPipe.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.as_mut().map_or(Ok(()), BufWriter::flush)
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some(writer) = self.writer.take() {
            // Closes the file without writing what is still buffered: it is to be removed.
            drop(writer.into_parts());
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Writes `bytes` as one file, whole or not at all.
///
/// # Errors
/// [`IoError::Unwritable`] naming `path` and the cause.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes)
        .map_err(|source| IoError::unwritable(path, source))?;
    file.commit()
}

/// A hidden name that no other thread and no other run writes to.
fn temporary_name(name: &str) -> String {
    static WRITTEN: AtomicU64 = AtomicU64::new(0);
    let number = WRITTEN.fetch_add(1, Ordering::Relaxed);
    // Long names stay under the 255 bytes that file systems allow.
    let start: String = name.chars().take(40).collect();
    format!(".{start}.{}.{number}.tmp", std::process::id())
}
