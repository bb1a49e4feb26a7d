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

pub use model::{Body, BodyPose, Handle, Keyframe, Motion, Obstacle, ObstacleShape};
pub use plan::{BodyPlan, plan_body};
pub use simulate::simulate_body;
