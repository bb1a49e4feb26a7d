//! `ruga man`: manual pages.

use clap::{Command, CommandFactory};
use clap_mangen::Man;
use ruga_io::write_atomically;

use crate::arguments::{Arguments, ManArguments};
use crate::error::CliError;
use crate::messages;
use crate::outcome::Outcome;

/// Writes a page for `ruga` and one for each of its commands.
///
/// # Errors
/// A page that cannot be written.
pub(crate) fn run(arguments: &ManArguments) -> Result<Outcome, CliError> {
    let mut all = Arguments::command();
    // Lets every command know its whole name.
    all.build();
    let commands: Vec<Command> = all.get_subcommands().cloned().collect();
    for command in std::iter::once(all).chain(commands) {
        let name = command.get_display_name().unwrap_or("ruga").to_owned();
        let mut page = Vec::new();
        let path = arguments.folder.join(format!("{name}.1"));
        let written = Man::new(command).render(&mut page);
        written.map_err(|error| CliError::Output {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        write_atomically(&path, &page)?;
    }
    let folder = arguments.folder.display();
    messages::result(&format!("Manual pages are in {folder}."));
    Ok(Outcome::Done)
}
