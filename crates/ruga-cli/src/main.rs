//! The command `ruga`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ruga_cli::run(std::env::args_os())
}
