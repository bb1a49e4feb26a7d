//! The command `ruga`.

use std::process::ExitCode;

use mimalloc::MiMalloc;

/// Factors, matrices and meshes of some megabytes come and go: with the allocator of the system a smile takes a
/// tenth longer, and twice as much memory lies unused between them.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    ruga_cli::run(std::env::args_os())
}
