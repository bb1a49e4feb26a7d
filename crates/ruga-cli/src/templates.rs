//! Scenes to start from; their meshes are made by `cargo xtask assets`.

use clap::ValueEnum;

/// A starter scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Template {
    /// A patch of forearm with three blend shapes: compress, twist, pinch.
    #[default]
    Forearm,
    /// A finger that bends.
    Finger,
}

impl Template {
    /// Name and content of every file, the scene first.
    pub(crate) fn files(self) -> [(&'static str, &'static [u8]); 2] {
        match self {
            Template::Forearm => [
                (
                    "scene.toml",
                    include_bytes!("../../../assets/forearm/scene.toml"),
                ),
                (
                    "forearm.glb",
                    include_bytes!("../../../assets/forearm/forearm.glb"),
                ),
            ],
            Template::Finger => [
                (
                    "scene.toml",
                    include_bytes!("../../../assets/finger/scene.toml"),
                ),
                (
                    "finger.glb",
                    include_bytes!("../../../assets/finger/finger.glb"),
                ),
            ],
        }
    }
}
