//! The commands, one per module; each returns how it ended.

mod job_template;
mod plan_json;
mod scene_for_mesh;

pub(crate) mod age;
pub(crate) mod bake;
pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod help;
pub(crate) mod job;
pub(crate) mod man;
pub(crate) mod new;
pub(crate) mod plan;
mod plan_creases;
pub(crate) mod preview;
pub(crate) mod simulate;
