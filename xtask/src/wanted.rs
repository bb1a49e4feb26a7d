//! The words after a task that draws.

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use crate::repository::target_folder;

/// Where to draw, and how thoroughly.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Wanted {
    folder: Option<PathBuf>,
    pub(crate) quick: bool,
}

impl Wanted {
    /// Reads the words after the task's name; `None` when there is one too many.
    pub(crate) fn read(words: &[&str]) -> Option<Self> {
        let mut wanted = Self::default();
        for word in words {
            match *word {
                "--quick" if !wanted.quick => wanted.quick = true,
                folder if !folder.starts_with('-') && wanted.folder.is_none() => {
                    wanted.folder = Some(folder.into());
                }
                _ => return None,
            }
        }
        Some(wanted)
    }

    /// As thoroughly, into another folder.
    pub(crate) fn within(&self, folder: PathBuf) -> Self {
        Self {
            folder: Some(folder),
            quick: self.quick,
        }
    }

    /// The folder, made if need be; one of the task's name where cargo builds unless another was
    /// asked for.
    pub(crate) fn folder(&self, task: &str) -> Result<PathBuf, Box<dyn Error>> {
        let folder = match &self.folder {
            Some(folder) => std::path::absolute(folder)?,
            None => target_folder()?.join(task),
        };
        fs::create_dir_all(&folder)?;
        Ok(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_a_folder_and_a_flag_in_any_order() {
        let wanted = |folder: Option<&str>, quick| {
            let folder = folder.map(PathBuf::from);
            Some(Wanted { folder, quick })
        };
        assert_eq!(Wanted::read(&[]), wanted(None, false));
        assert_eq!(Wanted::read(&["--quick", "out"]), wanted(Some("out"), true));
        assert_eq!(Wanted::read(&["out", "--quick"]), wanted(Some("out"), true));
        assert_eq!(Wanted::read(&["out", "two"]), None);
        assert_eq!(Wanted::read(&["--slow"]), None);
    }
}
