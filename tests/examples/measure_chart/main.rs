//! Measures single points of the chart of speed against accuracy: requests in, one JSON object per
//! line, results out, one JSON object per line.
//!
//! `cargo xtask chart` asks; by hand it is
//!
//! ```text
//! echo '{"problem":"film","points":12,"coupling":"hybrid","sampling":"quadrature",
//!        "bending":"hinge","mesh":"adaptive","solver":"ldlt","seed":1,"limit_s":60}' | tr -d '\n' |
//!     RAYON_NUM_THREADS=1 cargo run --release --package ruga-tests --example measure_chart
//! ```
//!
//! A run that panics is a result too: one that failed. Times are those of the processor, on one
//! thread, so that two of these processes can share a machine.

#![allow(
    clippy::print_stdout,
    reason = "results on standard output are what the program is for"
)]

mod cpu_time;
mod film;
mod patch;
mod request;

use std::error::Error;
use std::io::{BufRead, Write, stdin, stdout};
use std::panic::{AssertUnwindSafe, catch_unwind};

use request::{Outcome, Problem, Request, Response};

fn main() -> Result<(), Box<dyn Error>> {
    for line in stdin().lock().lines() {
        let request: Request = serde_json::from_str(&line?)?;
        let response = serde_json::to_string(&measured(request))?;
        println!("{response}");
        stdout().flush()?;
    }
    Ok(())
}

/// One run, whatever becomes of it.
fn measured(request: Request) -> Response {
    let run = || match request.problem {
        Problem::Film => film::measure(&request),
        Problem::Patch => patch::measure(&request),
    };
    let outcome = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or(panic.downcast_ref::<&str>().copied());
        Outcome::failed(format!("panicked: {}", text.unwrap_or("without a word")))
    });
    Response { request, outcome }
}
