//! A film on a soft base against theory: flat, curved, held by rows, choosing its wavelength.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

mod constraint;
mod cylinder;
mod growth;
mod meshes;
mod selection;
