//! Scenes to start from; their meshes and images are made by `cargo xtask assets`.

use clap::ValueEnum;

/// A starter scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Template {
    /// A patch of forearm with three blend shapes: compress, twist, pinch.
    #[default]
    Forearm,
    /// A head with blend shapes in ARKit's names; zones of skin with painted masks.
    Face,
    /// The same head with creases: between the brows, beside the eyes, beside the mouth.
    Creases,
    /// A finger that bends.
    Finger,
    /// A cushion, a soft body that a button presses.
    Cushion,
}

/// Name and content of files below `assets`.
macro_rules! files {
    ($folder:literal, $($name:literal),+) => {
        &[$(($name, include_bytes!(concat!("../../../assets/", $folder, "/", $name)))),+]
    };
}

impl Template {
    /// Name and content of every file, the scene first.
    pub(crate) fn files(self) -> &'static [(&'static str, &'static [u8])] {
        match self {
            Template::Forearm => files!("forearm", "scene.toml", "forearm.glb"),
            Template::Face => files!(
                "face",
                "scene.toml",
                "face.glb",
                "forehead.png",
                "eyes.png",
                "cheeks.png",
                "thickness.png"
            ),
            Template::Creases => &[
                (
                    "scene.toml",
                    include_bytes!("../../../assets/face/creases.toml"),
                ),
                ("face.glb", include_bytes!("../../../assets/face/face.glb")),
                (
                    "forehead.png",
                    include_bytes!("../../../assets/face/forehead.png"),
                ),
                ("eyes.png", include_bytes!("../../../assets/face/eyes.png")),
                (
                    "cheeks.png",
                    include_bytes!("../../../assets/face/cheeks.png"),
                ),
            ],
            Template::Finger => files!("finger", "scene.toml", "finger.glb"),
            Template::Cushion => files!("pillow", "scene.toml", "pillow.glb"),
        }
    }
}
