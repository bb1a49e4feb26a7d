//! The command `ruga`.

use std::process::ExitCode;

use mimalloc::MiMalloc;

/// Matrices, factors and meshes of some megabytes come and go: with glibc's allocator a smile takes a tenth longer,
/// and 100 MB more of freed memory stay with the process. It does not ask for huge pages (`no_thp`): on a system that
/// gives them to those who ask, 30 MB fewer stay, in the same time.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// Number of the allocator's option `mi_option_purge_delay`, which its bindings do not name.
const PURGE_DELAY: libmimalloc_sys::mi_option_t = 15;

/// Milliseconds after which freed memory goes back to the system. With the allocator's own 1000 a smile takes 548
/// thousand kB instead of 481, because what a pose is solved with is still there when its surfaces are made; with 30 it
/// takes 455 and a tenth more time.
const PURGE_AFTER: std::ffi::c_long = 150;

fn main() -> ExitCode {
    // SAFETY: sets a number that the allocator reads whenever it purges, before there is another thread.
    #[allow(
        unsafe_code,
        reason = "the allocator's bindings have no safe way to it"
    )]
    unsafe {
        libmimalloc_sys::mi_option_set(PURGE_DELAY, PURGE_AFTER);
    }
    ruga_cli::run(std::env::args_os())
}
