//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, TempPath};

use crate::IoError;

/// A file being written beside its final place; it moves there on [`AtomicFile::commit`].
///
/// Dropped without a commit it leaves nothing behind. Missing parent folders are made.
#[derive(Debug)]
pub struct AtomicFile {
    target: PathBuf,
    writer: BufWriter<File>,
    /// Removes the file where nothing was committed; after the writer, which closes it.
    temporary: TempPath,
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
        // Long names stay under the 255 bytes that file systems allow.
        let start: String = name.to_string_lossy().chars().take(40).collect();
        // Opened by `File` and not by `tempfile`, whose own files nobody else may read.
        let (file, temporary) = Builder::new()
            .prefix(&format!(".{start}."))
            .suffix(".tmp")
            .make_in(folder, |path| File::create_new(path))
            .map_err(unwritable)?
            .into_parts();
        Ok(Self {
            target: target.to_owned(),
            writer: BufWriter::new(file),
            temporary,
        })
    }

    /// Puts the file in its place, over an older one of that name.
    ///
    /// # Errors
    /// [`IoError::Unwritable`] naming the target; the temporary is gone then.
    pub fn commit(self) -> Result<(), IoError> {
        let move_whole = || -> io::Result<()> {
            self.writer.into_inner()?.sync_all()?;
            self.temporary.persist(&self.target)?;
            Ok(())
        };
        move_whole().map_err(|source| IoError::unwritable(&self.target, source))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
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
