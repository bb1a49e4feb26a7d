//! `ruga new`: a starter scene that runs.

use ruga_io::write_atomically;

use crate::arguments::NewArguments;
use crate::error::CliError;
use crate::run::Outcome;
use crate::{messages, output_folder};

/// Writes the files of a template into a folder, over nothing.
///
/// # Errors
/// [`CliError::InTheWay`] when one of them exists, [`CliError::Output`] and [`CliError::Io`] when
/// the folder cannot be written to.
pub(crate) fn run(arguments: &NewArguments) -> Result<Outcome, CliError> {
    let folder = &arguments.folder;
    let files = arguments.template.files();
    if let Some((name, _)) = files.iter().find(|(name, _)| folder.join(name).exists()) {
        return Err(CliError::InTheWay {
            path: folder.join(name),
        });
    }
    output_folder::prepare(folder)?;
    for (name, content) in files {
        write_atomically(&folder.join(name), content)?;
    }
    let scene = folder.join("scene.toml");
    let output = folder.join("out");
    messages::result(&format!(
        "{} is ready. Next:\n  ruga plan {}\n  ruga bake {} -o {}",
        scene.display(),
        scene.display(),
        scene.display(),
        output.display()
    ));
    Ok(Outcome::Done)
}
