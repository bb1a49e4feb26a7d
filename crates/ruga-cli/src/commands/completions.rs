//! `ruga completions`: what lets a shell complete the words of the command.

use clap::CommandFactory;
use clap_complete::generate;

use crate::arguments::{Arguments, CompletionsArguments};
use crate::messages;
use crate::outcome::Outcome;

/// Prints the shell's script on stdout.
pub(crate) fn run(arguments: &CompletionsArguments) -> Outcome {
    let mut script = Vec::new();
    generate(
        arguments.shell,
        &mut Arguments::command(),
        "ruga",
        &mut script,
    );
    messages::result(&String::from_utf8_lossy(&script));
    Outcome::Done
}
