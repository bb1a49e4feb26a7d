//! The papers' methods for one solve, against the product's where both work.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

mod global_rows;
mod minres;
mod printed_adjustment;
mod residual;
