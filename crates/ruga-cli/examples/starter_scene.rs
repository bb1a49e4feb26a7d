//! Calls the command from a program: makes a starter scene and plans it.
//!
//! `cargo run --release -p ruga-cli --example starter_scene`

use std::ffi::OsString;
use std::process::ExitCode;

fn main() -> ExitCode {
    let folder = std::env::temp_dir().join("ruga-starter-scene");
    // `new` does not write over a scene that is there already.
    let _ = std::fs::remove_dir_all(&folder);
    let ruga = |command: &str, path: OsString| ruga_cli::run(["ruga".into(), command.into(), path]);
    match ruga("new", folder.clone().into_os_string()) {
        ExitCode::SUCCESS => ruga("plan", folder.join("scene.toml").into_os_string()),
        failure => failure,
    }
}
