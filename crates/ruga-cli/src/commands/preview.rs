//! `ruga preview`: the page of a folder that was baked.

use crate::arguments::PreviewArguments;
use crate::error::CliError;
use crate::folder_lock::FolderLock;
use crate::outcome::Outcome;
use crate::{messages, preview_page};

/// Writes `preview.html` anew from what is in a folder.
///
/// # Errors
/// What keeps the folder from being previewed; another run is working in it.
pub(crate) fn run(arguments: &PreviewArguments) -> Result<Outcome, CliError> {
    let folder = &arguments.folder;
    // A folder that was copied for an engine has no records; nobody bakes into it.
    let lock = folder.join("poses").is_dir().then(|| {
        let line = format!("ruga preview {}", folder.display());
        FolderLock::take(folder, &line)
    });
    let _lock = lock.transpose()?;
    let (path, bytes) = preview_page::write(folder, arguments.force)?;
    let size = bytes as f64 / 1e6;
    messages::result(&format!(
        "{} ({size:.1} MB): open it in a browser.",
        path.display()
    ));
    Ok(Outcome::Done)
}
