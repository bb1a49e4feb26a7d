//! The folder that results go to.

use std::fs;
use std::path::Path;

use ruga_io::{AtomicFile, IoError};

use crate::error::CliError;

/// Makes the folder and finds out, before hours of work, whether files can be written there.
///
/// # Errors
/// [`CliError::Output`] naming the folder and the cause.
pub(crate) fn prepare(path: &Path) -> Result<(), CliError> {
    let refuse = |reason: String| {
        Err(CliError::Output {
            path: path.to_owned(),
            reason,
        })
    };
    if path.as_os_str().is_empty() {
        return refuse("its name is empty".to_owned());
    }
    if path.exists() && !path.is_dir() {
        return refuse("it is a file".to_owned());
    }
    if let Err(error) = fs::create_dir_all(path) {
        return refuse(error.to_string());
    }
    // Dropped without a commit, the file leaves nothing behind.
    match AtomicFile::create(&path.join("report.json")) {
        Ok(_) => Ok(()),
        Err(IoError::Unwritable { source, .. }) => refuse(source.to_string()),
        Err(error) => Err(error.into()),
    }
}
