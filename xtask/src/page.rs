//! `page`: the scripts of the preview page in one file.

use std::process::{Command, ExitCode};

use crate::repository::{Outcome, root};

/// Steps of npm, in the folder of the page's sources.
const STEPS: [&[&str]; 2] = [&["install", "--no-package-lock"], &["run", "build"]];

/// Writes `bundle.js` of `ruga-preview`, with the versions that its `package.json` pins.
///
/// The bundle is committed, so that building ruga takes cargo alone.
pub(crate) fn bundle() -> Outcome {
    let folder = root().join("crates/ruga-preview/page");
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    for step in STEPS {
        eprintln!("$ npm {}", step.join(" "));
        let status = Command::new(npm).args(step).current_dir(&folder).status();
        let status = status.map_err(|error| format!("npm cannot be started: {error}"))?;
        if !status.success() {
            return Ok(ExitCode::FAILURE);
        }
    }
    Ok(ExitCode::SUCCESS)
}
