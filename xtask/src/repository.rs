//! Where the repository is, and how its own cargo is called.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use serde_json::Value;

/// What every task ends with: an exit code, or why it could not run.
pub(crate) type Outcome = Result<ExitCode, Box<dyn Error>>;

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// The cargo that started this task, in the workspace, without a word from standard input.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(root())
        .stdin(std::process::Stdio::null());
    command
}

/// Where cargo builds, which a setting or a variable may have moved.
pub(crate) fn target_folder() -> Result<PathBuf, Box<dyn Error>> {
    let output = cargo(&["metadata", "--no-deps", "--format-version", "1"]).output()?;
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let folder = metadata["target_directory"].as_str();
    Ok(folder
        .ok_or("cargo metadata names no target folder")?
        .into())
}

/// Echoes a command as one would type it, runs it, and gives its exit code when it failed.
pub(crate) fn run(
    environment: &[(&str, &str)],
    arguments: &[&str],
) -> Result<Option<ExitCode>, Box<dyn Error>> {
    eprintln!("$ {}", typed(environment, arguments));
    let mut command = cargo(arguments);
    command.envs(environment.iter().copied());
    let status = command.status()?;
    if status.success() {
        return Ok(None);
    }
    // A signal leaves no code; and no failure may look like success.
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(Some(code.map_or(ExitCode::FAILURE, ExitCode::from)))
}

fn typed(environment: &[(&str, &str)], arguments: &[&str]) -> String {
    let variables = environment.iter().map(|(k, v)| format!("{k}=\"{v}\""));
    variables
        .chain(["cargo".to_owned()])
        .chain(arguments.iter().map(|a| a.to_string()))
        .collect::<Vec<_>>()
        .join(" ")
}
