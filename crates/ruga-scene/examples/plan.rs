//! Says what will wrinkle in the poses of a scene.
//!
//! `cargo run --release -p ruga-scene --example plan -- scene.toml`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use std::env;
use std::path::PathBuf;

use ruga_scene::{Scene, SceneError};

fn main() -> Result<(), SceneError> {
    let forearm = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/forearm/scene.toml"
    );
    let path = env::args_os()
        .nth(1)
        .map_or_else(|| forearm.into(), PathBuf::from);
    let scene = Scene::read(&path)?;
    let plan = scene.plan()?;
    for (number, pose) in scene.poses.iter().enumerate() {
        for layer in plan.pose_layers(number) {
            println!(
                "{}, {}: wrinkles of {:.1} mm on {:.1} cm2, {} vertices",
                pose.name,
                layer.name,
                1e3 * layer.wavelength,
                1e4 * layer.active_area,
                layer.vertices
            );
        }
    }
    Ok(())
}
