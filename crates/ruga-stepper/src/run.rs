//! One pose from rest to its keys: layers, their load path, and the stack of them.

pub(crate) mod adaptivity;
mod coarser;
mod layer;
pub(crate) mod layer_objective;
pub(crate) mod layer_run;
mod layer_setup;
mod low_pass_rows;
mod neighbourhood;
pub(crate) mod patches;
mod run_ahead;
pub(crate) mod stack_run;
pub(crate) mod strain_ratio;
mod upper_layers;
