//! A soft body under one layer: both move together, and the body follows from what holds it.

mod model;
mod plan;
mod simulate;

mod body_mesh;
mod carrier;
mod contact;
mod cost;
mod embedded_layer;
mod foundation;
mod handles;
mod inertia;
mod lattice_size;
mod layout;
mod objective;
mod obstacle;
mod prediction;
mod run;
mod system;
mod waves;

#[cfg(test)]
mod tests;

pub use model::{Body, Handle, Keyframe, Motion, Obstacle, ObstacleShape};
pub(crate) use plan::Interior;
pub use plan::plan_body;
pub(crate) use simulate::simulate_body;
