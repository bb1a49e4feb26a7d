//! What can be wrong with a file, said so that its author can mend it.

use std::io;
use std::path::{Path, PathBuf};

use ruga_blend::{did_you_mean, nearest};
use thiserror::Error;

/// A file that cannot be read, means something impossible, or cannot be written.
///
/// Every message begins with the file it is about.
#[derive(Debug, Error)]
pub enum IoError {
    /// The file is missing, or the system does not let us read it.
    #[error("{path}: cannot read: {cause}", cause = cause_of(source))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
    /// A file was expected, a folder was named.
    #[error("{path}: this is a folder; expected a file")]
    Directory {
        /// The folder.
        path: PathBuf,
    },
    /// The name or the first bytes belong to none of the accepted formats.
    #[error("{path}: {found}; accepted: {accepted}")]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Description of what it appears to be.
        found: String,
        /// The formats that would do.
        accepted: &'static str,
    },
    /// The file breaks the rules of its format.
    #[error("{path}: {element}: {reason}")]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The element in it, such as `accessor 4` or `line 12`.
        element: String,
        /// Fault of the element.
        reason: String,
    },
    /// The file holds several meshes and none was chosen.
    #[error("{path}: holds {count} meshes; choose one with `mesh_name`: {listed}", count = names.len(), listed = listed(names))]
    MeshNotChosen {
        /// The file.
        path: PathBuf,
        /// The meshes it holds.
        names: Vec<String>,
    },
    /// The file holds no mesh of that name.
    #[error("{path}: no mesh named `{name}`{}; it holds: {listed}", did_you_mean(suggestion.as_deref()), listed = listed(names))]
    UnknownMesh {
        /// The file.
        path: PathBuf,
        /// The name that was asked for.
        name: String,
        /// The nearest name in the file.
        suggestion: Option<String>,
        /// The meshes it holds.
        names: Vec<String>,
    },
    /// The mesh has no triangle to put skin on.
    #[error("{path}: mesh `{mesh}` has no triangles")]
    NoTriangles {
        /// The file.
        path: PathBuf,
        /// The mesh.
        mesh: String,
    },
    /// A blend shape's own file does not fit the rest shape.
    #[error("{path}: blend shape `{target}`: {reason}")]
    TargetMismatch {
        /// The file of the blend shape.
        path: PathBuf,
        /// The blend shape.
        target: String,
        /// Difference between the two.
        reason: String,
    },
    /// The data to be written contradict themselves; the caller's mistake.
    #[error("{path}: not written: {reason}")]
    Unwritten {
        /// The file.
        path: PathBuf,
        /// Names of the arrays that do not fit each other.
        reason: String,
    },
    /// The system does not let us write the file.
    #[error("{path}: cannot write: {cause}", cause = cause_of(source))]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
}

impl IoError {
    /// The error of a file that breaks the rules of its format, or of the use that is made of it.
    pub fn malformed(path: &Path, element: impl Into<String>, reason: impl Into<String>) -> Self {
        IoError::Malformed {
            path: path.to_owned(),
            element: element.into(),
            reason: reason.into(),
        }
    }

    /// The error of a name that is none of `names`, with the nearest of them.
    pub(crate) fn unknown_mesh(path: &Path, name: &str, names: Vec<String>) -> Self {
        IoError::UnknownMesh {
            path: path.to_owned(),
            name: name.to_owned(),
            suggestion: nearest(name, names.iter().map(String::as_str)),
            names,
        }
    }

    pub(crate) fn unwritten(path: &Path, reason: impl Into<String>) -> Self {
        IoError::Unwritten {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    pub(crate) fn unwritable(path: &Path, source: io::Error) -> Self {
        IoError::Unwritable {
            path: path.to_owned(),
            source,
        }
    }
}

/// Reads a whole file, telling a folder from a missing file.
///
/// # Errors
/// [`IoError::Directory`]; [`IoError::Unreadable`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, IoError> {
    if path.is_dir() {
        return Err(IoError::Directory {
            path: path.to_owned(),
        });
    }
    std::fs::read(path).map_err(|source| IoError::Unreadable {
        path: path.to_owned(),
        source,
    })
}

fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// The system's message, with the words that an artist looks for put first.
fn cause_of(error: &io::Error) -> String {
    let plain = match error.kind() {
        io::ErrorKind::NotFound => return "there is no such file".to_owned(),
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "permission is denied"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "the disk is full",
        io::ErrorKind::NotADirectory => "a folder in its path is a file",
        io::ErrorKind::IsADirectory => "a folder of that name is in the way",
        _ => return error.to_string(),
    };
    format!("{plain} ({error})")
}
