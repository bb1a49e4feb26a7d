//! From arguments to an exit code.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;

use crate::arguments::{Arguments, Command};
use crate::error::CliError;
use crate::outcome::Outcome;
use crate::{commands, messages};

/// Runs the command that `arguments` spell, the program's name first.
///
/// Exit codes: 0 done; 1 ran, but a pose did not converge or the run was interrupted; 2 could not
/// run, wrong arguments included.
pub fn run<I>(arguments: I) -> ExitCode
where
    I: IntoIterator,
    I::Item: Into<OsString> + Clone,
{
    let command = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments.command,
        Err(usage) => {
            // Help and version are printed this way too; a closed pipe is not worth a message.
            let _ = usage.print();
            return ExitCode::from(u8::from(usage.use_stderr()) * 2);
        }
    };
    match dispatch(&command) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Incomplete) => ExitCode::from(1),
        Err(error) => {
            messages::error(error);
            ExitCode::from(2)
        }
    }
}

fn dispatch(command: &Command) -> Result<Outcome, CliError> {
    match command {
        Command::Bake(arguments) => commands::bake::run(arguments),
        Command::Simulate(arguments) => commands::simulate::run(arguments),
        Command::Age(arguments) => commands::age::run(arguments),
        Command::Job(arguments) => commands::job::run(arguments),
        Command::Plan(arguments) => commands::plan::run(arguments),
        Command::Preview(arguments) => commands::preview::run(arguments),
        Command::Check(arguments) => commands::check::run(arguments),
        Command::New(arguments) => commands::new::run(arguments),
        Command::Help(arguments) => Ok(commands::help::run(arguments)),
        Command::Completions(arguments) => Ok(commands::completions::run(arguments)),
        Command::Man(arguments) => commands::man::run(arguments),
    }
}
